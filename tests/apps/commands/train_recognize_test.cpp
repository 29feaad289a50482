/// `trivet train` and `trivet recognize` as used by a script: the contents of their files, which do
/// not depend on the environment.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "storage/formats/write_png.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// A folder with two models, a scan of one of them and a library of both.
class TrainRecognize : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    bracket_ = test::bracket();
    write("bracket.ply", test::cloud_of(bracket_));
    write("lever.ply", test::cloud_of(test::lever()));
    write("scan.ply", test::render_scan({{&bracket_, truth()}}));
    const test::Outcome outcome =
        run({"train", "bracket.ply", "lever.ply", "-o", "library.h5", "--preset", "fast"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static void write(const std::string& name, const Cloud& cloud) {
    const Result<void> written = write_ply(*folder_ / name, cloud);
    ASSERT_TRUE(written) << written.error().message;
  }
  static test::Outcome run(const std::vector<std::string>& arguments,
                           const std::vector<std::string>& environment = {}) {
    return test::run_trivet(arguments,
                            {.folder = folder_->path(), .environment = environment, .watch = {}});
  }
  static Pose truth() { return test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F}); }
  static std::string bytes(const std::string& name) { return test::read_bytes(*folder_ / name); }

  /// The result of recognition without its times, which differ between runs.
  static nlohmann::json detections(const std::string& text) {
    nlohmann::json document = nlohmann::json::parse(text);
    for (nlohmann::json& scene : document["scenes"]) scene.erase("seconds");
    return document;
  }
  static nlohmann::json recognized(const std::vector<std::string>& more = {},
                                   const std::vector<std::string>& environment = {}) {
    std::vector<std::string> arguments{"recognize", "library.h5", "scan.ply", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = run(arguments, environment);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return detections(outcome.out);
  }

  static inline test::Shape bracket_;
  static inline std::unique_ptr<test::TempDir> folder_;
};

