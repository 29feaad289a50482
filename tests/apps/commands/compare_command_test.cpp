/// `trivet compare` on two results.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Json = nlohmann::json;

constexpr float kDegree = std::numbers::pi_v<float> / 180;

class CompareCommand : public testing::Test {
 protected:
  static Json detection(const char* model, double score, const Pose& pose) {
    Json rows = Json::array();
    for (int i = 0; i < 4; ++i) {
      const Eigen::Matrix4f m = pose.matrix();
      rows.push_back({m(i, 0), m(i, 1), m(i, 2), m(i, 3)});
    }
    return {{"model", model}, {"score", score}, {"T_scene_model", rows}};
  }
  static Json scene(const char* name, double seconds, const std::vector<Json>& detections) {
    return {{"scene", name}, {"seconds", {{"total", seconds}}}, {"detections", detections}};
  }
  void write(const char* name, const std::vector<Json>& scenes) const {
    folder_.write(name, Json{{"scenes", scenes}}.dump());
  }
  /// Writes an evaluation of scenes with five truths each: which were found, and the number of
  /// false detections.
  void write_evaluation(const char* name, const std::vector<std::vector<int>>& found,
                        const std::vector<int>& num_false) const {
    Json scenes = Json::array();
    for (std::size_t s = 0; s < found.size(); ++s) {
      Json detections = Json::array(), missed = Json::array();
      for (int t = 0; t < 5; ++t) {
        if (std::ranges::count(found[s], t) == 0) {
          missed.push_back({{"model", "nut"}, {"truth", t}});
          continue;
        }
        detections.push_back({{"model", "nut"},
                              {"score", 0.9},
                              {"reported", true},
                              {"verdict", "right"},
                              {"truth", t}});
      }
      for (int k = 0; k < num_false[s]; ++k) {
        detections.push_back(
            {{"model", "nut"}, {"score", 0.85}, {"reported", true}, {"verdict", "wrong"}});
      }
      // A detection below the threshold is ignored.
      detections.push_back(
          {{"model", "nut"}, {"score", 0.1}, {"reported", false}, {"verdict", "wrong"}});
      scenes.push_back({{"scene", "scan" + std::to_string(s)},
                        {"seconds", 0.5},
                        {"detections", detections},
                        {"missed", missed}});
    }
    folder_.write(
        name,
        Json{{"threshold", {{"min_score", 0.8}}}, {"by_model", Json::object()}, {"scenes", scenes}}
            .dump());
  }
  test::Outcome trivet(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  Json compared(std::vector<std::string> more) const {
    more.insert(more.begin(), {"compare", "a.json", "b.json", "--json", "-"});
    const test::Outcome outcome = trivet(more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return Json::parse(outcome.out, nullptr, false);
  }

  const test::TempDir folder_;
  const Pose at_ = test::pose_of({0.4F, 0.2F, -0.3F}, {0.1F, 0.2F, 1});
};

TEST_F(CompareCommand, PairsTheNearestPosesOfOneModel) {
  const Pose near = test::pose_of({0.4F, 0.2F, -0.3F}, {0.101F, 0.2F, 1}),
             nearer = test::pose_of({0.4F, 0.2F, -0.3F}, {0.1005F, 0.2F, 1}),
             far = test::pose_of({0.4F, 0.2F, -0.3F}, {0.2F, 0.2F, 1});
  write("a.json",
        {scene("one.ply", 0.25, {detection("nut", 0.99, at_), detection("nut", 0.9, far)}),
         scene("two.ply", 0.5, {detection("nut", 0.8, at_)})});
  write("b.json",
        {scene("two.ply", 0.75, {detection("bolt", 0.8, at_)}),
         scene("one.ply", 0.125, {detection("nut", 0.97, near), detection("nut", 0.96, nearer)})});
  const Json report = compared({"--max-translation", "0.01"});
  EXPECT_EQ(report["total"]["both"], 1);
  EXPECT_EQ(report["total"]["only_a"], 2);
  EXPECT_EQ(report["total"]["only_b"], 2);
  EXPECT_EQ(report["total"]["seconds_a"], 0.75);
  EXPECT_EQ(report["total"]["seconds_b"], 0.875);
  EXPECT_EQ(report["paired"], nullptr);
  const Json& one = report["scenes"][0];
  EXPECT_EQ(one["scene"], "one.ply");
  EXPECT_NEAR(one["both"][0]["score"].get<double>(), 0.99, 1e-6);
  EXPECT_NEAR(one["both"][0]["score_b"].get<double>(), 0.96, 1e-6);
  EXPECT_NEAR(one["only_b"][0]["score"].get<double>(), 0.97, 1e-6);
  EXPECT_NEAR(one["only_a"][0]["T_scene_model"][0][3].get<double>(), 0.2, 1e-6);

  const test::Outcome text = trivet({"compare", "a.json", "b.json", "--max-translation", "0.0001"});
  EXPECT_EQ(text.exit_code, 0) << text.error;
  EXPECT_NE(text.out.find(
                "2 scenes                                  0       3       3     0.750     0.875"),
            std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("two.ply: bolt, score 0.800, at 0.1, 0.2, 1"), std::string::npos);
}

TEST_F(CompareCommand, KnowsSizesAndSymmetriesByTheLibrary) {
  const Result<void> written = write_ply(folder_ / "bracket.ply", test::cloud_of(test::bracket()));
  ASSERT_TRUE(written);
  folder_.write("set.json", R"({"unit": "m", "models": {"bracket": {"file": "bracket.ply",
      "symmetries": [[[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]]}}})");
  const test::Outcome trained =
      trivet({"train", "set.json", "-o", "l.h5", "--preset", "fast", "--methods", "ppf"});
  ASSERT_EQ(trained.exit_code, 0) << trained.error;
  const Pose half_turn(Eigen::AngleAxisf(180 * kDegree, Eigen::Vector3f::UnitZ())),
      quarter_turn(Eigen::AngleAxisf(90 * kDegree, Eigen::Vector3f::UnitZ()));
  const auto both_found = [&](const Pose& turn, const std::vector<std::string>& by) {
    write("a.json", {scene("one.ply", 1, {detection("bracket", 0.9, at_)})});
    write("b.json", {scene("one.ply", 1, {detection("bracket", 0.9, at_ * turn)})});
    return compared(by)["total"]["both"].get<int>();
  };
  EXPECT_EQ(both_found(half_turn, {"--library", "l.h5"}), 1);
  EXPECT_EQ(both_found(quarter_turn, {"--library", "l.h5"}), 0);
  EXPECT_EQ(both_found(half_turn, {"--max-translation", "1"}), 0);
  // In scenes in millimeters the same poses are a thousandth apart.
  const Pose shifted(Eigen::Translation3f(0.05F, 0, 0));
  EXPECT_EQ(both_found(shifted, {"--library", "l.h5"}), 0);
  EXPECT_EQ(both_found(shifted, {"--library", "l.h5", "--unit", "mm"}), 1);
}

