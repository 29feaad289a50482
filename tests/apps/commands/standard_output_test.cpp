/// What is written to standard output arrives there, or the command fails and says why.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/read_cloud.hpp"
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
           "library split library.h5 --parts 1 -o parts",
           "recognize library.h5 scan.ply",
           "recognize library.h5 scan.ply --json -",
           "evaluate library.h5 set.json",
           "evaluate library.h5 set.json --json -",
       }) {
    const test::Outcome outcome =
        shell(std::string(TRIVET_PROGRAM) + " " + arguments + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, 74) << arguments << ": " << outcome.error;
    EXPECT_NE(outcome.error.find("error: standard output: "), std::string::npos)
        << arguments << ": " << outcome.error;
    EXPECT_EQ(outcome.error.find("please report"), std::string::npos) << outcome.error;
  }
}

// There is nothing to tell it to.
TEST_F(StandardOutput, IsWrittenEvenWhereStandardErrorCannotBe) {
  const test::Outcome outcome =
      shell(std::string(TRIVET_PROGRAM) + " recognize library.h5 scan.ply 2> /dev/full");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.out.find("1 found"), std::string::npos) << outcome.out;
  EXPECT_EQ(shell(std::string(TRIVET_PROGRAM) + " recognize no.h5 scan.ply 2> /dev/full").exit_code,
            66);
}

}  // namespace
}  // namespace trivet
