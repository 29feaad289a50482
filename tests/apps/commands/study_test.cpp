/// Studies as run by a person: resumed, repeated, and with faults in the configuration.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>

#include "apps/program.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConfig = R"toml(
title = "Two parts <and> noise"
seed = 3
pictures = 1

[models.parts]
parts = 2

[models.others]
parts = 2
families = ["washer"]

[scenes.piles]
title = "Piles"
models = ["parts"]
others = ["others"]
set = { scan.scenes = 2, scan.instances = 2, scan.sensor = "laser" }

[[experiments]]
name = "noise"
title = "Noise"
scenes = ["piles"]
methods = ["ppf", "trisi"]
vary = "degrade.noise"
values = [0, 10]
set = { degrade.scattered = true }

[[experiments]]
name = "rotation"
scenes = ["piles"]
methods = ["ppf"]
vary = "recognize.cluster-rotation"
values = [8, 15]

[[experiments]]
name = "steps"
scenes = ["piles"]
methods = ["ppf"]
threshold = "best-f1"
against = "previous"
[[experiments.variants]]
name = "without rays"
set = { recognize.ablate = ["rays", "correlated-noise", "second-round", "alternatives"], recognize.min-score = 0 }
[[experiments.variants]]
name = "all"

[[experiments]]
name = "library"
scenes = ["piles"]
methods = ["ppf"]
vary = "train.others"
values = [0, 2]

[[experiments]]
name = "occlusion"
scenes = ["piles"]
methods = ["ppf", "trisi"]
curve = "occlusion"
)toml";

class Study : public testing::Test {
 protected:
  test::Outcome run(const std::vector<std::string>& arguments,
                    const std::function<void(pid_t, const std::string&)>& watch = {}) const {
    return test::run_trivet(arguments,
                            {.folder = folder_.path(), .environment = {}, .watch = watch});
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  /// Runs study.toml with kConfig to run_a, once for all tests.
  void copy_complete_run() const {
    static const test::TempDir folder;
    static const test::Outcome complete = [] {
      std::ofstream(folder / "study.toml") << kConfig;
      return test::run_trivet({"study", "study.toml", "-o", "run_a"},
                              {.folder = folder.path(), .environment = {}, .watch = {}});
    }();
    ASSERT_EQ(complete.exit_code, 0) << complete.error;
    fs::copy(folder.path(), folder_.path(), fs::copy_options::recursive);
  }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// The rows of results.csv without their last field, a time.
  std::string results(const std::string& name) const {
    return std::regex_replace(read(name + "/results.csv"), std::regex(",[^,\n]*\n"), "\n");
  }
  /// The page without times and memory, and without drawings of times.
  std::string page(const std::string& name) const {
    std::string text = read(name + "/index.html");
    text = std::regex_replace(text, std::regex(R"([0-9.]+ s\b)"), "TIME");
    text = std::regex_replace(text, std::regex(R"([0-9]+ MB\b)"), "MEMORY");
    // The second chart in a panel shows times.
    std::string out;
    for (std::size_t at = 0;;) {
      const std::size_t chart = text.find("aria-label=\"time of a scene on one core", at);
      out += text.substr(at, chart == std::string::npos ? chart : chart - at);
      if (chart == std::string::npos) return std::regex_replace(out, std::regex(name), "OUT");
      at = text.find("</svg>", chart);
    }
  }
  /// Field `column` of the row that starts with these fields.
  static std::string field(const std::string& csv, const std::string& start, std::size_t column) {
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with(start)) continue;
      std::istringstream fields(line);
      std::string value;
      for (std::size_t i = 0; i <= column; ++i) std::getline(fields, value, ',');
      return value;
    }
    ADD_FAILURE() << "no row " << start;
    return "";
  }
  const test::TempDir folder_;
};

TEST_F(Study, EndsWithTheSameReportWhenItIsKilledOrRunOnOtherThreads) {
  ASSERT_NO_FATAL_FAILURE(copy_complete_run());

  // Counts complete cells: a kill may leave a partial one beside them.
  const auto cells = [&] {
    std::map<fs::path, fs::file_time_type> times;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_ / "run_b/cells", error)) {
      if (entry.path().extension() == ".json") times[entry.path()] = entry.last_write_time();
    }
    return times;
  };
  // Kills the run twice, each time after some cells exist.
  for (const std::size_t enough : {4U, 9U}) {
    const test::Outcome killed = run({"study", "study.toml", "-o", "run_b", "--threads", "1"},
                                     [&](pid_t process, const std::string&) {
                                       if (cells().size() >= enough) kill(process, SIGKILL);
                                     });
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL) << killed.error;
    EXPECT_FALSE(fs::exists(folder_ / "run_b/index.html"));
  }
  const std::map<fs::path, fs::file_time_type> kept = cells();
  ASSERT_GE(kept.size(), 9U);
  const test::Outcome resumed = run({"study", "study.toml", "-o", "run_b", "--threads", "1"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  for (const auto& [file, time] : kept)
    EXPECT_EQ(fs::last_write_time(file), time) << file << " was computed twice";
  EXPECT_EQ(results("run_b"), results("run_a"));
  const std::string other = std::regex_replace(page("run_b"), std::regex(" --threads 1"), "");
  EXPECT_EQ(other, page("run_a"));
}

TEST_F(Study, ComputesNothingTwice) {
  ASSERT_NO_FATAL_FAILURE(copy_complete_run());
  const std::string first = read("run_a/index.html");
  // Of 8 points on 2 scenes, four contain the default of ppf; that of trisi is not among the noise
  // points.
  std::size_t num_cells = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "run_a/cells"))
    num_cells += entry.path().extension() == ".json" ? 1 : 0;
  // noise: 2 x 2; rotation: 2, of which 15 is the default; without rays; 2 others; trisi: 1.
  EXPECT_EQ(num_cells, 2U * (4 + 2 + 1 + 1 + 1));
  const test::Outcome again = run({"study", "study.toml", "-o", "run_a"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.error.find("recognized"), std::string::npos) << again.error;
  EXPECT_EQ(again.error.find("trained"), std::string::npos) << again.error;
  EXPECT_EQ(std::regex_replace(read("run_a/index.html"), std::regex("<pre>[^<]*</pre>"), ""),
            std::regex_replace(first, std::regex("<pre>[^<]*</pre>"), ""));
}

TEST_F(Study, SaysWhatTheCellsSayOnAPageThatNeedsNothingElse) {
  ASSERT_NO_FATAL_FAILURE(copy_complete_run());
  const std::string csv = read("run_a/results.csv");
  const auto number = [&](const std::string& row, std::size_t column) {
    return std::stod(field(csv, row, column));
  };
  constexpr std::size_t kFound = 6, kInstances = 7, kShare = 8, kLow = 9, kHigh = 10, kChange = 17;
  const std::string axis = "Gaussian noise [resolution of the scan]",
                    clean = "noise,Piles,ppf," + axis + ",0,",
                    noisy = "noise,Piles,ppf," + axis + ",10,";
  EXPECT_GT(number(clean, kInstances), 3);
  EXPECT_GT(number(clean, kFound), number(noisy, kFound));
  EXPECT_NEAR(number(clean, kShare), number(clean, kFound) / number(clean, kInstances), 1e-6);
  EXPECT_LT(number(clean, kLow), number(clean, kShare));
  EXPECT_LE(number(clean, kShare), number(clean, kHigh));
  EXPECT_NEAR(number(noisy, kChange), number(noisy, kShare) - number(clean, kShare), 1e-6);
  // A cell has the same result in every experiment.
  const std::string usual = "rotation,Piles,ppf,rotation threshold of clustering [°],15,";
  const std::string all = "occlusion,Piles,ppf,occlusion,all,";
  EXPECT_EQ(number(usual, kFound), number(all, kFound));
  EXPECT_EQ(number(usual, kInstances), number(all, kInstances));

  const std::string libraries = read("run_a/libraries.csv");
  constexpr std::size_t kBytes = 1, kOpen = 2, kPeak = 3;
  const auto of_library = [&](const std::string& row, std::size_t column) {
    return std::stod(field(libraries, row, column));
  };
  EXPECT_GT(of_library("4,", kBytes), 1.2 * of_library("2,", kBytes));
  for (const std::string row : {"2,", "4,"}) {
    EXPECT_GT(of_library(row, kOpen), 0);
    EXPECT_GT(of_library(row, kPeak), 1e6);
  }

  const std::string page = read("run_a/index.html");
  for (const char* const outside : {"src=\"http", "href=\"http", "<script", "@import", "url("})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  EXPECT_EQ(page.find("<and>"), std::string::npos) << "the title goes in as text";
  EXPECT_NE(page.find("Two parts &lt;and&gt; noise"), std::string::npos);
  EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
  // One sentence for each experiment, with the table's numbers.
  const auto share = [&](const std::string& row) {
    return fmt::format("{:.1f} %", 100 * number(row, kShare));
  };
  const std::string trisi = "noise,Piles,trisi," + axis;
  EXPECT_NE(page.find("<li><a href=\"#noise\">Noise</a>: ppf finds " + share(clean) + " at 0 and " +
                      share(noisy) + " at 10, trisi " + share(trisi + ",0,") + " at 0 and " +
                      share(trisi + ",10,") + " at 10.\n"),
            std::string::npos);
  EXPECT_NE(page.find("ppf finds " + share(usual) + " at the default, 15; "), std::string::npos);
  EXPECT_NE(page.find("from without rays to all, F1 goes from "), std::string::npos);
  // Tags are balanced.
  for (const char* const tag : {"div", "section", "table", "svg", "figure", "ul", "g"}) {
    const std::string open = std::string("<") + tag, close = std::string("</") + tag + ">";
    const auto count = [&](const std::regex& pattern) {
      return std::distance(std::sregex_iterator(page.begin(), page.end(), pattern), {});
    };
    EXPECT_EQ(count(std::regex(open + "[ >]")), count(std::regex(close))) << tag;
  }
}

TEST_F(Study, NamesEveryFaultOfAConfiguration) {
  write("bad.toml", R"toml(
titel = "x"
[models.parts]
parts = 2
families = ["spoon"]
[scenes.piles]
models = ["partz"]
set = { scan.sensor = "sonar", scan.nose = 1 }
[[experiments]]
name = "a"
scenes = ["piles"]
methods = ["icp"]
vary = "train.relative-step"
values = [0.04, "fine"]
)toml");
  const test::Outcome outcome = run({"study", "bad.toml", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 65);
  for (const char* const text :
       {"bad.toml:2: ", "titel", "spoon", "hex_nut", "partz", "sonar", "structured-light",
        "scan.nose", "scan.noise", "icp", "bad.toml:14: ", "fine"}) {
    EXPECT_NE(outcome.error.find(text), std::string::npos) << text << " in\n" << outcome.error;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Study, RefusesWhatItCannotRun) {
  const auto fails = [&](const std::string& text, int exit_code, const std::string& reason) {
    write("bad.toml", text);
    const test::Outcome outcome = run({"study", "bad.toml", "-o", "out"});
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.error;
    EXPECT_NE(outcome.error.find(reason), std::string::npos) << outcome.error;
  };
  const std::string base = "[models.parts]\nparts = 2\n[scenes.piles]\nmodels = [\"parts\"]\n";
  fails("title = ", 65, "bad.toml:1");
  fails(base, 65, "[[experiments]]");
  fails(base +
            "[[experiments]]\nname = \"a\"\nscenes = [\"piles\"]\nvary = \"scan.instances\"\n"
            "values = [500]\n",
        65, "1 to 200");
  fails(base + "[[experiments]]\nname = \"a\"\nscenes = [\"piles\"]\nset = { recognize = 3 }\n", 65,
        "recognize");
  fails(
      "[models.files]\nfiles = [\"absent.ply\"]\n[scenes.piles]\nmodels = [\"files\"]\n"
      "[[experiments]]\nname = \"a\"\nscenes = [\"piles\"]\n",
      66, "absent.ply");
  fails(
      "[scenes.real]\nmanifest = \"absent.json\"\n[[experiments]]\nname = \"a\"\n"
      "scenes = [\"real\"]\n",
      66, "absent.json");
  const std::string real =
      "[scenes.real]\nmanifest = \"m.json\"\n[[experiments]]\nname = \"a\"\n"
      "scenes = [\"real\"]\n";
  fails(real + "vary = \"scan.sensor\"\nvalues = [\"laser\"]\n", 65, "nothing of scan.");
  fails(real + "repetitions = 2\n", 65, "one repetition");
  fails(real + "[[experiments]]\nname = \"a\"\nscenes = [\"real\"]\n", 65, "a second experiment");
  const test::Outcome absent = run({"study", "absent.toml", "-o", "out"});
  EXPECT_EQ(absent.exit_code, 66);
}

TEST_F(Study, JudgesScenesOfAManifest) {
  const test::Outcome scanned = run({"scan", "--parts", "2", "-o", "scans", "--scenes", "2",
                                     "--instances", "2", "--sensor", "laser"});
  ASSERT_EQ(scanned.exit_code, 0) << scanned.error;
  write("study.toml",
        "[scenes.real]\ntitle = \"Real\"\nmanifest = \"scans/manifest.json\"\n[[experiments]]\n"
        "name = \"a\"\nscenes = [\"real\"]\nmethods = [\"ppf\"]\n");
  const test::Outcome outcome = run({"study", "study.toml", "-o", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::string csv = read("out/results.csv");
  ASSERT_EQ(run({"train", "scans/manifest.json", "--methods", "ppf", "-o", "l.h5"}).exit_code, 0);
  const test::Outcome judged =
      run({"evaluate", "l.h5", "scans/manifest.json", "--method", "ppf", "--csv", "scores"});
  ASSERT_EQ(judged.exit_code, 0) << judged.error;
  const std::string summary = read("scores/summary.csv");
  EXPECT_NE(summary.find(field(csv, "a,,ppf,scenes,Real,", 6)), std::string::npos) << summary;
}

}  // namespace
}  // namespace trivet
