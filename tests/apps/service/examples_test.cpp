// The clients in examples/ find the same poses as the service, and Prometheus accepts its metrics.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

const std::string kExamples = std::string(TRIVET_SOURCES) + "/examples/";

class Examples : public test::ServeFixture {
 protected:
  test::Outcome run(const std::string& program, const std::vector<std::string>& arguments,
                    const std::vector<std::string>& environment = {}) const {
    return test::run_program(program, arguments,
                             {.folder = folder_.path(), .environment = environment, .watch = {}});
  }

  /// The detections as printed by the examples, best first.
  static std::string lines_of(const nlohmann::json& scene) {
    std::string lines;
    for (const nlohmann::json& found : scene["detections"]) {
      const nlohmann::json& pose = found["T_scene_model"];
      lines +=
          fmt::format("{:20} {:6.3f} {:10.4f} {:10.4f} {:10.4f}\n",
                      found["model"].get<std::string>(), found["score"].get<double>(),
                      pose[0][3].get<double>(), pose[1][3].get<double>(), pose[2][3].get<double>());
    }
    return lines;
  }
};

TEST_F(Examples, FindWhatTheServiceFinds) {
  std::vector<std::string> parameters;
  std::istringstream pairs(parameters_);
  for (std::string pair; std::getline(pairs, pair, '&');) parameters.push_back(pair);
  const test::Outcome outcome = serve({}, [&](int port) {
    const std::string url = "http://127.0.0.1:" + std::to_string(port);
    const nlohmann::json scene =
        test::ask(port, "POST", query_, test::read_bytes(depth_)).json()["scenes"][0];
    const std::string expected = lines_of(scene);
    ASSERT_FALSE(expected.empty());

    const test::Outcome shell =
        run("/bin/sh", {kExamples + "recognize.sh", depth_, parameters_}, {"TRIVET_URL=" + url});
    ASSERT_EQ(shell.exit_code, 0) << shell.error;
    EXPECT_EQ(lines_of(nlohmann::json::parse(shell.out)["scenes"][0]), expected) << shell.error;

    std::vector<std::string> words{kExamples + "recognize.py", depth_, "--url", url};
    words.insert(words.end(), parameters.begin(), parameters.end());
    const test::Outcome python = run(TRIVET_PYTHON, words);
    EXPECT_EQ(python.out.substr(python.out.find('\n') + 1), expected) << python.error;
    words.push_back("min-score=2");
    const test::Outcome refused = run(TRIVET_PYTHON, words);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.error.find("400: min-score"), std::string::npos) << refused.error;

    const test::Outcome compiled = run(
        TRIVET_EXAMPLE, {"127.0.0.1", std::to_string(port), depth_, "format=png&" + parameters_});
    EXPECT_EQ(compiled.out, expected) << compiled.error;
    EXPECT_EQ(run(TRIVET_EXAMPLE, {"127.0.0.1", std::to_string(port), depth_, "x=1"}).exit_code, 1);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

/// Writes an array [N, 3] of floats in the format of numpy's np.load (version 1.0).
void write_npy(const std::filesystem::path& file, const Points& points) {
  std::string header =
      fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 3), }}", points.size());
  header.append(117 - header.size() % 64, ' ');  // magic, version, size and header end at 64
  header.back() = '\n';
  std::ofstream out(file, std::ios::binary);
  const auto size = static_cast<std::uint16_t>(header.size());
  out << "\x93NUMPY\x01" << '\0' << static_cast<char>(size & 255) << static_cast<char>(size >> 8)
      << header;
  for (std::size_t i = 0; i < points.size(); ++i)
    out.write(reinterpret_cast<const char*>(points[i].eval().data()), 12);
}

TEST_F(Examples, InferFromAnArray) {
  const Result<Cloud> scan = read_cloud(depth_, {.camera = camera_});
  ASSERT_TRUE(scan);
  write_npy(folder_ / "scan.npy", scan->points);
  const test::Outcome outcome = serve({}, [&](int port) {
    const test::Outcome inferred =
        run(TRIVET_PYTHON, {kExamples + "infer.py", "scan.npy", "--url",
                            "http://127.0.0.1:" + std::to_string(port), "method=ppf"});
    EXPECT_EQ(inferred.exit_code, 0) << inferred.error;
    std::string body;
    for (std::size_t i = 0; i < scan->points.size(); ++i)
      body +=
          fmt::format("{} {} {}\n", scan->points[i].x(), scan->points[i].y(), scan->points[i].z());
    const nlohmann::json scene =
        test::ask(port, "POST", "/v1/recognize?method=ppf&format=xyz", body).json()["scenes"][0];
    ASSERT_FALSE(scene["detections"].empty());
    EXPECT_EQ(inferred.out, lines_of(scene));
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Examples, PrometheusAcceptsTheMetrics) {
  if (std::string(TRIVET_PROMTOOL).empty()) GTEST_SKIP() << "promtool is not installed";
  const test::Outcome outcome = serve({}, [&](int port) {
    test::ask(port, "POST", query_, test::read_bytes(depth_));
    test::ask(port, "POST", query_, "no PNG");
    std::ofstream(folder_ / "metrics") << test::ask(port, "GET", "/metrics").body;
    const test::Outcome checked =
        run("/bin/sh", {"-c", std::string(TRIVET_PROMTOOL) + " check metrics < metrics"});
    EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.error;
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet
