/// `trivet evaluate` on stored detections: sums, tables, files and warnings.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// A scan with a bracket, which is found, and a lever, which is not.
class EvaluateCommand : public testing::Test {
 protected:
  EvaluateCommand() {
    const test::Shape bracket = test::bracket(), lever = test::lever();
    write("bracket.ply", test::cloud_of(bracket));
    write("lever.ply", test::cloud_of(lever));
    const Pose at = test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F});
    const Pose beside = test::pose_of({0.3F, 0.2F, 0.1F}, {0.15F, 0.1F, 0.9F});
    write("scan.ply", test::render_scan({{&bracket, at}, {&lever, beside}}));
    folder_.write("set.json",
                  R"({"unit": "m", "models": {"bracket": {"file": "bracket.ply"},
                      "lever": {"file": "lever.ply"}},
                      "scenes": [{"file": "scan.ply", "camera": null, "viewpoint": [0, 0, 0],
                      "truth": [)" +
                      truth("bracket", at, 0.25) + ", " + truth("lever", beside, 0.75) + "]}]}");
    // Only fields that every program can provide. The second detection is far off, the third has an
    // unknown name.
    folder_.write("found.json", R"({"scenes": [{"scene": "scan.ply", "detections": [)" +
                                    detection("bracket", 0.9, at) + ", " +
                                    detection("lever", 0.4, at) + ", " +
                                    detection("gear, \"G\"", 0.3, at) + "]}]}");
  }

  void write(const char* name, const Cloud& cloud) const {
    const Result<void> written = write_ply(folder_ / name, cloud);
    ASSERT_TRUE(written) << written.error().message;
  }
  static nlohmann::json matrix(const Pose& pose) {
    nlohmann::json numbers = nlohmann::json::array();
    for (int i = 0; i < 16; ++i) numbers.push_back(pose.matrix()(i / 4, i % 4));
    return numbers;
  }
  static std::string truth(const char* model, const Pose& pose, double occlusion) {
    return nlohmann::json{
        {"model", model}, {"T_scene_model", matrix(pose)}, {"occlusion", occlusion}}
        .dump();
  }
  static std::string detection(const char* model, double score, const Pose& pose) {
    return nlohmann::json{{"model", model}, {"score", score}, {"T_scene_model", matrix(pose)}}
        .dump();
  }
  test::Outcome trivet(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  test::Outcome run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"evaluate", "set.json", "--detections", "found.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return trivet(arguments);
  }
  void train(const std::string& model) const {
    const test::Outcome outcome = trivet({"train", model, "-o", "models.h5", "--preset", "fast"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  std::vector<std::string> lines(const std::string& name) const {
    std::istringstream text(test::read_bytes(folder_ / name));
    std::vector<std::string> out;
    for (std::string line; std::getline(text, line);) out.push_back(line);
    return out;
  }
  const test::TempDir folder_;
};

TEST_F(EvaluateCommand, NeedsNoLibraryToScoreStoredDetections) {
  const test::Outcome outcome = run({"--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json scores = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(scores["instances"], 2);
  EXPECT_EQ(scores["right"], 1);
  EXPECT_EQ(scores["false_positives"], 1) << "everything that is stored was reported";
  EXPECT_EQ(scores["precision"], 0.5);
  EXPECT_EQ(scores["by_occlusion"]["70-80%"]["right"], 0);
  EXPECT_EQ(scores["precision_recall"]["score"].size(), 2U);
  EXPECT_EQ(scores["calibration"]["bins"].size(), 10U);
  EXPECT_TRUE(scores["median_seconds"].empty()) << "no times were given";
  EXPECT_NE(outcome.error.find("gear"), std::string::npos) << "a name that the manifest lacks";
}

TEST_F(EvaluateCommand, CountsWhatReachesTheThreshold) {
  const test::Outcome outcome = run({"--json", "-", "--min-score", "0.5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json scores = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(scores["right"], 1);
  EXPECT_EQ(scores["false_positives"], 0);
  EXPECT_EQ(scores["precision_recall"]["score"].size(), 2U) << "the curve goes on";
}

TEST_F(EvaluateCommand, SaysWhichThresholdItUsed) {
  nlohmann::json scores = nlohmann::json::parse(run({"--json", "-"}).out);
  EXPECT_EQ(scores["threshold"]["min_score"], nullptr) << "all that is stored was reported";
  EXPECT_EQ(scores["threshold"]["lowest_kept_score"], nullptr);
  EXPECT_NE(run({}).out.find("all detections of found.json count as reported"), std::string::npos);
  scores = nlohmann::json::parse(run({"--json", "-", "--min-score", "0.25", "--require-pose"}).out);
  EXPECT_EQ(scores["threshold"]["min_score"], 0.25);
  EXPECT_EQ(scores["threshold"]["require_pose"], true);
  const std::string text = run({"--min-score", "0.25"}).out;
  EXPECT_NE(text.find("score 0.25 and above"), std::string::npos) << text;

  train("bracket.ply");
  const test::Outcome outcome =
      trivet({"evaluate", "models.h5", "set.json", "--json", "-", "--quiet"});
  scores = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(scores["threshold"]["min_score"].get<double>(), 0.8, 1e-6);
  EXPECT_NEAR(scores["threshold"]["lowest_kept_score"].get<double>(), 0.1, 1e-6);
}

TEST_F(EvaluateCommand, CountsOnlyTheVeryPosesIfThatIsRequired) {
  nlohmann::json found = nlohmann::json::parse(test::read_bytes(folder_ / "found.json"));
  found["scenes"][0]["detections"][0]["pose_share"] = 0.5;  // of 0.9
  folder_.write("found.json", found.dump());
  for (const auto& [least, right] : {std::pair{"0.4", 1}, {"0.5", 0}}) {
    const test::Outcome outcome = run({"--json", "-", "--min-score", least, "--require-pose"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["right"], right) << least;
  }
}

TEST_F(EvaluateCommand, WritesTablesForSpreadsheets) {
  ASSERT_EQ(run({"--csv", "tables"}).exit_code, 0);
  const auto instances = lines("tables/instances.csv");
  ASSERT_EQ(instances.size(), 3U);
  EXPECT_EQ(instances[0].substr(0, 24), "scene,truth,model,counts");
  EXPECT_EQ(instances[1].substr(0, 34), "scan.ply,0,bracket,1,0.25,,,1,0.9,");
  EXPECT_EQ(instances[2], "scan.ply,1,lever,1,0.75,,,0,,,,");
  const auto detections = lines("tables/detections.csv");
  ASSERT_EQ(detections.size(), 4U);
  EXPECT_EQ(detections[1].substr(detections[1].size() - 4), ",,,,") << "score parts are not given";
  EXPECT_NE(detections[2].find(",1,wrong,1,"), std::string::npos) << detections[2];
  EXPECT_EQ(detections[3].substr(0, 24), "scan.ply,2,\"gear, \"\"G\"\"\"");
  const auto summary = lines("tables/summary.csv");
  ASSERT_EQ(summary.size(), 6U);
  EXPECT_EQ(summary[1].substr(0, 12), "all,,2,1,0.5");
  const auto columns = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  for (const std::string& line : summary) EXPECT_EQ(columns(line), columns(summary[0])) << line;
}

TEST_F(EvaluateCommand, WritesAPageThatStandsAlone) {
  const test::Outcome outcome = run({"--report", "report"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::string page = test::read_bytes(folder_ / "report/index.html");
  for (const char* text : {"1 of 2 instances found", "Missed and wrong", "<svg", "bracket",
                           "prefers-color-scheme", "data:image/png"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  for (const char* text : {"http://", "https://", "<script", "src=\"pictures"})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report/pictures"));
}

TEST_F(EvaluateCommand, SaysWhyInstancesAreMissed) {
  ASSERT_EQ(trivet({"train", "bracket.ply", "lever.ply", "-o", "models.h5", "--preset", "fast"})
                .exit_code,
            0);
  const test::Outcome outcome =
      trivet({"evaluate", "models.h5", "set.json", "--min-score", "1", "--explain-missed", "--json",
              "scores.json", "--report", "page"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json scores = nlohmann::json::parse(test::read_bytes(folder_ / "scores.json"));
  const nlohmann::json& missed = scores["scenes"][0]["missed"];
  ASSERT_EQ(missed.size(), 2U) << scores;
  const std::string page = test::read_bytes(folder_ / "page/index.html");
  for (const nlohmann::json& truth : missed) {
    const std::string why = truth["why"];
    EXPECT_NE(why.find("was tested by rays here and has a score of"), std::string::npos) << why;
    EXPECT_NE(page.find("It was tested by rays here"), std::string::npos);
  }
  EXPECT_EQ(run({"--explain-missed"}).exit_code, 2);
}

TEST_F(EvaluateCommand, AsksForALibraryOrDetections) {
  const test::Outcome outcome = trivet({"evaluate", "set.json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.error.find("--detections"), std::string::npos) << outcome.error;
}

TEST_F(EvaluateCommand, RefusesALibraryOfOtherModels) {
  train("other=bracket.ply");
  const test::Outcome outcome = trivet({"evaluate", "models.h5", "set.json"});
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_EQ(outcome.out, "") << "no recall of what was not looked for";
  for (const char* text : {"models.h5", "set.json", "bracket, lever", "'other'"})
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
}

TEST_F(EvaluateCommand, SaysWhichModelsTheLibraryLacks) {
  train("bracket.ply");
  const test::Outcome outcome = trivet({"evaluate", "models.h5", "set.json", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("1 of 2 models"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("lever"), std::string::npos) << outcome.error;
  const nlohmann::json scores = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(scores["models_missing"], nlohmann::json({"lever"}));
  EXPECT_EQ(scores["instances"], 2) << "what is not looked for is not found";
}

TEST_F(EvaluateCommand, RefusesDetectionsOfOtherModels) {
  const Pose at = Pose::Identity();
  folder_.write("found.json", R"({"scenes": [{"scene": "scan.ply", "detections": [)" +
                                  detection("gear", 0.9, at) + "]}]}");
  const test::Outcome outcome = run({});
  EXPECT_EQ(outcome.exit_code, 65) << outcome.out;
  EXPECT_NE(outcome.error.find("'gear'"), std::string::npos) << outcome.error;
  folder_.write("found.json", R"({"scenes": [{"scene": "scan.ply", "detections": []}]})");
  EXPECT_EQ(run({}).exit_code, 0) << "nothing was found";
}

TEST_F(EvaluateCommand, NamesTheFaultOfForeignDetections) {
  for (const auto& [text, fault] :
       {std::pair{R"({"scenes": [{"scene": "scan.ply", "detections": [{"model": "lever"}]}]})",
                  "scenes[0].detections[0]"},
        {R"({"scenes": [{"scene": "scan.ply", "detections": []},
                        {"scene": "./scan.ply", "detections": []}]})",
         "scenes[1].scene: expected each scene once"},
        {R"({"detections": []})", "\"scenes\""}}) {
    folder_.write("found.json", text);
    const test::Outcome outcome = run({});
    EXPECT_EQ(outcome.exit_code, 65);
    EXPECT_NE(outcome.error.find(fault), std::string::npos) << outcome.error;
  }
}

}  // namespace
}  // namespace trivet
