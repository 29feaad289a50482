/// `trivet scan` as used by a script: the contents of the folder, in both of its forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/program.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class Scan : public testing::Test {
 protected:
  test::Outcome run(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  nlohmann::json json(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return nlohmann::json::parse(file);
  }
  const test::TempDir folder_;
};

TEST_F(Scan, SaysWhatIsWrong) {
  const auto fails = [&](const std::vector<std::string>& arguments, const std::string& text) {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
  };
  fails({"scan", "-o", "out"}, "--parts");
  fails({"scan", "--parts", "1"}, "--output");
  fails({"scan", "--parts", "1", "-o", "out", "--sensor", "sonar"}, "sonar");
  fails({"scan", "--parts", "1", "-o", "out", "--instances", "0"}, "instances");
  fails({"scan", "--parts", "1", "-o", "out", "--families", "spoon"}, "hex_nut");
  fails({"scan", "x.ply", "-o", "out", "--families", "washer"}, "--parts");
  fails({"scan", "--parts", "1", "-o", "out", "--noise", "-1"}, "noise");
  fails({"scan", "--parts", "1", "-o", "out", "--disparity-step", "9"}, "disparity-step");
}

TEST_F(Scan, MakesPartsOfTheFamiliesThatAreAskedFor) {
  const test::Outcome outcome = run({"scan", "--parts", "3", "--families", "hex_nut,washer", "-o",
                                     "out", "--scenes", "1", "--instances", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json models = json("out/manifest.json")["models"];
  EXPECT_EQ(models.size(), 3U);
  for (const char* name : {"hex_nut_0", "washer_0", "hex_nut_1"})
    EXPECT_TRUE(models.contains(name)) << name;
}

TEST_F(Scan, MakesThingsOfAHousehold) {
  const test::Outcome outcome = run({"scan", "--parts", "2", "--families", "household", "-o", "out",
                                     "--scenes", "1", "--instances", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json models = json("out/manifest.json")["models"];
  for (const char* name : {"cup_0", "carton_0"}) EXPECT_TRUE(models.contains(name)) << name;
}

// Every scene has a different camera, the same in the manifest and in BOP's files, and the same
// when it is scanned again.
TEST_F(Scan, RandomizesEachScene) {
  const auto scan = [&](const std::string& folder, const std::string& scenes) {
    const test::Outcome outcome = run({"scan", "--parts", "2", "-o", folder, "--scenes", scenes,
                                       "--instances", "2", "--randomize", "--seed", "4"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return json(folder + "/manifest.json");
  };
  const nlohmann::json manifest = scan("out", "3"), again = scan("again", "2"),
                       cameras = json("out/test/000001/scene_camera.json");
  std::set<double> focal;
  for (std::size_t i = 0; i < 3; ++i) {
    const nlohmann::json& camera = manifest["scenes"][i]["camera"];
    focal.insert(camera["fx"].get<double>());
    EXPECT_GT(camera["fx"], 370);
    EXPECT_LT(camera["fx"], 1060);
    EXPECT_NEAR(cameras[std::to_string(i)]["cam_K"][0].get<double>(), camera["fx"].get<double>(),
                1e-6);
  }
  EXPECT_EQ(focal.size(), 3U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(manifest["scenes"][i], again["scenes"][i]);
}

TEST_F(Scan, WritesOneTruthInTheManifestAndInBopsFiles) {
  const test::Outcome outcome = run({"scan", "--parts", "2", "-o", "out", "--scenes", "2",
                                     "--instances", "3", "--sensor", "laser", "--bin"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json manifest = json("out/manifest.json"),
                       poses = json("out/test/000001/scene_gt.json"),
                       info = json("out/test/000001/scene_gt_info.json"),
                       cameras = json("out/test/000001/scene_camera.json"),
                       objects = json("out/models/models_info.json");
  EXPECT_EQ(manifest["models"].size(), 2U);
  EXPECT_EQ(objects.size(), 2U);
  EXPECT_EQ(json("out/models_eval/models_info.json"), objects);
  EXPECT_EQ(test::read_bytes(folder_ / "out/models_eval/obj_000002.ply"),
            test::read_bytes(folder_ / "out/models/obj_000002.ply"));
  std::size_t num_visible = 0;
  ASSERT_EQ(manifest["scenes"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const nlohmann::json& scene = manifest["scenes"][i];
    const std::string image = std::to_string(i);
    EXPECT_EQ(scene["file"], "test/000001/depth/00000" + image + ".png");
    EXPECT_TRUE(std::filesystem::exists(folder_ / ("out/" + scene["file"].get<std::string>())));
    EXPECT_NEAR(cameras[image]["depth_scale"].get<double>(),
                1000 * scene["camera"]["depth_scale"].get<double>(), 1e-9);
    ASSERT_EQ(scene["truth"].size(), 3U);
    ASSERT_EQ(poses[image].size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const nlohmann::json &truth = scene["truth"][k], &pose = poses[image][k];
      const std::string model = truth["model"];
      char file[32];
      std::snprintf(file, sizeof file, "models/obj_%06d.ply", pose["obj_id"].get<int>());
      EXPECT_EQ(manifest["models"][model]["file"], file);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(pose["cam_t_m2c"][axis].get<double>(),
                    1000 * truth["T_scene_model"][axis][3].get<double>(), 1e-3);
      }
      // The fraction here is exact. BOP's also counts pixels without measurements in front and
      // those up to 15 mm behind the measured surface as visible.
      EXPECT_GE(info[image][k]["visib_fract"].get<double>() + 0.01,
                truth["visible_fraction"].get<double>());
      EXPECT_LE(info[image][k]["visib_fract"].get<double>(), 1);
      num_visible += info[image][k]["px_count_visib"] > 0 ? 1 : 0;
      for (const char* folder : {"mask", "mask_visib"}) {
        EXPECT_TRUE(std::filesystem::exists(
            folder_ / fmt::format("out/test/000001/{}/{:06}_{:06}.png", folder, i, k)));
      }
    }
  }
  EXPECT_EQ(json("out/test/000001/scene_gt_coco.json")["annotations"].size(), num_visible);
}

}  // namespace
}  // namespace trivet
