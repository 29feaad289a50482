/// A scan with map coordinates: all input and output of the program is in the scan's frame.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;

/// The camera's position on the map [m].
const Vector3d kCamera{512345.678, 5403210.987, 431.5};
const std::string kViewpoint = "512345.678,5403210.987,431.5";

class FarScan : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    const test::Shape bracket = test::bracket();
    ASSERT_TRUE(write_ply(*folder_ / "bracket.ply", test::cloud_of(bracket)));
    const Points points = test::render_scan({{&bracket, truth()}}).points;
    std::string near, far;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d p = points[i].cast<double>(), moved = p + kCamera;
      near += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
      far += fmt::format("{} {} {}\n", moved.x(), moved.y(), moved.z());
    }
    folder_->write("near.xyz", near);
    folder_->write("far.xyz", far);
    run({"train", "bracket.ply", "-o", "library.h5", "--preset", "fast"});
    run({"recognize", "library.h5", "near.xyz", "--viewpoint", "0,0,0", "--json", "near.json"});
    run({"recognize", "library.h5", "far.xyz", "--viewpoint", kViewpoint, "--json", "far.json"});
    nlohmann::json matrix = nlohmann::json::array();
    for (int i = 0; i < 16; ++i) {
      const auto value = static_cast<double>(truth().matrix()(i / 4, i % 4));
      matrix.push_back(i % 4 == 3 && i < 12 ? value + kCamera[i / 4] : value);
    }
    folder_->write(
        "set.json",
        nlohmann::json{{"unit", "m"},
                       {"models", {{"bracket", {{"file", "bracket.ply"}}}}},
                       {"scenes",
                        {{{"file", "far.xyz"},
                          {"viewpoint", {kCamera.x(), kCamera.y(), kCamera.z()}},
                          {"truth", {{{"model", "bracket"}, {"T_scene_model", matrix}}}}}}}}
            .dump());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static test::Outcome run(const std::vector<std::string>& arguments, int code = 0) {
    test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder_->path(), .environment = {}, .watch = {}});
    EXPECT_EQ(outcome.exit_code, code) << outcome.error;
    return outcome;
  }
  static nlohmann::json scene(const std::string& file) {
    return nlohmann::json::parse(test::read_bytes(*folder_ / file)).at("scenes").at(0);
  }
  static Vector3d place(const nlohmann::json& detection) {
    const nlohmann::json& T = detection.at("T_scene_model");
    return {T[0][3].get<double>(), T[1][3].get<double>(), T[2][3].get<double>()};
  }
  static Pose truth() { return test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F}); }
  static inline std::unique_ptr<test::TempDir> folder_;
};

TEST_F(FarScan, HasItsPosesInItsOwnFrame) {
  const nlohmann::json near = scene("near.json"), far = scene("far.json");
  ASSERT_EQ(near.at("detections").size(), 1U);
  ASSERT_EQ(far.at("detections").size(), 1U);
  const Vector3d moved = place(far["detections"][0]) - place(near["detections"][0]);
  EXPECT_LT((moved - kCamera).norm(), 1e-4) << "a float there has steps of 0.03 to 0.5 m";
  EXPECT_FALSE(near.contains("offset"));
  EXPECT_EQ(far.at("offset").size(), 3U);
  const test::Outcome outcome =
      run({"recognize", "library.h5", "far.xyz", "--viewpoint", kViewpoint, "--report", "out"});
  const Vector3d at = place(far["detections"][0]);
  const std::string text = fmt::format("{:.5f}, {:.5f}", at.x(), at.y());
  EXPECT_NE(outcome.out.find("at (" + text), std::string::npos) << outcome.out;
  EXPECT_NE(test::read_bytes(*folder_ / "out" / "index.html").find(text), std::string::npos);
}

TEST_F(FarScan, IsEvaluatedAgainstTruthInItsOwnFrame) {
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"evaluate", "library.h5", "set.json"},
        {"evaluate", "set.json", "--detections", "far.json"}}) {
    std::vector<std::string> arguments = how;
    arguments.insert(arguments.end(), {"--json", "-"});
    const nlohmann::json judged = nlohmann::json::parse(run(arguments).out);
    EXPECT_EQ(judged.at("right"), 1) << judged.dump(1).substr(0, 2000);
    EXPECT_EQ(judged.at("instances"), 1);
  }
}

TEST_F(FarScan, ReadsExpectedPosesBack) {
  run({"recognize", "library.h5", "far.xyz", "--viewpoint", kViewpoint, "--expected", "far.json",
       "--rounds", "0", "--json", "again.json"});
  ASSERT_EQ(scene("again.json").at("detections").size(), 1U);
  const Vector3d again = place(scene("again.json")["detections"][0]);
  EXPECT_LT((again - place(scene("far.json")["detections"][0])).norm(), 1e-3);
}

TEST_F(FarScan, IsMeshedInItsOwnFrame) {
  run({"mesh", "far.xyz", "-o", "mesh.ply", "--viewpoint", kViewpoint});
  const auto scan = read_cloud(*folder_ / "far.xyz"), mesh = read_cloud(*folder_ / "mesh.ply");
  ASSERT_TRUE(scan && mesh);
  EXPECT_NE(test::read_bytes(*folder_ / "mesh.ply").find("property double x"), std::string::npos);
  EXPECT_EQ(mesh->offset, scan->offset);
  EXPECT_EQ(mesh->points[7], scan->points[7]);
}

TEST_F(FarScan, NeedsItsSensorAndIsNoModel) {
  const test::Outcome blind = run({"recognize", "library.h5", "far.xyz"}, 65);
  EXPECT_NE(blind.error.find("give its position in the file's frame with --viewpoint"),
            std::string::npos)
      << blind.error;
  const test::Outcome model = run({"train", "far.xyz", "-o", "far.h5"}, 65);
  EXPECT_NE(model.error.find("subtract about (5123"), std::string::npos) << model.error;
}

}  // namespace
}  // namespace trivet
