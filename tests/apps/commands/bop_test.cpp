/// Recognition from a BOP data set to a BOP results file.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/datasets/bop_results.hpp"
#include "storage/datasets/write_bop.hpp"
#include "storage/formats/read_cloud.hpp"
#include "storage/formats/write_png.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// A data set of two parts and two images, with one part in the first and both in the second. Ids
/// begin with 0, as in some data sets of 2024.
class Bop : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    const std::vector<test::Shape> shapes{test::bracket(), test::lever()};
    const std::vector<int> ids{0, 9};
    fs::create_directories(*folder_ / "set/models");
    std::vector<BopObject> objects;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      Cloud cloud = test::cloud_of(shapes[i]);
      for (std::size_t v = 0; v < cloud.points.size(); ++v)
        cloud.points.set(v, 1000 * cloud.points[v]);
      ASSERT_TRUE(write_ply(*folder_ / "set/models" / (bop_model_name(ids[i]) + ".ply"), cloud));
      BopObject& object = objects.emplace_back();
      object.id = ids[i];
      object.diameter_mm = 200;
    }
    ASSERT_TRUE(write_bop_models_info(*folder_ / "set/models/models_info.json", objects));

    const fs::path scene = bop_scene_folder(*folder_ / "set/test", 1);
    std::vector<BopImage> images;
    for (const int id : {5, 6}) {
      BopImage image{id, {}, {}};
      std::vector<test::Placed> placed;
      for (std::size_t i = 0; i < (id == 5 ? 1U : 2U); ++i) {
        placed.push_back({&shapes[i], pose(i)});
        BopInstance& instance = image.instances.emplace_back();
        instance.object_id = ids[i];
        instance.T_camera_model = pose(i);
        instance.T_camera_model.translation() *= 1000;
        instance.visib_fract = 1;
      }
      const Cloud cloud = test::render_scan(placed);
      image.camera = *cloud.camera;
      image.camera.depth_scale = 0.1;
      fs::create_directories(scene / "depth");
      write_depth(bop_depth_file(scene, id), cloud);
      images.push_back(image);
    }
    ASSERT_TRUE(write_bop_scene(scene, images));
    scenes_ = {{1, images}};
    ASSERT_TRUE(write_bop_targets(*folder_ / "set", scenes_));
    const test::Outcome outcome = run({"train", "set", "-o", "set.h5", "--preset", "fast"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Pose pose(std::size_t i) {
    return i == 0 ? test::pose_of({2.1F, 0.7F, -0.4F}, {-0.12F, 0.03F, 0.85F})
                  : test::pose_of({0.5F, -1.1F, 0.3F}, {0.12F, -0.02F, 0.8F});
  }
  /// Writes depths in tenths of a millimeter.
  static void write_depth(const fs::path& file, const Cloud& cloud) {
    std::vector<std::uint16_t> depths;
    for (const std::int32_t point : cloud.grid->point_index) {
      const float z = point < 0 ? 0 : cloud.points.view().z[static_cast<std::size_t>(point)];
      depths.push_back(static_cast<std::uint16_t>(std::lround(z * 1e4F)));
    }
    ASSERT_TRUE(write_depth_png(file, depths, cloud.grid->width));
  }
  static test::Outcome run(const std::vector<std::string>& arguments) {
    return test::run_trivet(arguments, {folder_->path(), {}, {}});
  }
  static void expect_usage(const std::vector<std::string>& arguments, const std::string& text) {
    std::vector<std::string> all{"recognize"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--bop-csv", "unwritten.csv"});
    const test::Outcome outcome = run(all);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
    EXPECT_FALSE(fs::exists(*folder_ / "unwritten.csv"));
  }

  static inline std::unique_ptr<test::TempDir> folder_;
  static inline std::vector<BopScene> scenes_;
};

TEST_F(Bop, NamesModelsAsTheDataSetDoes) {
  EXPECT_EQ(run({"library", "list", "set.h5"}).out, "obj_000000\nobj_000009\n");
  const test::Outcome outcome = run({"train", "set", "-o", "again.h5", "--unit", "m"});
  EXPECT_EQ(outcome.exit_code, 2) << "a data set is in mm";
  EXPECT_NE(outcome.error.find("'mm'"), std::string::npos) << outcome.error;
}

TEST_F(Bop, WritesResultsThatTheBenchmarkAccepts) {
  const test::Outcome outcome = run({"recognize", "set.h5", "set", "--bop-csv", "found.csv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const auto results = read_bop_results(*folder_ / "found.csv");
  ASSERT_TRUE(results) << results.error().message;
  ASSERT_EQ(results->size(), 3U);
  for (const BopImage& image : scenes_[0].images) {
    for (const BopInstance& instance : image.instances) {
      const auto found = std::find_if(results->begin(), results->end(), [&](const BopResult& one) {
        return one.image_id == image.id && one.object_id == instance.object_id;
      });
      ASSERT_NE(found, results->end()) << image.id << ", " << instance.object_id;
      EXPECT_EQ(found->scene_id, 1);
      EXPECT_GT(found->score, 0.5);
      EXPECT_GT(found->seconds, 0);
      // The tolerance is a hundredth of the part's 200 mm, or of a radian.
      const Pose& truth = instance.T_camera_model;
      EXPECT_LT((found->t_mm - truth.translation().cast<double>()).norm(), 2);
      EXPECT_LT((found->R - truth.linear().cast<double>()).cwiseAbs().maxCoeff(), 0.02);
    }
  }
}

TEST_F(Bop, WritesWhatIsTooLowToBeReportedToo) {
  const auto recognize = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"recognize", "set.h5", "set", "--min-score", "0.9999"});
    more.insert(more.end(), {"--json", "-", "--quiet"});
    const test::Outcome outcome = run(more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    nlohmann::json detections = nlohmann::json::array();
    const nlohmann::json document = nlohmann::json::parse(outcome.out);
    for (const nlohmann::json& scene : document["scenes"])
      detections.push_back(scene["detections"]);
    return detections;
  };
  const nlohmann::json reported = recognize({});
  EXPECT_EQ(recognize({"--bop-csv", "low.csv"}), reported) << "the threshold holds for the rest";
  EXPECT_EQ(recognize({"--bop-csv", "low.csv", "--report", "low"}), reported);
  const auto results = read_bop_results(*folder_ / "low.csv");
  ASSERT_TRUE(results) << results.error().message;
  EXPECT_GE(results->size(), 3U) << "all that stands there";
  EXPECT_LT(reported[0].size() + reported[1].size(), results->size());
  const std::string page = test::read_bytes(*folder_ / "low/index.html");
  EXPECT_NE(page.find("rejected"), std::string::npos);
}

TEST_F(Bop, WritesMasksOfWhatWasFound) {
  const test::Outcome outcome = run({"recognize", "set.h5", "set", "--coco", "trivet_set-test.json",
                                     "--bop-csv", "trivet_set-test.csv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.error.find("METHOD_DATASET-SPLIT"), std::string::npos) << outcome.error;
  const auto poses = read_bop_results(*folder_ / "trivet_set-test.csv");
  const nlohmann::json masks =
      nlohmann::json::parse(test::read_bytes(*folder_ / "trivet_set-test.json"));
  ASSERT_TRUE(poses);
  ASSERT_GE(masks.size(), 3U);
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const nlohmann::json& mask = masks[i];
    EXPECT_EQ(mask["image_id"], (*poses)[i].image_id);
    EXPECT_EQ(mask["category_id"], (*poses)[i].object_id);
    EXPECT_EQ(mask["score"], (*poses)[i].score);
    // Each part is unoccluded: its bounding box encloses its mask, and its center projects onto the
    // mask or near it.
    std::size_t pixels = 0, sum = 0;
    const auto& counts = mask["segmentation"]["counts"];
    for (std::size_t k = 0; k < counts.size(); ++k) {
      sum += counts[k].get<std::size_t>();
      pixels += k % 2 == 1 ? counts[k].get<std::size_t>() : 0;
    }
    EXPECT_EQ(sum, mask["segmentation"]["size"][0].get<std::size_t>() *
                       mask["segmentation"]["size"][1].get<std::size_t>());
    const double area = mask["bbox"][2].get<double>() * mask["bbox"][3].get<double>();
    EXPECT_GT(static_cast<double>(pixels), 0.1 * area);
    EXPECT_LE(static_cast<double>(pixels), area);
    const Camera& camera = scenes_[0].images[0].camera;
    const Eigen::Vector3d& t = (*poses)[i].t_mm;
    EXPECT_NEAR(mask["bbox"][0].get<double>() + mask["bbox"][2].get<double>() / 2,
                camera.fx * t.x() / t.z() + camera.cx, mask["bbox"][2].get<double>());
  }
}

TEST_F(Bop, WarnsOfNamesThatTheBenchmarkDoesNotKnow) {
  const test::Outcome written = run({"recognize", "set.h5", "set", "--bop-csv", "found.csv"});
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_NE(written.error.find("METHOD_DATASET-SPLIT"), std::string::npos) << written.error;
  const test::Outcome read = run({"evaluate", "set", "--detections", "found.csv"});
  EXPECT_EQ(read.exit_code, 0);
  EXPECT_NE(read.error.find("METHOD_DATASET-SPLIT"), std::string::npos) << read.error;
}

TEST_F(Bop, GivesTheSameDetectionsForTheFolderOfTheSplit) {
  const auto lines = [&](const std::string& scenes) {
    EXPECT_EQ(run({"recognize", "set.h5", scenes, "--json", "found.json", "--bop-csv", "found.csv"})
                  .exit_code,
              0);
    std::string text;
    const auto results = read_bop_results(*folder_ / "found.csv");
    for (const BopResult& result : *results)
      text += std::to_string(result.object_id) + " " + std::to_string(result.score) + "\n";
    return text;
  };
  EXPECT_EQ(lines("set"), lines("set/test"));
  EXPECT_TRUE(fs::exists(*folder_ / "found.json"));
}

TEST_F(Bop, JudgesADataSetRecognizedNowOrByAFileOfResults) {
  const auto scores = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    arguments.insert(arguments.end(), {"--json", "-", "--quiet"});
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return nlohmann::json::parse(outcome.out);
  };
  ASSERT_EQ(run({"recognize", "set.h5", "set", "--bop-csv", "found.csv"}).exit_code, 0);
  for (const nlohmann::json& judged :
       {scores({"set.h5", "set"}), scores({"set", "--detections", "found.csv"})}) {
    EXPECT_EQ(judged["instances"], 3);
    EXPECT_EQ(judged["right"], 3);
    EXPECT_EQ(judged["false_positives"], 0);
    EXPECT_EQ(judged["bop"]["localization"]["targets"], 3);
    EXPECT_GT(judged["bop"]["localization"]["ar"].get<double>(), 0.95);
    EXPECT_GT(judged["bop"]["detection"]["ap"].get<double>(), 0.95);
  }
  const nlohmann::json now = scores({"set.h5", "set", "--min-score", "0.9999"}),
                       stored = scores({"set", "--detections", "found.csv"});
  EXPECT_EQ(now["bop"]["localization"]["ar"], stored["bop"]["localization"]["ar"]);
  EXPECT_EQ(now["bop"]["detection"]["ap"], stored["bop"]["detection"]["ap"]);
  const test::Outcome refused = run({"evaluate", "set/manifest.json", "--detections", "found.csv"});
  EXPECT_EQ(refused.exit_code, 66) << refused.error;
}

TEST_F(Bop, ReadsTheCameraOfAnImageFromSceneCamera) {
  const std::string scene = "set/test/000001/", camera = scene + "scene_camera.json";
  const auto found = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"recognize", "set.h5"});
    more.insert(more.end(), {"--camera", camera, "--json", "-", "--quiet"});
    const test::Outcome outcome = run(more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    std::vector<std::size_t> counts;
    const nlohmann::json document = nlohmann::json::parse(outcome.out);
    for (const nlohmann::json& one : document["scenes"]) counts.push_back(one["detections"].size());
    return counts;
  };
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(found({scene + "depth/000006.png"}), Counts({2}));
  EXPECT_EQ(found({scene + "depth"}), Counts({1, 2}));
  fs::copy_file(*folder_ / scene / "depth/000006.png", *folder_ / "scan.png");
  EXPECT_EQ(found({"scan.png", "--image-id", "6"}), Counts({2}));

  const test::Outcome unnamed = run({"recognize", "set.h5", "scan.png", "--camera", camera});
  EXPECT_EQ(unnamed.exit_code, 65);
  EXPECT_NE(unnamed.error.find("--image-id"), std::string::npos) << unnamed.error;
  const test::Outcome absent =
      run({"recognize", "set.h5", "scan.png", "--camera", camera, "--image-id", "8"});
  EXPECT_EQ(absent.exit_code, 65);
  EXPECT_NE(absent.error.find("\"8\""), std::string::npos) << absent.error;
  const test::Outcome meshed =
      run({"mesh", scene + "depth/000006.png", "--camera", camera, "-o", "surface.ply"});
  EXPECT_EQ(meshed.exit_code, 0) << meshed.error;
}

TEST_F(Bop, RefusesResultsThatWouldLackTheirNumbers) {
  const test::Shape bracket = test::bracket();
  ASSERT_TRUE(write_ply(*folder_ / "scan.ply", test::render_scan({{&bracket, pose(0)}})));
  expect_usage({"set.h5", "scan.ply", "--unit", "m"}, "BOP data set");
  expect_usage({"set.h5", "set", "set/test"}, "image 5 of scene 1 once");
  ASSERT_EQ(run({"train", "part=set/models/obj_000000.ply", "set/models/obj_000009.ply", "-o",
                 "named.h5", "--unit", "mm", "--preset", "fast"})
                .exit_code,
            0);
  expect_usage({"named.h5", "set"}, "'part'");
  const test::Outcome outcome =
      run({"recognize", "named.h5", "set", "--models", "obj_000009", "--bop-csv", "chosen.csv"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  const auto results = read_bop_results(*folder_ / "chosen.csv");
  ASSERT_TRUE(results && !results->empty());
  for (const BopResult& result : *results) EXPECT_EQ(result.object_id, 9);
}

}  // namespace
}  // namespace trivet
