/// `trivet calibrate` on marked detections and on scans with ground truth, and the effects of its
/// file.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "engine/loaded_library/default_score.hpp"
#include "engine/loaded_library/score_calibration.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Json = nlohmann::json;

/// Detections in the format of `trivet recognize --json`, marked like those of a cell in which the
/// default score is too confident.
Json marked_result(std::size_t num_scans) {
  test::Random random;
  const kernels::ScoreModel& model = default_score();
  Json scenes = Json::array();
  for (std::size_t s = 0; s < num_scans; ++s) {
    Json detections = Json::array();
    for (int i = 0; i < 40; ++i) {
      Json parts;
      kernels::ScoreParts values{};
      const float best = i % 2 == 0 ? random.uniform(0.7F, 1) : random.uniform(0, 1);
      for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k) {
        const auto& knots = model.knots[k];
        const bool good_is_high = kernels::kScoreParts[k].favorable;
        const float good = good_is_high ? knots.back() : knots.front(),
                    bad = good_is_high ? knots.front() : knots.back();
        values[k] = std::lerp(std::lerp(bad, good, random.uniform(0, 1)), good, best);
      }
      values[kernels::kCorrelationPart] = 0;
      for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k)
        parts[std::string(kernels::kScoreParts[k].name)] = values[k];
      const float p = kernels::pose_probability(model, values);
      const float odds = std::exp(-2.0F) * p / (1 - std::min(p, 0.9999F));
      detections.push_back({{"model", "bracket"},
                            {"score", p},
                            {"parts", parts},
                            {"right", random.uniform(0, 1) < odds / (1 + odds)}});
    }
    detections.push_back({{"model", "bracket"}, {"score", 0.1}});  // not marked: ignored
    scenes.push_back({{"scene", "scan_" + std::to_string(s)}, {"detections", detections}});
  }
  return {{"scenes", scenes}};
}

class CalibrateCommand : public testing::Test {
 protected:
  test::Outcome run(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  /// Two models, a library of both and a scan of one with its truth.
  void make_library() const {
    const test::Shape bracket = test::bracket();
    const Pose at = test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F});
    ASSERT_TRUE(write_ply(folder_ / "bracket.ply", test::cloud_of(bracket)));
    ASSERT_TRUE(write_ply(folder_ / "scan.ply", test::render_scan({{&bracket, at}})));
    ASSERT_EQ(run({"train", "bracket.ply", "-o", "l.h5", "--preset", "fast", "--methods", "ppf"})
                  .exit_code,
              0);
  }
  Json recognized(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"recognize", "l.h5", "scan.ply", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return Json::parse(outcome.out);
  }

  const test::TempDir folder_;
};

TEST_F(CalibrateCommand, ReportsWhatMarkedDetectionsChange) {
  folder_.write("found.json", marked_result(5).dump());
  const test::Outcome outcome = run({"calibrate", "--marked", "found.json", "-o", "cell.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* text : {"5 scans with", "log loss", "counts for more", "counts for less",
                           "no wrong ones", "with 95 % certainty", "cell.json: calibration"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << " in\n" << outcome.out;
  }
  const Result<ScoreCalibration> read = read_calibration(folder_ / "cell.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->num_scans, 5U);
  EXPECT_EQ(read->num_right + read->num_wrong, 200U);
  EXPECT_LT(read->adaptation.shift, 0);
  // The output has the same bytes again.
  const std::string bytes = test::read_bytes(folder_ / "cell.json");
  ASSERT_EQ(run({"calibrate", "--marked", "found.json", "-o", "cell.json"}).exit_code, 0);
  EXPECT_EQ(test::read_bytes(folder_ / "cell.json"), bytes);
}

TEST_F(CalibrateCommand, CountsAScanThatWasRecognizedTwiceOnce) {
  folder_.write("found.json", marked_result(2).dump());
  ASSERT_EQ(run({"calibrate", "--marked", "found.json", "found.json", "-o", "cell.json"}).exit_code,
            0);
  EXPECT_EQ(read_calibration(folder_ / "cell.json")->num_scans, 2U);
}

TEST_F(CalibrateCommand, NamesTheFaultOfMarks) {
  const auto refusal = [&](const Json& result) {
    folder_.write("found.json", result.dump());
    const test::Outcome outcome = run({"calibrate", "--marked", "found.json", "-o", "cell.json"});
    EXPECT_EQ(outcome.exit_code, 65) << outcome.out;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "cell.json"));
    return outcome.error;
  };
  Json result = marked_result(1);
  EXPECT_NE(refusal(result).find("at least 2 scans"), std::string::npos);
  result["scenes"][0]["detections"][3]["right"] = "yes";
  EXPECT_NE(refusal(result).find("scenes[0].detections[3].right"), std::string::npos);
  result = marked_result(2);
  result["scenes"][1]["detections"][2].erase("parts");
  EXPECT_NE(refusal(result).find("scenes[1].detections[2]"), std::string::npos);
  for (Json& scene : result["scenes"])
    for (Json& detection : scene["detections"]) detection.erase("right");
  EXPECT_NE(refusal(result).find("mark them"), std::string::npos);
}