TEST_F(CompareCommand, TestsWithTruthWhetherADifferenceIsMoreThanChance) {
  write_evaluation("a.json", {{0, 1, 2, 3, 4}, {0, 1, 2, 3, 4}, {0, 1, 2}}, {0, 1, 0});
  write_evaluation("b.json", {{0, 1, 2}, {0, 1, 2}, {1, 2, 3}}, {0, 0, 2});
  const Json report = compared({});
  EXPECT_EQ(report["total"]["both"], 8);
  EXPECT_EQ(report["total"]["only_a"], 5);
  EXPECT_EQ(report["total"]["only_b"], 1);
  EXPECT_EQ(report["total"]["neither"], 1);
  EXPECT_EQ(report["total"]["false_a"], 1);
  EXPECT_EQ(report["total"]["false_b"], 2);
  EXPECT_NEAR(report["paired"]["difference"].get<double>(), 4.0 / 15, 1e-12);
  // The chance that of six fair coins at most one falls on a side, for either side.
  EXPECT_NEAR(report["paired"]["p"].get<double>(), 2 * (1 + 6) / 64.0, 1e-12);
  EXPECT_LE(report["paired"]["difference_95_low"], report["paired"]["difference"]);
  EXPECT_EQ(report["scenes"][2]["only_b"][0]["truth"], 3);
}

TEST_F(CompareCommand, SaysWhatCannotBeCompared) {
  const auto refuses = [&](const std::vector<std::string>& more, int code, const char* words) {
    std::vector<std::string> arguments{"compare", "a.json", "b.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = trivet(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.error;
    EXPECT_NE(outcome.error.find(words), std::string::npos) << outcome.error;
  };
  refuses({}, 66, "a.json");
  const std::vector<std::string> tolerance{"--max-translation", "1"};
  write("a.json", {scene("one.ply", 1, {detection("nut", 0.9, at_)})});
  folder_.write("b.json", R"({"models": []})");
  refuses(tolerance, 65, "b.json: the document: expected a result of `trivet recognize --json`");
  write("b.json", {scene("two.ply", 1, {})});
  refuses(tolerance, 65, "'two.ply' among them");
  write("b.json", {});
  refuses(tolerance, 65, "expected the 1 scene of a.json, each once, found 0 scenes");
  write("b.json", {scene("one.ply", 1, {})});
  refuses({}, 2, "expected --library");
  write_evaluation("b.json", {{0}}, {0});
  refuses(tolerance, 65, "a.json: expected a result of `trivet evaluate` as b.json");
  folder_.write("b.json",
                R"({"scenes": [{"scene": "one.ply", "detections": [{"model": "nut"}]}]})");
  refuses(tolerance, 65, "b.json: scenes[0].detections[0]");
}

}  // namespace
}  // namespace trivet
