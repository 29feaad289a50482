/// The output for a person or script when an error occurs or help is requested.
#include <gtest/gtest.h>

#include "apps/program.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class CommandLine : public testing::Test {
 protected:
  test::Outcome run(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  /// Whether it exits with this code, writes `text` to standard error and nothing to standard
  /// output.
  testing::AssertionResult fails(const std::vector<std::string>& arguments, int code,
                                 const std::string& text) const {
    const test::Outcome outcome = run(arguments);
    if (outcome.exit_code == code && outcome.error.find(text) != std::string::npos &&
        outcome.out.empty()) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure()
           << "expected code " << code << " and '" << text << "', found " << outcome.exit_code
           << ", error '" << outcome.error << "', output '" << outcome.out << "'";
  }
  const test::TempDir folder_;
};

TEST_F(CommandLine, ExplainsEverySubcommand) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{},
                                                  {"train"},
                                                  {"recognize"},
                                                  {"evaluate"},
                                                  {"scan"},
                                                  {"mesh"},
                                                  {"library"},
                                                  {"library", "list"},
                                                  {"library", "info"}}) {
    std::vector<std::string> arguments = command;
    arguments.emplace_back("--help");
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_NE(outcome.out.find("Usage:"), std::string::npos) << outcome.out;
    if (!command.empty()) {
      EXPECT_NE(outcome.out.find(command.back()), std::string::npos) << outcome.out;
    }
    EXPECT_TRUE(outcome.error.empty()) << outcome.error;
  }
  EXPECT_EQ(run({"--version"}).out.rfind("trivet ", 0), 0U);
}

TEST_F(CommandLine, IsDescribedByThePageOfTheDocuments) {
  const test::Outcome outcome = run({"--help-markdown"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(outcome.out == test::read_bytes(TRIVET_SOURCES "/docs/cli.md"))
      << "update it: trivet --help-markdown > docs/cli.md";
}

TEST_F(CommandLine, NamesOptionsInTheOrderInWhichOneNeedsThem) {
  const std::string help = run({"recognize", "--help"}).out;
  std::size_t at = 0;
  for (const char* text : {"\nOptions:", "--unit", "--camera", "--viewpoint", "--json", "--report",
                           "\nWhat is searched:", "\nAnswers:", "--min-score",
                           "\nFor research: voting, first round:"}) {
    const std::size_t found = help.find(text);
    ASSERT_NE(found, std::string::npos) << text;
    EXPECT_GT(found, at) << text;
    at = found;
  }
  // A heading occupies a whole line.
  for (std::size_t i = help.find(":\n", at); i != std::string::npos; i = help.find(":\n", i + 1)) {
    const std::size_t line = help.rfind('\n', i) + 1;
    if (help[line] != ' ') {
      EXPECT_EQ(help.compare(line, 13, "For research:"), 0) << help.substr(line, 40);
    }
  }
}

TEST_F(CommandLine, GivesTwoForWrongUsage) {
  EXPECT_TRUE(fails({}, 2, "subcommand"));
  EXPECT_TRUE(fails({"trane"}, 2, "subcommand"));
  EXPECT_TRUE(fails({"train"}, 2, "MODEL"));
  EXPECT_TRUE(fails({"train", "a.ply"}, 2, "--output"));
  EXPECT_TRUE(fails({"train", "a.ply", "-o", "l.h5", "--unit", "inch"}, 2, "inch"));
  EXPECT_TRUE(fails({"train", "a.ply", "-o", "l.h5", "--threads", "-1"}, 2, "--threads"));
  EXPECT_TRUE(fails({"train", "a.ply", "b/a.ply", "-o", "l.h5"}, 2, "'a'"));
  EXPECT_TRUE(fails({"recognize", "l.h5"}, 2, "SCENE"));
  EXPECT_TRUE(fails({"recognize", "l.h5", "s.ply", "--preset", "best"}, 2, "best"));
  EXPECT_TRUE(fails({"recognize", "l.h5", "s.ply", "--rounds", "0"}, 2, "--expected"));
  EXPECT_TRUE(fails({"recognize", "l.h5", "s.ply", "--ablate", "ball,luck"}, 2, "luck"));
  EXPECT_TRUE(fails({"evaluate", "l.h5", "s.json", "--ablate", "luck"}, 2, "second-round"))
      << "names what there is";
  EXPECT_TRUE(fails({"library", "list"}, 2, "LIBRARY"));
}

TEST_F(CommandLine, GivesTwoForAnOptionOutOfItsRange) {
  folder_.write("a.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  EXPECT_TRUE(fails({"train", "a.xyz", "-o", "l.h5", "--relative-step", "7"}, 2, "7"));
  EXPECT_TRUE(fails({"train", "a.xyz", "-o", "l.h5", "--relative-step", "nan"}, 2, "nan"));
}

TEST_F(CommandLine, GivesSixtySixForAMissingInputAndNamesIt) {
  folder_.write("a.xyz", "0 0 0\n");
  EXPECT_TRUE(fails({"train", "nowhere.ply", "-o", "l.h5"}, 66, "nowhere.ply"));
  EXPECT_TRUE(fails({"train", "nowhere.json", "-o", "l.h5"}, 66, "nowhere.json"));
  EXPECT_TRUE(fails({"recognize", "nowhere.h5", "a.xyz"}, 66, "nowhere.h5"));
  EXPECT_TRUE(fails({"library", "info", "nowhere.h5"}, 66, "nowhere.h5"));
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_TRUE(fails({"train", "empty", "-o", "l.h5"}, 66, "empty"));
}

TEST_F(CommandLine, CallsModelsByTheirFilesWhateverTheseAreCalled) {
  const std::string box =
      "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  folder_.write("my part (1).off", box);
  folder_.write("my part [1].off", box);
  const test::Outcome outcome = run({"train", "my part (1).off", "-o", "l.h5", "--preset", "fast"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("my part (1).off: the model is called my_part_1; NAME=FILE gives it "
                               "another name"),
            std::string::npos)
      << outcome.error;
  EXPECT_EQ(run({"library", "list", "l.h5"}).out, "my_part_1\n");
  EXPECT_TRUE(
      fails({"train", "my part (1).off", "my part [1].off", "-o", "l.h5"}, 2,
            "my part [1].off: expected each model's name once, found 'my_part_1' again, the "
            "name of my part (1).off; name it as NAME=FILE"));
  EXPECT_TRUE(fails({"train", "my part=my part (1).off", "-o", "l.h5"}, 2,
                    "expected a name of letters and digits of any script"));
}

TEST_F(CommandLine, ReportsEveryModelThatCannotBeTrained) {
  const std::string box =
      "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  std::filesystem::create_directory(folder_ / "models");
  for (const char name : std::string("abcdefghijklmnopqrstuvwxyz"))
    folder_.write(std::string("models/") + name + ".off", box);
  folder_.write("models/b.off", "");
  folder_.write("models/p.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 one 0\n3 0 1 2\n");
  folder_.write("models/z.off", "OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n");
  // With features, all models are sampled first for the basis; with the method ppf, each is trained
  // in turn.
  for (const std::string methods : {"ppf", "ppf,trisi"}) {
    const test::Outcome outcome =
        run({"train", "models", "-o", "l.h5", "--preset", "fast", "--methods", methods});
    EXPECT_EQ(outcome.exit_code, 65);
    const std::size_t all = outcome.error.find("3 of 26 models cannot be trained; nothing was");
    const std::size_t b = outcome.error.find("b.off: the file is empty");
    const std::size_t p = outcome.error.find("p.off, line 5: expected three numbers");
    const std::size_t z = outcome.error.find("z.off: expected points that span 1e-06 or more");
    EXPECT_TRUE(all < b && b < p && p < z && z != std::string::npos) << outcome.error;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "l.h5"));
  folder_.write("models/p.off", box);
  folder_.write("models/z.off", box);
  EXPECT_TRUE(fails({"train", "models", "-o", "l.h5", "--preset", "fast"}, 65,
                    "error: models/b.off: the file is empty"))
      << "a single one is reported unchanged";
}

TEST_F(CommandLine, SaysWhatToGiveInsteadOfAFolderOrAnImage) {
  std::filesystem::create_directory(folder_ / "scans");
  folder_.write("scans/manifest.json", "{\"unit\": \"m\"}");
  folder_.write("scans/camera.json", "{\"fx\": 500, \"fy\": 500, \"cx\": 1, \"cy\": 1}");
  EXPECT_TRUE(fails({"train", "scans", "-o", "l.h5"}, 66,
                    "found the manifest manifest.json; give that file"));
  folder_.write("box.off",
                "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  ASSERT_EQ(run({"train", "box.off", "-o", "box.h5", "--preset", "fast"}).exit_code, 0);
  EXPECT_TRUE(
      fails({"recognize", "box.h5", "scans"}, 66, "found the manifest manifest.json; give"));
  std::filesystem::create_directory(folder_ / "depth");
  folder_.write("depth/1.png", "");
  folder_.write("depth/2.png", "");
  EXPECT_TRUE(fails({"train", "depth", "-o", "l.h5"}, 66, "found 2 images; as scenes, depth"));
  EXPECT_TRUE(fails({"train", "depth/1.png", "-o", "l.h5"}, 65,
                    "depth/1.png: expected a mesh or a cloud of the whole object, found an image"));
}

TEST_F(CommandLine, GivesSixtyFiveForBadDataAndNamesIt) {
  folder_.write("broken.ply", "ply\nformat ascii 1.0\nelement vertex ninety\n");
  folder_.write("point.xyz", "1 2 3\n");
  folder_.write("broken.json", "{\"unit\": \"m\"");
  folder_.write("broken.h5", "not a library");
  EXPECT_TRUE(fails({"train", "broken.ply", "-o", "l.h5"}, 65, "broken.ply"));
  EXPECT_TRUE(fails({"train", "point.xyz", "-o", "l.h5"}, 65, "point"));
  EXPECT_TRUE(fails({"train", "broken.json", "-o", "l.h5"}, 65, "broken.json"));
  EXPECT_TRUE(fails({"recognize", "broken.h5", "point.xyz"}, 65, "broken.h5"));
  EXPECT_TRUE(fails({"library", "list", "broken.h5"}, 65, "broken.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "l.h5"));
}

}  // namespace
}  // namespace trivet
