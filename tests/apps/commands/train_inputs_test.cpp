/// Names on the command line: folders, model names and units.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

const std::string kFirst = "\xE9\x9B\xB6\xE4\xBB\xB6\xE4\xB8\x80";   // "part one" in Chinese
const std::string kSecond = "\xE9\x9B\xB6\xE4\xBB\xB6\xE4\xBA\x8C";  // "part two"

class TrainInputs : public testing::Test {
 protected:
  TrainInputs() {
    put("a", test::bracket());
    put("b", test::lever());
  }
  void put(const std::string& name, const test::Shape& shape) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    EXPECT_TRUE(write_ply(folder_ / (name + ".ply"), test::cloud_of(shape)));
  }
  test::Outcome run(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  /// Trains coarsely, for speed. Returns its standard error.
  std::string train(std::vector<std::string> arguments, int exit_code = 0) const {
    arguments.insert(arguments.begin(),
                     {"train", "-o", "l.h5", "--preset", "fast", "--methods", "ppf"});
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.error;
    return outcome.error;
  }
  std::string unit() const {
    return nlohmann::json::parse(run({"library", "info", "l.h5", "--json", "-"}).out).at("unit");
  }
  std::string list() const { return run({"library", "list", "l.h5"}).out; }

  test::TempDir folder_;
};

void expect_says(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST_F(TrainInputs, ReportFilesOfAFolderThatAreLeftOut) {
  put("parts/Halter", test::bracket());
  put("parts/Mutter", test::lever());
  put("parts/sub/Winkel", test::bracket());
  folder_.write("parts/clip.3mf", "PK");
  folder_.write("parts/hook.igs", "S");
  folder_.write("parts/notes.txt", "notes");
  folder_.write("parts/._Halter.ply", std::string("\0\x05\x16\x07", 4) + std::string(4092, '\0'));
  const std::string output = train({"parts", "--quiet", "--json", "t.json"});
  expect_says(output, "parts: left out, as nothing that can be read: clip.3mf, hook.igs");
  expect_says(output, "folders in it are not searched: sub");
  EXPECT_EQ(output.find("notes.txt"), std::string::npos) << output;
  EXPECT_EQ(list(), "Halter\nMutter\n");
  const auto json = nlohmann::json::parse(test::read_bytes(folder_ / "t.json"));
  EXPECT_EQ(json.at("left_out"),
            (nlohmann::json{"parts/clip.3mf", "parts/hook.igs", "parts/sub/"}));
}

TEST_F(TrainInputs, KeepNamesOfAnyScript) {
  std::filesystem::rename(folder_ / "a.ply", folder_ / (kFirst + ".ply"));
  std::filesystem::rename(folder_ / "b.ply", folder_ / (kSecond + ".ply"));
  train({kFirst + ".ply"});
  const test::Outcome added = run({"library", "add", "l.h5", kSecond + ".ply"});
  EXPECT_EQ(added.exit_code, 0) << added.error;
  EXPECT_EQ(list(), kFirst + "\n" + kSecond + "\n");
  EXPECT_EQ(run({"library", "verify", "l.h5"}).exit_code, 0);
  const auto info = nlohmann::json::parse(run({"library", "info", "l.h5", "--json", "-"}).out);
  EXPECT_NE(info.dump().find(kFirst), std::string::npos);
  EXPECT_EQ(run({"library", "export", "l.h5", "-o", "out"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / (kSecond + ".ply")));
}

TEST_F(TrainInputs, NeverReplaceAModelSilently) {
  std::filesystem::rename(folder_ / "a.ply", folder_ / "bolt (1).ply");
  std::filesystem::rename(folder_ / "b.ply", folder_ / "bolt [1].ply");
  train({"bolt (1).ply"});
  const test::Outcome added = run({"library", "add", "l.h5", "bolt [1].ply"});
  EXPECT_EQ(added.exit_code, 2);
  expect_says(added.error, "'bolt_1' is the model of another file, bolt (1).ply");
  expect_says(train({"bolt [1].ply"}, 2), "bolt_1=bolt [1].ply");
  train({"second=bolt [1].ply"});
  EXPECT_EQ(list(), "bolt_1\nsecond\n");
}

TEST_F(TrainInputs, KeepTheUnitOfTheLibrary) {
  train({"a.ply", "--unit", "mm"});
  expect_says(train({"a.ply", "b.ply"}), "2 models");
  EXPECT_EQ(unit(), "mm");
  expect_says(train({"a.ply", "b.ply", "--unit", "m"}, 2),
              "l.h5: expected models in 'mm', which is the unit of the library, found 'm'");
  EXPECT_EQ(unit(), "mm");
  train({"a.ply", "b.ply", "--unit", "m", "--prune"});
  EXPECT_EQ(unit(), "m");
}

/// A library of one part, and scenes with it, some of which cannot be read.
class FailedScenes : public TrainInputs {
 protected:
  FailedScenes() {
    const test::Shape bracket = test::bracket();
    EXPECT_TRUE(write_ply(folder_ / "good.ply",
                          test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F},
                                                                      {-0.02F, 0.03F, 0.85F})}})));
    folder_.write("damaged.ply", "ply\nformat ascii 1.0\nelement vertex 9\n");
    train({"a.ply"});
  }
};