TEST_F(CalibrateCommand, AsksForScansOrMarks) {
  EXPECT_EQ(run({"calibrate", "-o", "cell.json"}).exit_code, 2);
  EXPECT_EQ(run({"calibrate", "l.h5", "-o", "cell.json"}).exit_code, 2);
  EXPECT_EQ(
      run({"calibrate", "--marked", "f.json", "--min-score", "0.2", "-o", "cell.json"}).exit_code,
      2);
}

TEST_F(CalibrateCommand, RecognizesScansOfKnownTruth) {
  make_library();
  const Json pose = Json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1});
  const Json scene{{"file", "scan.ply"},
                   {"camera", nullptr},
                   {"viewpoint", {0, 0, 0}},
                   {"truth", {{{"model", "bracket"}, {"T_scene_model", pose}}}}};
  folder_.write(
      "set.json",
      Json{{"unit", "m"}, {"models", {{"bracket", {{"file", "bracket.ply"}}}}}, {"scenes", {scene}}}
          .dump());
  const test::Outcome outcome = run({"calibrate", "l.h5", "set.json", "-o", "cell.json"});
  EXPECT_EQ(outcome.exit_code, 65) << outcome.error;
  EXPECT_NE(outcome.error.find("found 1 with"), std::string::npos) << outcome.error;
}

TEST_F(CalibrateCommand, ChangesWhatIsRecognized) {
  make_library();
  ScoreCalibration calibration{{}, 5, 30, 60};
  ASSERT_TRUE(write_calibration(folder_ / "none.json", calibration));
  calibration.adaptation.shift = -1;
  ASSERT_TRUE(write_calibration(folder_ / "cell.json", calibration));

  const Json before = recognized({});
  EXPECT_TRUE(before.contains("calibration") && before["calibration"].is_null());
  EXPECT_TRUE(recognized({"--calibration", "none.json"})["calibration"].is_null());
  const Json after = recognized({"--calibration", "cell.json"});
  EXPECT_EQ(after["calibration"], score_name(calibrated_score(calibration)));
  ASSERT_EQ(before["scenes"][0]["detections"].size(), 1U);
  ASSERT_EQ(after["scenes"][0]["detections"].size(), 1U);
  const auto log_odds = [](const Json& result) {
    const double score = result["scenes"][0]["detections"][0]["score"];
    return std::log(score / (1 - score));
  };
  EXPECT_NEAR(log_odds(after), log_odds(before) - 1, 0.05);

  ASSERT_EQ(run({"recognize", "l.h5", "scan.ply", "--calibration", "cell.json", "--report", "out"})
                .exit_code,
            0);
  EXPECT_NE(
      test::read_bytes(folder_ / "out/index.html").find(score_name(calibrated_score(calibration))),
      std::string::npos);
  folder_.write("cell.json", "{}");
  EXPECT_EQ(run({"recognize", "l.h5", "scan.ply", "--calibration", "cell.json"}).exit_code, 65);
  EXPECT_EQ(run({"recognize", "l.h5", "scan.ply", "--calibration", "absent.json"}).exit_code, 66);
}

}  // namespace
}  // namespace trivet
