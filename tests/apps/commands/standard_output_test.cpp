/// Output written to standard output arrives there, or the command fails with the reason.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// A library of a bracket, a scan of it and its truth.
class StandardOutput : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    const test::Shape bracket = test::bracket();
    const Pose pose = test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F});
    ASSERT_TRUE(write_ply(*folder_ / "bracket.ply", test::cloud_of(bracket)));
    ASSERT_TRUE(write_ply(*folder_ / "scan.ply", test::render_scan({{&bracket, pose}})));
    Cloud scan = test::render_scan({{&bracket, pose}});
    for (std::size_t i = 0; i < scan.points.size(); ++i) scan.points.set(i, 1000 * scan.points[i]);
    ASSERT_TRUE(write_ply(*folder_ / "scan_mm.ply", scan));
    const test::Shape lever = test::lever();
    ASSERT_TRUE(write_ply(*folder_ / "lever.ply", test::render_scan({{&lever, pose}})));
    nlohmann::json numbers = nlohmann::json::array();
    for (int i = 0; i < 16; ++i) numbers.push_back(pose.matrix()(i / 4, i % 4));
    const nlohmann::json set{
        {"unit", "m"},
        {"models", {{"bracket", {{"file", "bracket.ply"}}}}},
        {"scenes",
         {{{"file", "scan.ply"},
           {"camera", nullptr},
           {"viewpoint", {0, 0, 0}},
           {"truth", {{{"model", "bracket"}, {"T_scene_model", numbers}, {"occlusion", 0}}}}}}}};
    folder_->write("set.json", set.dump());
    ASSERT_EQ(shell(std::string(TRIVET_PROGRAM) +
                    " train bracket.ply -o library.h5 --preset fast --methods ppf")
                  .exit_code,
              0);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static test::Outcome shell(const std::string& line) {
    return test::run_program("/bin/sh", {"-c", line},
                             {.folder = folder_->path(), .environment = {}, .watch = {}});
  }
  static test::Outcome run(const std::string& arguments) {
    return shell(std::string(TRIVET_PROGRAM) + " " + arguments);
  }
  static inline std::unique_ptr<test::TempDir> folder_;
};

TEST_F(StandardOutput, IsAnErrorOfInputAndOutputWhereItCannotBeWritten) {
  for (const std::string arguments : {
           "--help",
           "recognize --help",
           "--version",
           "--help-markdown",
           "library list library.h5",
           "library info library.h5",
           "library info library.h5 --json -",
           "library export library.h5 -o parts",
           "recognize library.h5 scan.ply",
           "recognize library.h5 scan.ply --json -",
           "evaluate library.h5 set.json",
           "evaluate library.h5 set.json --json -",
       }) {
    const test::Outcome outcome =
        shell(fmt::format("{} {} > /dev/full", TRIVET_PROGRAM, arguments));
    EXPECT_EQ(outcome.exit_code, 74) << arguments << ": " << outcome.error;
    EXPECT_NE(outcome.error.find("error: standard output: "), std::string::npos)
        << arguments << ": " << outcome.error;
    EXPECT_EQ(outcome.error.find("please report"), std::string::npos) << outcome.error;
  }
}

// There is nowhere to report the error.
TEST_F(StandardOutput, IsWrittenEvenWhereStandardErrorCannotBe) {
  const test::Outcome outcome =
      shell(std::string(TRIVET_PROGRAM) + " recognize library.h5 scan.ply 2> /dev/full");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.out.find("1 found"), std::string::npos) << outcome.out;
  EXPECT_EQ(shell(std::string(TRIVET_PROGRAM) + " recognize no.h5 scan.ply 2> /dev/full").exit_code,
            66);
}

TEST_F(StandardOutput, PrintsLengthsWithTheirUnit) {
  for (const auto& [option, unit] : {std::pair{"", "m"}, {" --unit mm", "mm"}}) {
    const std::string scan = std::string(unit) == "m" ? "scan.ply" : "scan_mm.ply";
    const test::Outcome outcome = run("recognize library.h5 " + scan + option);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const std::regex line(std::string(R"(  bracket .*rmse \S+ )") + unit + R"(  at \(.*\) )" +
                          unit + "\n");
    EXPECT_TRUE(std::regex_search(outcome.out, line)) << outcome.out;
  }
}