TEST_F(TrainRecognize, SaysWhichMethodFoundADetection) {
  const test::Outcome outcome =
      run({"recognize", "library.h5", "scan.ply", "--method", "trisi", "--json", "trisi.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json scene = nlohmann::json::parse(bytes("trisi.json")).at("scenes").at(0);
  ASSERT_EQ(scene.at("detections").size(), 1U);
  EXPECT_EQ(scene["detections"][0].at("method"), "trisi");
  EXPECT_GE(scene.at("seconds").at("match"), 0);
  EXPECT_EQ(scene.at("counts").at("votes"), 0);
}

TEST_F(TrainRecognize, TrainsForTheMethodsThatAreAskedFor) {
  for (const std::string method : {"ppf", "trisi"}) {
    const bool images = method == "trisi";
    const test::Outcome trained =
        run({"train", "bracket.ply", "-o", method + ".h5", "--methods", method});
    ASSERT_EQ(trained.exit_code, 0) << trained.error;
    EXPECT_EQ(trained.error.find(" 0 point pairs") != std::string::npos, images) << trained.error;
    EXPECT_EQ(trained.error.find(" 0 features") != std::string::npos, !images) << trained.error;
    const test::Outcome info = run({"library", "info", method + ".h5"});
    EXPECT_EQ(info.out.find("features    none") != std::string::npos, !images) << info.out;
    EXPECT_EQ(info.out.find("60 components with") != std::string::npos, images) << info.out;

    const test::Outcome fused = run({"recognize", method + ".h5", "scan.ply", "--json", "-"});
    ASSERT_EQ(fused.exit_code, 0) << fused.error;
    const nlohmann::json scene = nlohmann::json::parse(fused.out).at("scenes").at(0);
    ASSERT_EQ(scene.at("detections").size(), 1U);
    EXPECT_EQ(scene["detections"][0].at("method"), method);
    const std::string other = images ? "ppf" : "trisi";
    const test::Outcome refused = run({"recognize", method + ".h5", "scan.ply", "--method", other});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.error.find("--methods " + other), std::string::npos) << refused.error;
  }
  EXPECT_EQ(run({"train", "bracket.ply", "-o", "no.h5", "--methods", "magic"}).exit_code, 2);
  EXPECT_EQ(run({"train", "bracket.ply", "-o", "no.h5", "--components", "0"}).exit_code, 2);
}

TEST_F(TrainRecognize, FindsTheModelWhereItIs) {
  const test::Outcome outcome =
      run({"recognize", "library.h5", "scan.ply", "--json", "found.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  const nlohmann::json document = nlohmann::json::parse(bytes("found.json"));
  EXPECT_EQ(document.at("library"), "library.h5");
  ASSERT_EQ(document.at("scenes").size(), 1U);
  const nlohmann::json& scene = document["scenes"][0];
  EXPECT_EQ(scene.at("scene"), "scan.ply");
  EXPECT_GT(scene.at("points"), 1000);
  for (const char* stage : {"read", "prepare", "total"})
    EXPECT_GE(scene.at("seconds").at(stage), 0) << stage;
  ASSERT_EQ(scene.at("detections").size(), 1U);

  const nlohmann::json& found = scene["detections"][0];
  EXPECT_EQ(found.at("model"), "bracket");
  EXPECT_EQ(found.at("method"), "ppf");
  for (const char* share : {"score", "visible_fraction", "violation"}) {
    EXPECT_GE(found.at(share), 0) << share;
    EXPECT_LE(found.at(share), 1) << share;
  }
  EXPECT_GE(found.at("rmse"), 0);
  const Eigen::Matrix4f expected = truth().matrix();
  ASSERT_EQ(found.at("T_scene_model").size(), 4U);
  for (int row = 0; row < 4; ++row) {
    ASSERT_EQ(found["T_scene_model"][row].size(), 4U);
    for (int column = 0; column < 4; ++column) {
      // The tolerance is a hundredth of the part's 0.2 m, or of a radian.
      const float tolerance = column == 3 ? 0.002F : 0.02F;
      EXPECT_NEAR(found["T_scene_model"][row][column], expected(row, column), tolerance)
          << row << ", " << column;
    }
  }
}

// Of poses that score alike on a scan without noise, the one that fits is reported, whichever points
// vote.
TEST_F(TrainRecognize, ReportsTheExactPoseOfAScanWithoutNoise) {
  const Pose expected = truth();
  for (const char* share : {"0.09", "0.095", "0.1", "0.11"}) {
    const test::Outcome outcome = run({"recognize", "library.h5", "scan.ply", "--reference-share",
                                       share, "--json", "exact.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const nlohmann::json scene = nlohmann::json::parse(bytes("exact.json"))["scenes"][0];
    ASSERT_EQ(scene.at("detections").size(), 1U);
    const nlohmann::json& T = scene["detections"][0]["T_scene_model"];
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column)
        EXPECT_NEAR(T[row][column], expected.matrix()(row, column), 1e-3F) << share;
    }
  }
}

// Lengths are in the file's unit, except for `noise` of the scene, which is in the library's.
TEST_F(TrainRecognize, ReportsTheErrorsOfTheScan) {
  constexpr float kNoise = 5e-4F;
  Cloud scan = test::render_scan({{&bracket_, truth()}});
  test::Random random;
  const auto recognize = [&](const std::string& unit) {
    write("noisy.ply", scan);
    const test::Outcome outcome =
        run({"recognize", "library.h5", "noisy.ply", "--unit", unit, "--json", "-"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return nlohmann::json::parse(outcome.out)["scenes"][0];
  };
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f p = scan.points[i];
    scan.points.set(i, (1 + random.normal(kNoise) / p.norm()) * p);
  }
  const nlohmann::json in_meters = recognize("m"), meters = in_meters.at("sensor");
  EXPECT_NEAR(meters.at("range").get<double>(), 0.85, 0.3);
  EXPECT_NEAR(meters.at("noise").get<double>(), kNoise, 0.5 * kNoise);
  for (std::size_t i = 0; i < scan.points.size(); ++i) scan.points.set(i, 1000 * scan.points[i]);
  const nlohmann::json in_millimeters = recognize("mm"), millimeters = in_millimeters.at("sensor");
  const auto near = [](const nlohmann::json& value, double expected) {
    EXPECT_NEAR(value.get<double>(), expected, 0.01 * expected + 0.001);
  };
  for (const char* const length : {"range", "noise", "correlated_noise"})
    near(millimeters.at(length), 1000 * meters.at(length).get<double>());
  for (const char* const number : {"exponent", "correlation", "edge_pixels"})
    near(millimeters.at(number), meters.at(number));
  EXPECT_NEAR(in_millimeters.at("noise").get<double>(), 1000 * in_meters.at("noise").get<double>(),
              10 * kNoise);
}

TEST_F(TrainRecognize, ReportsNoSensorOfAClosedSurface) {
  test::Shape whole = bracket_.moved(truth());
  // Faces form a closed surface if they share their corners.
  for (auto* const corners : {&whole.triangles.a, &whole.triangles.b, &whole.triangles.c}) {
    for (std::uint32_t& corner : *corners) {
      std::uint32_t first = 0;
      while (whole.vertices[first] != whole.vertices[corner]) ++first;
      corner = first;
    }
  }
  write("closed.ply", test::cloud_of(whole));
  const test::Outcome outcome = run({"recognize", "library.h5", "closed.ply", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json scene = nlohmann::json::parse(outcome.out)["scenes"][0];
  EXPECT_TRUE(scene.at("sensor").is_null());
  EXPECT_EQ(scene.at("detections").size(), 1U);
}

TEST_F(TrainRecognize, ReportsAVeryPoseThatIsRequiredWhereTheScanHoldsIt) {
  const nlohmann::json found = recognized(), required = recognized({"--require-pose"});
  EXPECT_GT(found["scenes"][0]["detections"][0].at("pose_share"), 0.99);
  EXPECT_EQ(required, found);
}

TEST_F(TrainRecognize, ReportsHowFarOffAPoseMayBe) {
  const nlohmann::json found = recognized()["scenes"][0]["detections"][0];
  const nlohmann::json& sigma = found.at("pose_sigma");
  for (std::size_t k = 0; k < 3; ++k) {
    const double shift = sigma.at("translation")[k], turn = sigma.at("rotation_deg")[k];
    EXPECT_GT(shift, 0);
    EXPECT_LT(shift, 0.01) << "the bracket is seen well";
    EXPECT_NEAR(sigma.at("covariance")[k][k].get<double>(), shift * shift, 1e-5 * shift * shift);
    EXPECT_NEAR(sigma.at("covariance")[k + 3][k + 3].get<double>(),
                std::pow(turn * 3.14159265 / 180, 2), 1e-4 * turn * turn);
  }
  EXPECT_FALSE(found.at("ambiguous"));
  const double least = sigma.at("translation")[0];
  const auto ambiguous = [&](double max_sigma) {
    const std::string text = fmt::format("{}", max_sigma);
    return recognized({"--max-sigma", text})["scenes"][0]["detections"][0].at("ambiguous");
  };
  EXPECT_TRUE(ambiguous(0.5 * least));
  EXPECT_FALSE(ambiguous(1));
}

TEST_F(TrainRecognize, PrintsNothingButJsonToStandardOutput) {
  const test::Outcome outcome = run({"recognize", "library.h5", "scan.ply", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << outcome.out;
  EXPECT_FALSE(outcome.error.empty());  // progress
  const test::Outcome quiet =
      run({"recognize", "library.h5", "scan.ply", "--json", "-", "--quiet"});
  EXPECT_TRUE(quiet.error.empty()) << quiet.error;
  EXPECT_EQ(detections(quiet.out), detections(outcome.out));
}

/// Expects a page that a browser shows without any other file or the network.
void expect_stands_alone(const std::string& page) {
  for (const char* text : {"http:", "https:", "<script", "src=\"pictures", "@import", "url("})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  EXPECT_NE(page.find("src=\"data:image/png;base64,iVBORw0KGgo"), std::string::npos);
}

TEST_F(TrainRecognize, ReportsWhatWasFoundAndWhatWasRejected) {
  // Another scene, whose name contains an angle bracket that HTML must not parse as a tag.
  const test::Shape wall = test::box({-1, -1, 1.2F}, {1, 1, 1.3F});
  test::Shape angle = test::box({0, 0, 0}, {0.1F, 0.05F, 0.01F});
  angle.join(test::box({0, 0, 0}, {0.01F, 0.05F, 0.06F}));
  write("a<b>&\"c\".ply", test::render_scan({{&wall, Pose::Identity()}, {&angle, truth()}}));
  const test::Outcome outcome =
      run({"recognize", "library.h5", "scan.ply", "a<b>&\"c\".ply", "--report", "report"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("bracket"), std::string::npos) << "it is printed as ever";
  const std::string page = bytes("report/index.html");
  expect_stands_alone(page);
  for (const char* text :
       {"1 object found in 2 scenes", ">scan.ply<", ">a&lt;b&gt;&amp;&quot;c&quot;.ply<",
        "1 bracket", "None of the models.", "What spoke for and against", "below 0.8", "turned by ",
        "other answers", "prefers-color-scheme", "The scan errs by ", "where neighbors err alike",
        "recognize library.h5 scan.ply 'a&lt;b&gt;&amp;&quot;c&quot;.ply' --report report"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(page.find("<b>&\"c"), std::string::npos);
  // A view is one picture with layers that the reader selects; each listed pose has its label.
  const auto count = [&](const std::string& text) {
    std::size_t n = 0;
    for (auto at = page.find(text); at != std::string::npos; at = page.find(text, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("class=\"layers\""), count(" checked>"));
  EXPECT_EQ(count("class=\"view\""), count("type=\"radio\""));
  for (std::size_t r = 1; count(fmt::format("<td class=\"id\">R{}<", r)) > 0; ++r)
    EXPECT_GT(count(fmt::format(">R{}</span>", r)), 0U) << r;
  for (const char* name : {"scene_0000_scan", "scene_0000_found", "scene_0001_scan"}) {
    const std::string png = bytes(std::string("report/pictures/") + name + ".png");
    EXPECT_EQ(png.substr(1, 3), "PNG") << name;
  }
}

// Besides scattered points: a closed mesh, a scan with too few points to draw, and a depth image.
TEST_F(TrainRecognize, ReportsScenesOfEveryKind) {
  write("moved.ply", test::cloud_of(bracket_.moved(truth())));
  Cloud few;
  for (int i = 0; i < 10; ++i) few.points.push_back({0, 0.01F * static_cast<float>(i), 1});
  write("few.ply", few);
  const test::Outcome clouds =
      run({"recognize", "library.h5", "moved.ply", "few.ply", "--report", "clouds"});
  ASSERT_EQ(clouds.exit_code, 0) << clouds.error;
  const std::string page = bytes("clouds/index.html");
  expect_stands_alone(page);
  EXPECT_NE(page.find("Nothing to draw: "), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(*folder_ / "clouds/pictures/scene_0000_scan.png"));
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "clouds/pictures/scene_0001_scan.png"));

  const Cloud scan = test::render_scan({{&bracket_, truth()}});
  std::vector<std::uint16_t> depths;
  for (const std::int32_t i : scan.grid->point_index) {
    depths.push_back(i == PixelGrid::kNone
                         ? std::uint16_t{0}
                         : static_cast<std::uint16_t>(
                               std::lround(1e4F * scan.points[static_cast<std::size_t>(i)].z())));
  }
  ASSERT_TRUE(write_depth_png(*folder_ / "depth.png", depths, scan.grid->width));
  folder_->write("camera.json",
                 R"({"fx": 570, "fy": 570, "cx": 319.5, "cy": 239.5, "depth_scale": 0.0001})");
  const test::Outcome depth = run({"recognize", "library.h5", "depth.png", "--camera",
                                   "camera.json", "--report", "depth", "--json", "depth.json"});
  ASSERT_EQ(depth.exit_code, 0) << depth.error;
  EXPECT_EQ(nlohmann::json::parse(bytes("depth.json"))["scenes"][0]["detections"].size(), 1U);
  EXPECT_NE(bytes("depth/index.html").find("1 bracket"), std::string::npos);
}

TEST_F(TrainRecognize, ReadsAScanFromStandardInputInAnyFormat) {
  nlohmann::json expected = recognized();
  const Result<Cloud> scan = read_cloud(*folder_ / "scan.ply");
  ASSERT_TRUE(scan) << scan.error().message;
  std::string values, lines;
  for (std::size_t i = 0; i < scan->points.size(); ++i) {
    const Eigen::Vector3f p = scan->points[i];
    values += test::little({p.x(), p.y(), p.z()});
    lines += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  folder_->write("scan.npy",
                 test::npy_file("<f4", fmt::format("({}, 3)", scan->points.size()), values));
  folder_->write("scan.ply.gz", test::gzip_file(bytes("scan.ply")));
  folder_->write("scan.dat", test::gzip_file(lines));
  const auto piped = [&](const std::string& file, const std::string& options) {
    return test::run_program(
        "/bin/sh",
        {"-c", "cat " + file + " | \"$0\" recognize library.h5 " + options, TRIVET_PROGRAM},
        {.folder = folder_->path(), .environment = {}, .watch = {}});
  };
  for (const auto& [file, options] :
       {std::pair("scan.ply", "-"), std::pair("scan.ply.gz", "-"), std::pair("scan.npy", "-"),
        std::pair("scan.dat", "- --format xyz"), std::pair("/dev/null", "scan.ply.gz"),
        std::pair("/dev/null", "scan.dat --format xyz"),
        std::pair("scan.npy", "- --report piped")}) {
    const test::Outcome outcome = piped(file, std::string(options) + " --json -");
    ASSERT_EQ(outcome.exit_code, 0) << file << ": " << outcome.error;
    nlohmann::json found = detections(outcome.out);
    EXPECT_EQ(found["scenes"][0]["scene"],
              std::string(options).substr(0, std::string_view(options).find(' ')));
    EXPECT_EQ(found["scenes"][0]["detections"], expected["scenes"][0]["detections"]) << file;
  }
  EXPECT_TRUE(std::filesystem::exists(*folder_ / "piped/index.html"));

  const auto fails = [&](const std::string& file, const std::string& options, int code,
                         const std::string& text) {
    const test::Outcome outcome = piped(file, options);
    EXPECT_EQ(outcome.exit_code, code) << outcome.error;
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
  };
  fails("scan.dat", "-", 2, "give --format");
  fails("scan.ply", "- -", 2, "once");
  fails("scan.ply", "- --format pcd", 65, "standard input");
  fails("scan.ply", "- --format doc", 2, "--format");
  fails("/dev/null", "-", 65, "standard input: the file is empty");
  EXPECT_EQ(run({"train", "-", "-o", "piped.h5"}).exit_code, 2);
}

TEST_F(TrainRecognize, NamesAPackedModelWithoutItsExtensions) {
  folder_->write("packed.ply.gz", test::gzip_file(bytes("lever.ply")));
  ASSERT_EQ(run({"train", "packed.ply.gz", "-o", "packed.h5", "--preset", "fast"}).exit_code, 0);
  const test::Outcome listed = run({"library", "list", "packed.h5"});
  EXPECT_NE(listed.out.find("packed"), std::string::npos) << listed.out;
  EXPECT_EQ(listed.out.find("packed.ply"), std::string::npos) << listed.out;
}

TEST_F(TrainRecognize, GivesNoReportWhereItCannotBeWritten) {
  folder_->write("taken", "a file");
  const test::Outcome outcome = run({"recognize", "library.h5", "scan.ply", "--report", "taken"});
  EXPECT_EQ(outcome.exit_code, 73) << outcome.error;
  EXPECT_EQ(bytes("taken"), "a file");
}

TEST_F(TrainRecognize, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2", "3"}) {
    const test::Outcome outcome = run({"train", "bracket.ply", "lever.ply", "-o", "again.h5",
                                       "--preset", "fast", "--threads", threads});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(bytes("again.h5"), bytes("library.h5")) << threads << " threads";
    EXPECT_EQ(recognized({"--threads", threads}), recognized()) << threads << " threads";
  }
}

TEST_F(TrainRecognize, IsTheSameWhereTheDecimalSignIsAComma) {
  folder_->write(
      "comma",
      "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3\nEND LC_NUMERIC\n");
  folder_->write("ascii",
                 "<code_set_name> ASCII\n<mb_cur_max> 1\nCHARMAP\n<U0000>..<U007F> \\x00 "
                 "ASCII\nEND CHARMAP\n");
  const std::string place = folder_->path().string();
  const std::string make =
      "cd " + place + " && localedef -c -i ./comma -f ./ascii ./xx_XX >localedef.log 2>&1";
  // The tool also fails because of missing categories that do not matter here.
  [[maybe_unused]] const int ignored = std::system(make.c_str());
  if (!std::filesystem::exists(*folder_ / "xx_XX/LC_NUMERIC"))
    GTEST_SKIP() << "localedef made no locale";

  // glibc's setlocale leaks the strings that it derives from LOCPATH; the leak is not in Trivet.
  const std::vector<std::string> environment{"LOCPATH=" + place, "LC_ALL=xx_XX",
                                             "LSAN_OPTIONS=detect_leaks=0"};
  folder_->write(
      "lever.obj",
      "v 0.5 0 0\nv 0 1.5 0\nv 0 0 2.5\nv 0.25 0.25 0.25\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  for (const std::string file : {"plain.h5", "comma.h5"}) {
    const bool comma = file == "comma.h5";
    const test::Outcome outcome = run({"train", "lever.obj", "-o", file, "--relative-step", "0.05"},
                                      comma ? environment : std::vector<std::string>{});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  EXPECT_EQ(bytes("comma.h5"), bytes("plain.h5"));
  EXPECT_EQ(recognized({"--min-score", "0.25"}, environment), recognized({"--min-score", "0.25"}));
}

TEST_F(TrainRecognize, GivesSeventyThreeForAnOutputThatCannotBeCreated) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"train", "lever.ply", "--preset", "fast", "-o", "nowhere/out"},
        {"recognize", "library.h5", "scan.ply", "--json", "nowhere/out"}}) {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 73) << outcome.error;
    EXPECT_NE(outcome.error.find("nowhere"), std::string::npos) << outcome.error;
  }
}

TEST_F(TrainRecognize, RefusesAModelThatTheLibraryDoesNotHold) {
  const test::Outcome outcome = run({"recognize", "library.h5", "scan.ply", "--models", "gear"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.error.find("gear"), std::string::npos) << outcome.error;
}

TEST_F(TrainRecognize, ListsTheModelsOfALibrary) {
  EXPECT_EQ(run({"library", "list", "library.h5"}).out, "bracket\nlever\n");
  const std::string info = run({"library", "info", "library.h5"}).out;
  for (const char* text : {"bracket", "lever", "library.h5"})
    EXPECT_NE(info.find(text), std::string::npos) << info;
}

TEST_F(TrainRecognize, ReportsTheContentsOfALibraryToPrograms) {
  const test::Outcome outcome = run({"library", "info", "library.h5", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json info = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(info.at("file"), "library.h5");
  EXPECT_EQ(info.at("bytes"), bytes("library.h5").size());
  EXPECT_EQ(info.at("format"), "1.5");
  EXPECT_EQ(info.at("unit"), "m");
  EXPECT_EQ(info.at("parameters").at("relative-step"), 0.05);
  EXPECT_GT(info.at("features").at("number"), 0);
  ASSERT_EQ(info.at("models").size(), 2U);
  const nlohmann::json& bracket = info["models"][0];
  EXPECT_EQ(bracket.at("name"), "bracket");
  EXPECT_EQ(bracket.at("source"), "bracket.ply");
  // Without the vertices that only triangles without area use.
  const auto cloud = read_cloud(*folder_ / "bracket.ply", {.keep_origin = true});
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(bracket.at("vertices"), cloud->points.size());
  EXPECT_GT(bracket.at("samples"), 1000);
  EXPECT_GT(bracket.at("diameter"), 0.1);
  EXPECT_GT(bracket.at("point_pairs").at("pairs"), 1000);
  EXPECT_TRUE(bracket.at("symmetry").at("axis").is_null());
}

TEST_F(TrainRecognize, ReadsModelsAndScenesFromAManifest) {
  folder_->write("set.json",
                 R"({"unit": "m", "models": {"part": {"file": "bracket.ply"}},
                     "scenes": [{"file": "scan.ply", "camera": null, "viewpoint": null, "truth": []}]})");
  ASSERT_EQ(run({"train", "set.json", "-o", "set.h5", "--preset", "fast"}).exit_code, 0);
  const test::Outcome outcome = run({"recognize", "set.h5", "set.json", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json found = detections(outcome.out)["scenes"][0]["detections"];
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["model"], "part");
}

}  // namespace
}  // namespace trivet
