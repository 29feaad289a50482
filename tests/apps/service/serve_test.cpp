/// The service from the client's view: responses, refusals, overload, reloads, and its end.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::ask;
using test::Connection;
using test::read_bytes;

class Serve : public test::ServeFixture {};

/// The metric series of a service, without their values.
std::set<std::string> series_of(int port) {
  std::istringstream lines(ask(port, "GET", "/metrics").body);
  std::set<std::string> series;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) series.insert(line.substr(0, line.rfind(' ')));
  }
  return series;
}

/// The lines of the log among what a service writes on standard error.
std::vector<nlohmann::json> logged_lines(const std::string& error) {
  std::istringstream lines(error);
  std::vector<nlohmann::json> logged;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("{")) logged.push_back(nlohmann::json::parse(line));
  }
  return logged;
}

TEST_F(Serve, AnswersWhatTheCommandLineAnswers) {
  const test::Outcome direct =
      test::run_trivet({"recognize", "l.h5", depth_.string(), "--camera", "camera.json", "--method",
                        "ppf", "--json", "-"},
                       {.folder = folder_.path(), .environment = {}, .watch = {}});
  ASSERT_EQ(direct.exit_code, 0) << direct.error;
  const nlohmann::json expected = nlohmann::json::parse(direct.out)["scenes"][0]["detections"];
  ASSERT_FALSE(expected.empty());
  const test::Outcome outcome = serve({}, [&](int port) {
    const Answer answer =
        ask(port, "POST", query_, read_bytes(depth_),
            "X-Request-Id: call-7\r\n"
            "traceparent: 00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01\r\n");
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.json()["scenes"][0]["detections"].dump(), expected.dump());
    EXPECT_EQ(answer.json()["request_id"], "call-7");
    EXPECT_EQ(answer.json()["library"]["generation"], 1);
    EXPECT_NE(answer.head.find("X-Request-Id: call-7"), std::string::npos) << answer.head;
    EXPECT_NE(answer.head.find("traceparent: 00-0af76519"), std::string::npos) << answer.head;
    EXPECT_EQ(ask(port, "GET", "/v1/models").json()["models"].size(), 2U);
    EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
    EXPECT_EQ(ask(port, "GET", "/v2/health/ready").status, 200);
    const std::string metrics = ask(port, "GET", "/metrics").body;
    for (const char* const line :
         {"trivet_requests_total{route=\"recognize\",code=\"200\"} 1", "trivet_library_models 2",
          "trivet_stage_duration_seconds_count{stage=\"vote\"} 1"}) {
      EXPECT_NE(metrics.find(line), std::string::npos) << line << " in\n" << metrics;
    }
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, HasAllItsMetricsFromTheStart) {
  const test::Outcome outcome = serve({"--examples", "scans/manifest.json"}, [&](int port) {
    const std::set<std::string> before = series_of(port);
    for (const char* const name :
         {"trivet_requests_total{route=\"recognize\",code=\"503\"}",
          "trivet_requests_total{route=\"infer\",code=\"200\"}",
          "trivet_rejected_total{reason=\"full\"}", "trivet_reload_total{result=\"bad\"}",
          "trivet_stage_duration_seconds_count{stage=\"verify\"}", "process_cpu_seconds_total",
          "process_resident_memory_bytes", "process_virtual_memory_bytes", "process_open_fds",
          "process_max_fds", "process_start_time_seconds"}) {
      EXPECT_TRUE(before.contains(name)) << name;
    }
    const std::string scan = read_bytes(depth_);
    const std::string camera = parameters_.substr(parameters_.find("camera="));
    EXPECT_EQ(ask(port, "POST", query_, scan).status, 200);
    EXPECT_EQ(ask(port, "POST", "/v1/recognize?format=png&" + camera, scan).status, 200);
    EXPECT_EQ(ask(port, "POST", query_, "no PNG").status, 400);
    EXPECT_EQ(ask(port, "POST", query_, scan, "X-Deadline-Ms: 0.1\r\n").status, 504);
    EXPECT_EQ(ask(port, "POST", "/v1/points?format=png&" + camera, scan).status, 200);
    EXPECT_EQ(ask(port, "POST", "/v2/models/l/infer", "{}").status, 400);
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    EXPECT_EQ(ask(port, "GET", "/nowhere").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/recognize").status, 405);
    EXPECT_EQ(ask(port, "GET", "/v1/models/spoon/mesh.ply").status, 404);
    for (const char* const target :
         {"/v1/models", "/v1/examples", "/v1/examples/0", "/v1/score-parts", "/v1/words",
          "/v1/openapi.json", "/v2", "/v2/health/live", "/v2/health/ready", "/v2/models/l",
          "/v2/models/stats"})
      EXPECT_EQ(ask(port, "GET", target).status, 200) << target;
    EXPECT_EQ(ask(port, "POST", "/v2/repository/index").status, 200);
    EXPECT_EQ(series_of(port), before);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

// The same depths in other formats, and compressed.
TEST_F(Serve, AcceptsEveryFormatThatIsReadFromFiles) {
  const Result<Cloud> cloud = read_cloud(depth_, {.camera = camera_});
  ASSERT_TRUE(cloud) << cloud.error().message;
  const PixelGrid& grid = *cloud->grid;
  std::string pixels;
  for (const std::int32_t i : grid.point_index) {
    const double z =
        i == PixelGrid::kNone ? 0 : double{cloud->points[static_cast<std::size_t>(i)].z()};
    pixels += test::little(static_cast<std::uint16_t>(std::lround(z / camera_.depth_scale)));
  }
  const std::string npy =
      test::npy_file("<u2", fmt::format("({}, {})", grid.height, grid.width), pixels);
  const std::vector<std::pair<std::string, std::string>> bodies{
      {"png", read_bytes(depth_)},
      {"png", test::gzip_file(read_bytes(depth_))},
      {"npy", npy},
      {"npy", test::gzip_file(npy)},
      {"tif", test::tiff_file(grid.width, grid.height, 16, 1, pixels)}};
  const test::Outcome outcome = serve({}, [&](int port) {
    std::string expected;
    for (const auto& [format, body] : bodies) {
      const Answer answer =
          ask(port, "POST", "/v1/recognize?format=" + format + "&" + parameters_, body);
      ASSERT_EQ(answer.status, 200) << format << ": " << answer.body;
      const std::string found = answer.json()["scenes"][0]["detections"].dump();
      if (expected.empty()) expected = found;
      EXPECT_EQ(found, expected) << format;
      EXPECT_NE(found, "[]");
    }
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, AnswersSeveralScansOfOneRequest) {
  const std::string scan = read_bytes(depth_);
  const nlohmann::json camera = nlohmann::json::parse(read_bytes(folder_ / "camera.json"));
  const auto part = [](const std::string& head, const std::string& content) {
    return "--edge\r\nContent-Disposition: form-data; " + head + "\r\n\r\n" + content + "\r\n";
  };
  const auto scene = [&](const std::string& name, const std::string& content) {
    return part("name=\"scene\"; filename=\"" + name + "\"", content);
  };
  const auto options = [&](const nlohmann::json& json) {
    return part("name=options", json.dump());
  };
  const std::string form = "Content-Type: multipart/form-data; boundary=edge\r\n";
  const test::Outcome outcome = serve({"--max-waiting", "3"}, [&](int port) {
    const nlohmann::json one = ask(port, "POST", query_, scan).json()["scenes"][0];
    const auto post = [&](const std::string& body) {
      return ask(port, "POST", "/v1/recognize", body + "--edge--\r\n", form);
    };
    const Answer both = post(options({{"method", "ppf"}, {"camera", camera}}) +
                             scene("a.png", scan) + scene("b.png", scan));
    ASSERT_EQ(both.status, 200) << both.body;
    ASSERT_EQ(both.json()["scenes"].size(), 2U);
    EXPECT_EQ(both.json()["scenes"][0]["scene"], "a.png");
    const nlohmann::json all = both.json();
    for (const nlohmann::json& answered : all["scenes"])
      EXPECT_EQ(answered["detections"], one["detections"]);
    // Each scan may have its own camera: half the focal length changes every result.
    nlohmann::json wide = camera;
    wide["fx"] = wide["fx"].get<double>() / 2;
    const nlohmann::json apart =
        post(options({{"method", "ppf"}, {"scenes", {{{"camera", camera}}, {{"camera", wide}}}}}) +
             scene("a.png", scan) + scene("b.png", scan))
            .json()["scenes"];
    EXPECT_EQ(apart[0]["detections"], one["detections"]);
    EXPECT_NE(apart[1]["detections"], one["detections"]);

    // An unreadable scan does not affect the others.
    const Answer mixed = post(options({{"method", "ppf"}, {"camera", camera}}) +
                              scene("a.png", scan) + scene("b.png", "no") + scene("c.png", scan));
    ASSERT_EQ(mixed.status, 200) << mixed.body;
    EXPECT_EQ(mixed.json()["scenes"][0]["detections"], one["detections"]);
    EXPECT_EQ(mixed.json()["scenes"][1]["scene"], "b.png");
    EXPECT_NE(mixed.json()["scenes"][1]["error"].get<std::string>().find("b.png"),
              std::string::npos);
    EXPECT_EQ(mixed.json()["scenes"][2]["detections"], one["detections"]);

    const auto refuses = [&](const std::string& reason, const std::string& body) {
      const Answer answer = post(body);
      EXPECT_EQ(answer.status, 400) << answer.body;
      EXPECT_NE(answer.body.find(reason), std::string::npos) << answer.body;
    };
    refuses("part scene", "");
    refuses("part scene", options({{"method", "ppf"}}));
    refuses("b.png", options({{"camera", camera}}) + scene("a.png", "no") + scene("b.png", "no"));
    refuses("b.png", options({{"camera", camera}}) + scene("b.png", "no"));
    refuses("'a'", scene("a", scan));
    refuses("'../a.exe'", scene("../a.exe", scan));
    refuses("'other'", part("name=other", "x"));
    refuses("name=", part("filename=a.png", scan));
    refuses("as many as parts",
            options({{"scenes", nlohmann::json::array({{{"camera", camera}}})}}) +
                scene("a.png", scan) + scene("b.png", scan));
    refuses("camera, viewpoint or unit",
            options({{"scenes", {{{"method", "ppf"}}}}}) + scene("a.png", scan));
    refuses("options", part("name=options", "{") + scene("a.png", scan));
    refuses("expected at most 3 scenes", options({{"camera", camera}}) + scene("a.png", scan) +
                                             scene("b.png", scan) + scene("c.png", scan) +
                                             scene("d.png", scan));
    EXPECT_EQ(
        ask(port, "POST", "/v1/recognize", scan, "Content-Type: multipart/form-data\r\n").status,
        400);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, ShowsScansModelsAndWhatWasRejected) {
  const test::Outcome outcome = serve({"--examples", "scans/manifest.json"}, [&](int port) {
    const nlohmann::json examples = ask(port, "GET", "/v1/examples").json()["examples"];
    ASSERT_EQ(examples.size(), 1U);
    const Answer scan = ask(port, "GET", examples[0]["url"]);
    EXPECT_EQ(scan.body, read_bytes(depth_));
    EXPECT_EQ(ask(port, "GET", "/v1/examples/1").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/examples/x").status, 404);

    const std::string query = examples[0]["query"];
    const Answer all = ask(port, "POST", "/v1/points?max-points=5000000&" + query, scan.body);
    ASSERT_EQ(all.status, 200) << all.body;
    const Result<Cloud> cloud = read_cloud(depth_, {.camera = camera_});
    ASSERT_TRUE(cloud);
    ASSERT_EQ(all.body.size(), 12 * cloud->points.size());
    Eigen::Vector3f last;
    std::memcpy(last.data(), all.body.data() + all.body.size() - 12, 12);
    EXPECT_EQ(last, cloud->points[cloud->points.size() - 1]);
    const Answer few = ask(port, "POST", "/v1/points?max-points=1000&" + query, scan.body);
    EXPECT_NEAR(static_cast<double>(few.body.size()) / 12, 1000, 20);
    EXPECT_NE(few.head.find("X-Points: " + std::to_string(cloud->points.size())),
              std::string::npos);
    const Answer points = ask(port, "POST", "/v1/points?viewpoint=1,2,3.5&" + query, scan.body);
    EXPECT_NE(points.head.find("X-Viewpoint: 1,2,3.5"), std::string::npos) << points.head;
    EXPECT_EQ(ask(port, "POST", "/v1/points?max-points=0&" + query, scan.body).status, 400);
    EXPECT_EQ(ask(port, "POST", "/v1/points?intensity=7&" + query, scan.body).status, 400);
    const Answer lit =
        ask(port, "POST", "/v1/points?format=xyz&intensity=true", "1 2 3 4\n5 6 7 8");
    EXPECT_NE(lit.head.find("X-Columns: x,y,z,intensity"), std::string::npos) << lit.head;
    std::array<float, 8> numbers{};
    ASSERT_EQ(lit.body.size(), sizeof numbers);
    std::memcpy(numbers.data(), lit.body.data(), sizeof numbers);
    EXPECT_EQ(numbers, (std::array<float, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(ask(port, "POST", "/v1/points?" + query, "no PNG").status, 400);

    const nlohmann::json models = ask(port, "GET", "/v1/models").json()["models"];
    for (const nlohmann::json& model : models) {
      const nlohmann::json& near = model["near_symmetry"];
      const bool none = near.at("poses") == 0 && near.at("axis") == false;
      EXPECT_EQ(near.at("declaration").is_null(), none) << near;
      const Answer picture = ask(port, "GET", model["thumbnail"]);
      EXPECT_EQ(picture.body.substr(1, 3), "PNG");
      EXPECT_EQ(ask(port, "GET", model["thumbnail"]).body, picture.body);
      const Answer mesh = ask(port, "GET", model["mesh"]);
      const Result<Cloud> surface = read_cloud(std::as_bytes(std::span(mesh.body)), "mesh.ply");
      ASSERT_TRUE(surface) << surface.error().message;
      EXPECT_GT(surface->triangles.size(), 10U);
    }
    EXPECT_EQ(ask(port, "GET", "/v1/models/spoon/mesh.ply").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/models/..%2f..%2fetc%2fpasswd").status, 400);

    const nlohmann::json words = ask(port, "GET", "/v1/score-parts").json();
    const nlohmann::json scene =
        ask(port, "POST", query_ + "&rejected=5", scan.body).json()["scenes"][0];
    ASSERT_FALSE(scene["detections"].empty());
    const double correlation = scene["detections"][0]["parts"]["correlation"];
    double log_odds =
        std::lerp(words["bias"][0].get<double>(), words["bias"][1].get<double>(), correlation);
    for (const nlohmann::json& part : words["parts"])
      log_odds += scene["detections"][0]["evidence"][part["name"].get<std::string>()].get<double>();
    EXPECT_NEAR(scene["detections"][0]["score"].get<double>(), 1 / (1 + std::exp(-log_odds)), 1e-3);
    const nlohmann::json refused =
        ask(port, "POST", query_ + "&rejected=5&min-score=1", scan.body).json()["scenes"][0];
    EXPECT_TRUE(refused["detections"].empty());
    EXPECT_FALSE(refused["rejected"].empty());
    for (const nlohmann::json& rejected : refused["rejected"])
      EXPECT_NE(rejected.at("words").get<std::string>(), "");
    EXPECT_EQ(ask(port, "POST", query_ + "&rejected=101", scan.body).status, 400);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, LogsALineARecognition) {
  const test::Outcome outcome = serve({}, [&](int port) {
    EXPECT_EQ(ask(port, "POST", query_, read_bytes(depth_), "X-Request-Id: seen\r\n").status, 200);
    EXPECT_EQ(ask(port, "POST", query_, "no PNG", "X-Request-Id: a\"b\r\n").status, 400);
    EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::vector<nlohmann::json> logged = logged_lines(outcome.error);
  ASSERT_EQ(logged.size(), 4U) << outcome.error;
  EXPECT_EQ(logged[0]["request_id"], "seen");
  EXPECT_EQ(logged[0]["route"], "recognize");
  EXPECT_EQ(logged[0]["code"], 200);
  EXPECT_GT(logged[0]["work_seconds"], 0.0);
  EXPECT_GT(logged[0]["detections"], 0);
  EXPECT_EQ(logged[1]["code"], 400);
  EXPECT_NE(logged[1]["request_id"], "a\"b") << "only plain ids are accepted";
  EXPECT_EQ(logged[2]["msg"], "ending");
  EXPECT_EQ(logged[3]["msg"], "every request was answered");
}

// The failed scans of a form were once counted as scenes that were answered.
TEST_F(Serve, TellsScenesThatFailedFromThoseRecognized) {
  const std::string scan = read_bytes(depth_),
                    form = "Content-Type: multipart/form-data; boundary=b\r\n";
  const auto part = [](const std::string& head, const std::string& content) {
    return "--b\r\nContent-Disposition: form-data; name=" + head + "\r\n\r\n" + content + "\r\n";
  };
  const std::string options = part(
      "options", "{\"method\": \"ppf\", \"camera\": " + read_bytes(folder_ / "camera.json") + "}");
  const auto scene = [&](const std::string& content) {
    return part("scene; filename=a.png", content);
  };
  std::string metrics;
  const test::Outcome outcome = serve({}, [&](int port) {
    const auto post = [&](const std::string& body) {
      return ask(port, "POST", "/v1/recognize", options + body + "--b--\r\n", form).status;
    };
    EXPECT_EQ(post(scene(scan) + scene("no") + scene(scan)), 200);
    EXPECT_EQ(post(scene("no") + scene("no")), 400);
    EXPECT_EQ(post(scene("no")), 400);
    EXPECT_EQ(ask(port, "POST", query_, scan).status, 200);
    EXPECT_EQ(ask(port, "POST", "/v2/models/l/infer", "{}").status, 400);
    EXPECT_EQ(ask(port, "POST",
                  "/v1/points?format=png&" + parameters_.substr(parameters_.find("camera=")), "no")
                  .status,
              400);
    metrics = ask(port, "GET", "/metrics").body;
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  std::vector<nlohmann::json> counts;  // scenes recognized, and failed
  for (const nlohmann::json& line : logged_lines(outcome.error)) {
    if (line["msg"] == "request")
      counts.push_back({line.value("scenes", -1), line.value("failed_scenes", -1)});
  }
  EXPECT_EQ(nlohmann::json(counts),
            nlohmann::json::parse("[[2, 1], [0, 2], [0, 1], [1, 0], [0, 1], [-1, -1]]"))
      << outcome.error;
  EXPECT_NE(metrics.find("\ntrivet_scenes_total{result=\"recognized\"} 3\n"), std::string::npos)
      << metrics;
  EXPECT_NE(metrics.find("\ntrivet_scenes_total{result=\"failed\"} 5\n"), std::string::npos)
      << metrics;
}

TEST_F(Serve, RefusesWithAReasonAndGoesOn) {
  const test::Outcome outcome =
      serve({"--max-body-mb", "1", "--max-connections-per-address", "20"}, [&](int port) {
        const auto refuses = [&](int status, const std::string& reason, const std::string& method,
                                 const std::string& target, const std::string& body = "",
                                 const std::string& headers = "") {
          const Answer answer = ask(port, method, target, body, headers);
          EXPECT_EQ(answer.status, status) << target << "\n" << answer.body;
          EXPECT_NE(answer.body.find(reason), std::string::npos) << answer.body;
        };
        refuses(400, "path: expected", "GET", "/v1/../../etc/passwd");
        refuses(405, "expected POST", "GET", query_);
        refuses(400, "format", "POST", "/v1/recognize", "ply");
        refuses(400, "body.ply", "POST", "/v1/recognize?format=ply", "ply\nnonsense");
        refuses(400, "body.png", "POST", query_, read_bytes(depth_).substr(0, 500));
        refuses(400, "is empty", "POST", query_, "");
        refuses(400, "min-score", "POST", query_ + "&min-score=high", read_bytes(depth_));
        refuses(400, "0 to 1", "POST", query_ + "&min-score=7", read_bytes(depth_));
        refuses(400, "expected", "POST", query_ + "&expected=/etc/passwd", read_bytes(depth_));
        refuses(400, "spoon", "POST", query_ + "&models=spoon", read_bytes(depth_));
        refuses(400, "hexadecimal", "POST", query_ + "&models=%zz", read_bytes(depth_));
        refuses(400, "X-Deadline-Ms", "POST", query_, read_bytes(depth_),
                "X-Deadline-Ms: soon\r\n");
        refuses(504, "deadline", "POST", query_, read_bytes(depth_), "X-Deadline-Ms: 1\r\n");
        refuses(413, "1048576", "POST", query_, std::string(2 << 20, 'x'));
        refuses(431, "headers", "GET", "/metrics", "",
                "X-Long: " + std::string(20'000, 'x') + "\r\n");
        std::vector<std::unique_ptr<Connection>> many;
        for (int i = 0; i < 20; ++i) many.push_back(std::make_unique<Connection>(port));
        refuses(503, "from this address", "GET", "/metrics");
        many.clear();
        while (ask(port, "GET", "/metrics").status == 503)
          continue;  // until it notices that they are closed
        const Connection garbage(port);
        garbage.send("\x01\x02 not http\r\n\r\n");
        EXPECT_NE(garbage.receive().find(" 400 "), std::string::npos);
        EXPECT_EQ(ask(port, "POST", query_, read_bytes(depth_)).status, 200);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, RefusesAtOnceWhatWouldOnlyWait) {
  const test::Outcome outcome = serve({"--parallel", "1", "--max-waiting", "2"}, [&](int port) {
    std::vector<std::thread> clients;
    std::vector<Answer> answers(24);
    for (Answer& answer : answers)
      clients.emplace_back([&] { answer = ask(port, "POST", query_, read_bytes(depth_)); });
    for (std::thread& client : clients) client.join();
    std::size_t num_right = 0, num_refused = 0;
    for (const Answer& answer : answers) {
      num_right += answer.status == 200 ? 1 : 0;
      if (answer.status != 503) continue;
      ++num_refused;
      EXPECT_NE(answer.head.find("Retry-After"), std::string::npos) << answer.head;
    }
    EXPECT_EQ(num_right + num_refused, answers.size());
    EXPECT_GE(num_right, 3U);
    EXPECT_GE(num_refused, 10U);
    EXPECT_EQ(ask(port, "POST", query_, read_bytes(depth_)).status, 200) << "after the storm";
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, SlowClientsHoldUpNobody) {
  const test::Outcome outcome = serve({}, [&](int port) {
    std::vector<std::unique_ptr<Connection>> slow;
    for (int i = 0; i < 200; ++i) {
      slow.push_back(std::make_unique<Connection>(port));
      slow.back()->send("POST /v1/recognize?format=ply HTTP/1.1\r\nContent-Le");
    }
    for (int i = 0; i < 10; ++i) {
      const Answer answer = ask(port, "GET", "/v2/health/live");
      EXPECT_EQ(answer.status, 200);
      EXPECT_LT(answer.seconds, 2) << "of a machine that does other things, too";
    }
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, ReloadsItsLibraryWhileItAnswers) {
  const std::string good = read_bytes(folder_ / "l.h5");
  const test::Outcome outcome = serve({}, [&](int port) {
    std::atomic<bool> stop{false};
    std::atomic<int> num_failed{0}, num_answered{0};
    std::thread client([&] {
      while (!stop) {
        const Answer answer = ask(port, "POST", query_, read_bytes(depth_));
        ++(answer.status == 200 ? num_answered : num_failed);
      }
    });
    int generation = 1;
    for (int i = 0; i < 10; ++i) {
      const bool is_good = i % 2 == 0;
      const fs::path next = folder_ / "next.h5";
      std::ofstream(next, std::ios::binary) << (is_good ? good : good.substr(0, good.size() / 2));
      fs::rename(next, folder_ / "l.h5");
      const Answer answer = ask(port, "POST", "/v1/library/reload");
      EXPECT_EQ(answer.status, is_good ? 200 : 409) << answer.body;
      generation += is_good ? 1 : 0;
      EXPECT_EQ(ask(port, "GET", "/v1/models").json()["generation"], generation);
    }
    stop = true;
    client.join();
    EXPECT_EQ(num_failed, 0);
    EXPECT_GT(num_answered, 0);
    kill(process_, SIGHUP);
    for (int i = 0; i < 100 && ask(port, "GET", "/v1/models").json()["generation"] == generation;
         ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_EQ(ask(port, "GET", "/v1/models").json()["error"], nlohmann::json());
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Serve, AnswersAcceptedRequestsBeforeItEnds) {
  std::vector<Answer> answers(8);
  const test::Outcome outcome = serve({"--parallel", "1"}, [&](int port) {
    std::vector<std::thread> clients;
    for (Answer& answer : answers)
      clients.emplace_back([&] { answer = ask(port, "POST", query_, read_bytes(depth_)); });
    // All requests are answered after passing through the queue.
    for (int i = 0; i < 200; ++i) {
      const std::string metrics = ask(port, "GET", "/metrics").body;
      std::smatch waiting;
      if (std::regex_search(metrics, waiting, std::regex("\ntrivet_queue_depth ([0-9]+)")) &&
          std::stoi(waiting[1]) >= 5) {
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    request_end();
    for (std::thread& client : clients) client.join();
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const Answer& answer : answers) EXPECT_EQ(answer.status, 200) << answer.body;
}

TEST_F(Serve, SaysAtOnceWhatItCannotServe) {
  const auto fails = [&](const std::vector<std::string>& arguments, int exit_code,
                         const std::string& reason) {
    const test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.error;
    EXPECT_NE(outcome.error.find(reason), std::string::npos) << outcome.error;
  };
  fails({"serve", "absent.h5"}, 2, "absent.h5: no such file");
  fails({"serve", "camera.json"}, 65, "camera.json");
  fails({"serve", "l.h5", "--address", "nowhere"}, 2, "nowhere");
  fails({"serve", "l.h5", "--max-waiting", "0"}, 2, "1 to 100000");
  serve({}, [&](int port) {
    fails({"serve", "l.h5", "--port", std::to_string(port)}, 73, std::to_string(port));
  });
}

}  // namespace
}  // namespace trivet