TEST_F(StandardOutput, SaysWhatToCheckWhereNothingIsFound) {
  const test::Outcome outcome = run("recognize library.h5 lever.ply --viewpoint 0,0,0");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find(" 0 found\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("check: In m, the scan is "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("the models are 207 mm to 207 mm across"), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("check: Is the viewpoint right?"), std::string::npos) << outcome.out;
  EXPECT_EQ(run("recognize library.h5 scan.ply").out.find("check:"), std::string::npos);
  const test::Outcome strict = run("recognize library.h5 scan.ply --min-score 1");
  EXPECT_NE(strict.out.find("check: The best rejected pose is bracket with score 0.9"),
            std::string::npos)
      << strict.out;
  const test::Outcome none = run("recognize library.h5 scan.ply --max-instances 0");
  EXPECT_EQ(none.out.find("best rejected"), std::string::npos) << none.out;
  folder_->write("few.xyz", "0 0 1\n0 1 1\n1 0 1\n");
  const test::Outcome few = run("recognize library.h5 few.xyz --viewpoint 0,0,0");
  EXPECT_NE(few.out.find("check: Is anything measured? A scan needs 50 points or more.\n"),
            std::string::npos)
      << few.out;
  EXPECT_EQ(few.out.find("viewpoint right"), std::string::npos) << few.out;
}

TEST_F(StandardOutput, IsFollowedByThePathOfTheReport) {
  for (const std::string command :
       {"recognize library.h5 scan.ply", "evaluate library.h5 set.json"}) {
    const test::Outcome outcome = run(command + " --report out");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_TRUE(outcome.error.ends_with("out/index.html\n")) << outcome.error;
    EXPECT_TRUE(run(command + " --report out --quiet").error.empty());
  }
}

TEST_F(StandardOutput, CountsOneThingAsOne) {
  EXPECT_NE(run("evaluate library.h5 set.json").out.find("1 scene "), std::string::npos);
  const test::Outcome trained = run("train bracket.ply -o one.h5 --preset fast --methods ppf");
  EXPECT_NE(trained.error.find("one.h5: 1 model (1 trained), "), std::string::npos)
      << trained.error;
}

TEST_F(StandardOutput, ReportsProgressToPrograms) {
  const test::Outcome outcome =
      run("recognize library.h5 scan.ply scan.ply --progress json --quiet");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  std::istringstream lines(outcome.error);
  std::size_t done = 0;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    EXPECT_EQ(json.at("stage"), "recognized");
    EXPECT_EQ(json.at("done"), ++done);
    EXPECT_EQ(json.at("total"), 2);
    EXPECT_EQ(json.at("item"), "scan.ply");
    EXPECT_GE(json.at("seconds"), 0);
  }
  EXPECT_EQ(done, 2U) << outcome.error;
  const test::Outcome trained =
      run("train bracket.ply -o told.h5 --preset fast --methods ppf --progress json --quiet");
  std::istringstream progress_lines(trained.error);
  std::vector<std::string> stages;
  for (std::string text; std::getline(progress_lines, text);) {
    if (!text.starts_with("warning: ")) stages.push_back(nlohmann::json::parse(text).at("stage"));
  }
  // All models of a new library are written when the last one has been trained.
  EXPECT_EQ(stages, (std::vector<std::string>{"read", "trained", "trained", "wrote"}))
      << trained.error;
  EXPECT_EQ(run("library list library.h5 --progress xml").exit_code, 2);
}

// There are no colors, with or without NO_COLOR.
TEST_F(StandardOutput, HasNoColors) {
  const std::string command = std::string(TRIVET_PROGRAM) + " recognize library.h5 scan.ply";
  const test::Outcome outcome = shell("script -qec '" + command + "' typescript < /dev/null");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("\r\033[Krecognized ["), std::string::npos) << "a terminal";
  EXPECT_FALSE(std::regex_search(outcome.out, std::regex("\033\\[[0-9;]*m"))) << outcome.out;
}

}  // namespace
}  // namespace trivet