TEST_F(FailedScenes, LoseNoOthers) {
  const test::Outcome outcome = run({"recognize", "l.h5", "damaged.ply", "good.ply", "absent.ply",
                                     "--json", "r.json", "--report", "report"});
  EXPECT_EQ(outcome.exit_code, 65) << outcome.error;
  expect_says(outcome.error, "2 of 3 scenes failed");
  expect_says(outcome.error, "absent.ply");
  const auto scenes = nlohmann::json::parse(test::read_bytes(folder_ / "r.json")).at("scenes");
  ASSERT_EQ(scenes.size(), 3U);
  expect_says(scenes[0].at("error"), "damaged.ply");
  EXPECT_FALSE(scenes[0].contains("detections")) << "nothing was looked for";
  ASSERT_EQ(scenes[1].at("detections").size(), 1U);
  EXPECT_EQ(scenes[1]["scene"], "good.ply");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report/index.html"));

  const test::Outcome text = run({"recognize", "l.h5", "damaged.ply", "good.ply"});
  EXPECT_EQ(text.exit_code, 65);
  expect_says(text.out, "1 found");
  const test::Outcome alone = run({"recognize", "l.h5", "absent.ply", "--json", "r.json"});
  EXPECT_EQ(alone.exit_code, 66);
  EXPECT_EQ(alone.error.find("scenes failed"), std::string::npos) << alone.error;
}

TEST_F(FailedScenes, AreMissingInAnEvaluation) {
  const std::string truth =
      R"([{"model": "a", "T_scene_model": [[1,0,0,0],[0,1,0,0],[0,0,1,0.8],[0,0,0,1]]}])";
  folder_.write("m.json", R"({"unit": "m", "models": {"a": {"file": "a.ply"}}, "scenes": [
      {"file": "damaged.ply", "viewpoint": [0, 0, 0], "truth": )" +
                              truth + R"(},
      {"file": "good.ply", "viewpoint": [0, 0, 0], "truth": )" +
                              truth + "}]}");
  const test::Outcome outcome = run({"evaluate", "l.h5", "m.json", "--json", "e.json"});
  EXPECT_EQ(outcome.exit_code, 65) << outcome.error;
  expect_says(outcome.error, "damaged.ply");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "e.json"));
  run({"recognize", "l.h5", "m.json", "--json", "r.json"});
  const test::Outcome stored = run({"evaluate", "m.json", "--detections", "r.json"});
  EXPECT_EQ(stored.exit_code, 0) << stored.error;
}

}  // namespace
}  // namespace trivet
