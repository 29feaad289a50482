/// The Open Inference Protocol, as its clients use it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "apps/service/gzip.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/serve/inference/metadata.hpp"
#include "apps/service/serve/inference/protocol.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using apps::service::InferenceRequest;
using apps::service::InferenceResponse;
using apps::service::parse_inference;
using apps::service::write_inference;
using test::Answer;
using test::ask;

const nlohmann::json kPoint{
    {"name", "points"}, {"datatype", "FP32"}, {"shape", {1, 3}}, {"data", {0, 0, 1}}};

nlohmann::json request_for(const nlohmann::json& outputs) {
  return {{"inputs", {kPoint}}, {"outputs", outputs}};
}

SceneResult one_detection() {
  SceneResult result;
  result.detections.emplace_back();
  result.detections[0].model = "cup";
  result.detections[0].score = 0.5F;
  return result;
}

std::vector<std::string> names_of(const nlohmann::json& answer) {
  std::vector<std::string> names;
  for (const nlohmann::json& output : answer["outputs"]) names.push_back(output["name"]);
  return names;
}

TEST(WriteInference, GivesTheOutputsThatAreAskedFor) {
  const auto answer_to = [](const nlohmann::json& asked) {
    const Result<InferenceRequest> request = parse_inference(asked.dump(), {});
    EXPECT_TRUE(request) << request.error().message;
    return write_inference(*request, one_detection(), "l", 1);
  };
  using Names = std::vector<std::string>;
  const auto names = [&](const nlohmann::json& asked) {
    return names_of(nlohmann::json::parse(answer_to(asked).body));
  };
  EXPECT_EQ(names({{"inputs", {kPoint}}}), (Names{"poses", "scores", "models"}));
  EXPECT_EQ(names(request_for(nlohmann::json::array())), (Names{"poses", "scores", "models"}));
  EXPECT_EQ(names(request_for({{{"name", "scores"}}})), Names{"scores"});
  EXPECT_EQ(names(request_for({{{"name", "models"}}, {{"name", "poses"}}})),
            (Names{"models", "poses"}));

  // An output's parameter overrides the request's parameter for all outputs.
  nlohmann::json mixed = request_for(
      {{{"name", "models"}}, {{"name", "scores"}, {"parameters", {{"binary_data", false}}}}});
  mixed["parameters"]["binary_data_output"] = true;
  const InferenceResponse response = answer_to(mixed);
  EXPECT_EQ(response.body.substr(response.header_size), std::string("\3\0\0\0cup", 7));
  const nlohmann::json json =
      nlohmann::json::parse(response.body.substr(0, response.header_size))["outputs"];
  EXPECT_EQ(json[0]["parameters"]["binary_data_size"], 7);
  EXPECT_EQ(json[1]["data"], nlohmann::json::array({0.5}));
}

TEST(ParseInference, RefusesOutputsThatAreNone) {
  const auto refuses = [](const nlohmann::json& outputs, const std::string& reason) {
    const Result<InferenceRequest> request = parse_inference(request_for(outputs).dump(), {});
    ASSERT_FALSE(request) << outputs;
    EXPECT_EQ(request.error().code, ErrorCode::bad_data);
    EXPECT_NE(request.error().message.find(reason), std::string::npos) << request.error().message;
  };
  refuses({{{"name", "spoons"}}}, "expected poses, scores or models, found \"spoons\"");
  refuses({{{"name", "points"}}}, "expected poses, scores or models");
  refuses({{{"name", "poses"}}, {{"name", "poses"}}}, "each output once");
  refuses({{{"name", "scores"}, {"parameters", {{"classification", 2}}}}},
          "parameters.classification: expected no parameter here but binary_data");
  refuses({{{"name", "scores"}, {"parameters", {{"shared_memory_region", "r"}}}}},
          "shared_memory_region");
  refuses({{{"parameters", {{"binary_data", true}}}}}, "name");
}

TEST(ParseInference, AcceptsWhatTritonsClientsSayOfScheduling) {
  const auto parse = [](const nlohmann::json& parameters) {
    return parse_inference(nlohmann::json{{"inputs", {kPoint}}, {"parameters", parameters}}.dump(),
                           {});
  };
  const Result<InferenceRequest> all = parse({{"timeout", 2500},
                                              {"priority", 3},
                                              {"sequence_id", 18446744073709551615ULL},
                                              {"sequence_start", true},
                                              {"sequence_end", false},
                                              {"method", "ppf"}});
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->timeout, std::chrono::microseconds(2500));
  EXPECT_EQ(all->options, (apps::service::Parameters{{"method", "ppf"}}));
  EXPECT_TRUE(parse({{"sequence_id", "camera-1"}}));
  EXPECT_EQ(parse(nlohmann::json::object())->timeout.count(), 0);
  for (const nlohmann::json& wrong : std::vector<nlohmann::json>{{{"timeout", -1}},
                                                                 {{"timeout", 1.5}},
                                                                 {{"timeout", "1000"}},
                                                                 {{"timeout", 3'600'000'001}},
                                                                 {{"priority", -1}},
                                                                 {{"priority", true}},
                                                                 {{"sequence_id", -1}},
                                                                 {{"sequence_start", 1}},
                                                                 {{"sequence_end", "no"}}}) {
    const Result<InferenceRequest> request = parse(wrong);
    ASSERT_FALSE(request) << wrong;
    EXPECT_NE(request.error().message.find(wrong.begin().key()), std::string::npos)
        << request.error().message;
  }
}

class Inference : public test::ServeFixture {
 protected:
  /// The scan as the bytes of an FP32 tensor [N, 3].
  std::string points() const {
    const Result<Cloud> scan = read_cloud(depth_, {.camera = camera_});
    EXPECT_TRUE(scan);
    std::string bytes;
    for (std::size_t i = 0; i < scan->points.size(); ++i)
      bytes.append(reinterpret_cast<const char*>(scan->points[i].data()), 12);
    return bytes;
  }
};

/// A request in the format of Triton's clients: JSON, then the tensors.
struct Packed {
  std::string body, headers;

  Packed(const std::string& points, nlohmann::json json) {
    const std::string viewpoint(12, '\0');
    const auto tensor = [](const char* name, nlohmann::json shape, std::size_t size) {
      return nlohmann::json{{"name", name},
                            {"shape", std::move(shape)},
                            {"datatype", "FP32"},
                            {"parameters", {{"binary_data_size", size}}}};
    };
    json["inputs"] = {tensor("points", {points.size() / 12, 3}, points.size()),
                      tensor("viewpoint", {3}, viewpoint.size())};
    json["parameters"]["method"] = "ppf";
    body = json.dump();
    headers = fmt::format("Inference-Header-Content-Length: {}\r\n", body.size());
    body += points + viewpoint;
  }
  void pack(test::Packing packing) {
    body = test::pack(packing, body);
    headers += packing == test::Packing::gzip ? "Content-Encoding: gzip\r\n"
                                              : "Content-Encoding: deflate\r\n";
  }
};

/// The JSON in front of a response's tensors.
nlohmann::json json_of(const Answer& answer) {
  std::smatch size;
  const bool has_tensors = std::regex_search(
      answer.head, size, std::regex("\r\nInference-Header-Content-Length: ([0-9]+)"));
  return nlohmann::json::parse(
      answer.body.substr(0, has_tensors ? std::stoul(size[1]) : answer.body.npos), nullptr, false);
}

TEST_F(Inference, AnswersWhatTritonsClientAsks) {
  const std::string scan = points();
  const test::Outcome outcome = serve({}, [&](int port) {
    const auto get = [&](const std::string& target) {
      const Answer answer = ask(port, "GET", "/v2/" + target);
      EXPECT_EQ(answer.status, 200) << target << ": " << answer.body;
      return answer.json();
    };
    for (const char* const target :
         {"health/live", "health/ready", "models/l/ready", "models/l/versions/1/ready"})
      get(target);
    EXPECT_EQ(get("models/l/versions/1"), get("models/l"));

    // Metadata and configuration describe the same tensors, each with its field names.
    const nlohmann::json metadata = get("models/l"), configuration = get("models/l/config");
    EXPECT_EQ(configuration, get("models/l/versions/1/config"));
    EXPECT_EQ(configuration["name"], "l");
    EXPECT_EQ(configuration["max_batch_size"], 0);
    for (const char* const side : {"input", "output"}) {
      const nlohmann::json& tensors = metadata[std::string(side) + "s"];
      ASSERT_EQ(configuration[side].size(), tensors.size());
      for (std::size_t i = 0; i < tensors.size(); ++i) {
        const nlohmann::json& one = configuration[side][i];
        EXPECT_EQ(one["name"], tensors[i]["name"]);
        EXPECT_EQ(one["dims"], tensors[i]["shape"]);
        EXPECT_EQ(one["data_type"],
                  tensors[i]["datatype"] == "BYTES" ? "TYPE_STRING" : "TYPE_FP32");
        EXPECT_EQ(one.value("optional", false), one["name"] == "viewpoint");
      }
    }

    for (const char* const body : {"", "{}", R"({"ready":true})"}) {
      const Answer index = ask(port, "POST", "/v2/repository/index", body);
      EXPECT_EQ(index.status, 200) << index.body;
      EXPECT_EQ(index.json(), nlohmann::json::parse(
                                  R"([{"name":"l","version":"1","state":"READY","reason":""}])"));
    }
    EXPECT_EQ(ask(port, "POST", "/v2/repository/index", "{").status, 400);
    EXPECT_EQ(ask(port, "POST", "/v2/repository/index", R"({"ready":7})").status, 400);

    const auto infer = [&](const nlohmann::json& json, const char* path, int packing = -1,
                           const std::string& headers = "") {
      Packed request(scan, json);
      if (packing >= 0) request.pack(static_cast<test::Packing>(packing));
      return ask(port, "POST", path, request.body, request.headers + headers);
    };
    // A client that names no outputs gets all of them, after the JSON.
    const nlohmann::json plain{{"parameters", {{"binary_data_output", true}}}};
    const Answer all = infer(plain, "/v2/models/l/infer");
    ASSERT_EQ(all.status, 200) << all.body;
    EXPECT_EQ(names_of(json_of(all)), (std::vector<std::string>{"poses", "scores", "models"}));
    EXPECT_EQ(infer(plain, "/v2/models/l/versions/1/infer").body, all.body);
    EXPECT_EQ(infer(plain, "/v2/models/l/infer", 0, "Accept-Encoding: gzip\r\n").body, all.body);
    EXPECT_EQ(infer(plain, "/v2/models/l/infer", 1).body, all.body);
    EXPECT_EQ(infer({{"parameters",
                      {{"binary_data_output", true},
                       {"sequence_id", 5},
                       {"sequence_start", true},
                       {"sequence_end", true},
                       {"priority", 2},
                       {"timeout", 3'600'000'000}}}},
                    "/v2/models/l/infer")
                  .body,
              all.body);
    const Answer scores =
        infer({{"outputs", {{{"name", "scores"}, {"parameters", {{"binary_data", true}}}}}}},
              "/v2/models/l/infer");
    EXPECT_EQ(names_of(json_of(scores)), std::vector<std::string>{"scores"});
    EXPECT_EQ(infer({{"outputs", {{{"name", "spoons"}}}}}, "/v2/models/l/infer").status, 400);
    for (const char* const path :
         {"/v2/models/l/versions/9/infer", "/v2/models/ll/infer", "/v2/models/l/versions/infer",
          "/v2/models/l/versions/11/infer"}) {
      EXPECT_EQ(infer(plain, path).status, 404) << path;
    }

    const nlohmann::json statistics = get("models/l/stats");
    EXPECT_EQ(statistics, get("models/l/versions/1/stats"));
    EXPECT_EQ(statistics, get("models/stats"));
    const nlohmann::json& one = statistics["model_stats"][0];
    EXPECT_EQ(one["name"], "l");
    EXPECT_EQ(one["version"], "1");
    EXPECT_EQ(one["inference_count"], 6);
    EXPECT_GT(one["last_inference"], 1'600'000'000'000);
    const nlohmann::json& stats = one["inference_stats"];
    EXPECT_EQ(stats["success"]["count"], 6);
    EXPECT_EQ(stats["fail"]["count"], 1);
    std::uint64_t sum = 0;
    for (const char* const part : {"queue", "compute_input", "compute_infer"}) {
      EXPECT_EQ(stats[part]["count"], 6) << part;
      sum += stats[part]["ns"].get<std::uint64_t>();
    }
    EXPECT_GT(stats["compute_infer"]["ns"], 0);
    EXPECT_LE(sum, stats["success"]["ns"].get<std::uint64_t>());
    // A different library has none yet.
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    EXPECT_EQ(get("models/l/versions/2/stats")["model_stats"][0]["inference_count"], 0);
    EXPECT_EQ(ask(port, "GET", "/v2/models/l/versions/1/stats").status, 404);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Inference, EndsWithItsTimeout) {
  const std::string scan = points();
  nlohmann::json numbers = nlohmann::json::array();
  for (std::size_t i = 0; i < scan.size(); i += 4) {
    float number = 0;
    std::memcpy(&number, scan.data() + i, 4);
    numbers.push_back(number);
  }
  const test::Outcome outcome = serve({"--parallel", "1"}, [&](int port) {
    const auto status = [&](const nlohmann::json& timeout) {
      const Packed request(scan, {{"parameters", {{"timeout", timeout}}}});
      return ask(port, "POST", "/v2/models/l/infer", request.body, request.headers).status;
    };
    EXPECT_EQ(status(0), 200) << "none";
    EXPECT_EQ(status(3'000'000'000), 200) << "most of an hour";
    EXPECT_EQ(status(1), 504) << "a microsecond";
    EXPECT_EQ(status(2000), 504) << "milliseconds";
    EXPECT_EQ(status("soon"), 400);
    // After tensors in JSON the timeout is parsed later, but still applies.
    const nlohmann::json late{{"inputs",
                               {{{"name", "points"},
                                 {"datatype", "FP32"},
                                 {"shape", {scan.size() / 12, 3}},
                                 {"data", numbers}}}},
                              {"parameters", {{"method", "ppf"}, {"timeout", 1000}}}};
    EXPECT_EQ(ask(port, "POST", "/v2/models/l/infer", late.dump()).status, 504);
    const std::string metrics = ask(port, "GET", "/metrics").body;
    EXPECT_NE(metrics.find("trivet_rejected_total{reason=\"deadline\"} 3"), std::string::npos)
        << metrics;
    // A waiting request is answered when its timeout has passed, not when its turn comes.
    std::vector<std::thread> others;
    for (int i = 0; i < 12; ++i) others.emplace_back([&] { EXPECT_EQ(status(0), 200); });
    EXPECT_TRUE(test::comes([&] {
      std::smatch waiting;
      const std::string now = ask(port, "GET", "/metrics").body;
      return std::regex_search(now, waiting, std::regex("\ntrivet_queue_depth ([0-9]+)")) &&
             std::stoi(waiting[1]) >= 6;
    }));
    const Packed request(scan, {{"parameters", {{"timeout", 1000}}}});
    EXPECT_EQ(ask(port, "POST", "/v2/models/l/infer", request.body, request.headers).status, 504);
    std::smatch waiting;
    const std::string now = ask(port, "GET", "/metrics").body;
    ASSERT_TRUE(std::regex_search(now, waiting, std::regex("\ntrivet_queue_depth ([0-9]+)")));
    EXPECT_GT(std::stoi(waiting[1]), 0) << "others came before it, and still wait";
    for (std::thread& other : others) other.join();
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(Inference, SpeaksTheOpenInferenceProtocol) {
  // The scan as points, and the poses that the command line finds in them.
  const test::Outcome meshed =
      test::run_trivet({"mesh", depth_.string(), "--camera", "camera.json", "-o", "scan.ply"},
                       {.folder = folder_.path(), .environment = {}, .watch = {}});
  ASSERT_EQ(meshed.exit_code, 0) << meshed.error;
  const Result<Cloud> scan = read_cloud(folder_ / "scan.ply");
  ASSERT_TRUE(scan);
  std::ofstream xyz(folder_ / "scan.xyz");
  std::string binary;
  nlohmann::json numbers = nlohmann::json::array();
  for (std::size_t i = 0; i < scan->points.size(); ++i) {
    const Eigen::Vector3f p = scan->points[i];
    xyz << fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    binary.append(reinterpret_cast<const char*>(p.data()), 12);
    numbers.push_back({p.x(), p.y(), p.z()});
  }
  xyz.close();
  const test::Outcome direct = test::run_trivet(
      {"recognize", "l.h5", "scan.xyz", "--method", "ppf", "--json", "-", "--viewpoint", "0,0,0"},
      {.folder = folder_.path(), .environment = {}, .watch = {}});
  ASSERT_EQ(direct.exit_code, 0) << direct.error;
  const nlohmann::json expected = nlohmann::json::parse(direct.out)["scenes"][0]["detections"];
  ASSERT_FALSE(expected.empty());
  const std::size_t n = scan->points.size(), m = expected.size();

  const test::Outcome outcome = serve({}, [&](int port) {
    EXPECT_EQ(ask(port, "GET", "/v2").json()["extensions"][0], "binary_tensor_data");
    EXPECT_EQ(ask(port, "GET", "/v2/models/l").json()["inputs"][0]["shape"][1], 3);
    EXPECT_EQ(ask(port, "GET", "/v2/models/l/versions/1/ready").status, 200);
    EXPECT_EQ(ask(port, "GET", "/v2/models/other").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v2/models/..%2f..%2fetc").status, 400);
    nlohmann::json request{
        {"id", "7"},
        {"parameters", {{"method", "ppf"}}},
        {"inputs",
         {{{"name", "points"}, {"datatype", "FP32"}, {"shape", {n, 3}}, {"data", numbers}},
          {{"name", "viewpoint"}, {"datatype", "FP32"}, {"shape", {3}}, {"data", {0, 0, 0}}}}}};
    const Answer plain = ask(port, "POST", "/v2/models/l/infer", request.dump());
    ASSERT_EQ(plain.status, 200) << plain.body;
    const nlohmann::json outputs = plain.json()["outputs"];
    EXPECT_EQ(plain.json()["id"], "7");
    ASSERT_EQ(outputs[0]["shape"], nlohmann::json({m, 4, 4}));
    for (std::size_t d = 0; d < m; ++d) {
      EXPECT_EQ(outputs[1]["data"][d], expected[d]["score"]);
      EXPECT_EQ(outputs[2]["data"][d], expected[d]["model"]);
      for (std::size_t k = 0; k < 16; ++k)
        EXPECT_EQ(outputs[0]["data"][16 * d + k], expected[d]["T_scene_model"][k / 4][k % 4]);
    }

    request["inputs"][0].erase("data");
    request["inputs"][0]["parameters"]["binary_data_size"] = binary.size();
    request["parameters"]["binary_data_output"] = true;
    const std::string header = request.dump();
    const std::string length =
        "Inference-Header-Content-Length: " + std::to_string(header.size()) + "\r\n";
    const Answer packed = ask(port, "POST", "/v2/models/l/infer", header + binary, length);
    ASSERT_EQ(packed.status, 200) << packed.body;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(packed.head, found,
                                  std::regex("Inference-Header-Content-Length: ([0-9]+)")));
    const std::size_t size = std::stoul(found[1]);
    EXPECT_EQ(nlohmann::json::parse(
                  packed.body.substr(0, size))["outputs"][0]["parameters"]["binary_data_size"],
              64 * m);
    std::vector<float> poses(16 * m);
    std::memcpy(poses.data(), packed.body.data() + size, 64 * m);
    for (std::size_t k = 0; k < poses.size(); ++k)
      EXPECT_EQ(poses[k], outputs[0]["data"][k].get<float>());

    const auto refuses = [&](const std::string& body, const std::string& reason,
                             const std::string& headers = "") {
      const Answer answer = ask(port, "POST", "/v2/models/l/infer", body, headers);
      EXPECT_EQ(answer.status, 400) << answer.body;
      EXPECT_NE(answer.body.find(reason), std::string::npos) << answer.body;
    };
    refuses("", "no JSON");
    refuses(std::string(100'000, '['), "32 levels");
    refuses(R"({"inputs":[{"name":"points","datatype":"FP32","shape":[4,3],"data":[1,2]}]})",
            "12 numbers");
    refuses(R"({"inputs":[{"name":"points","datatype":"FP64","shape":[0,3],"data":[]}]})", "FP32");
    refuses(R"({"inputs":[],"parameters":{"expected":"/etc/passwd"}})", "expected");
    refuses(header + binary.substr(12), "at most", length);
    refuses(header + binary + "x", "belong to no tensor", length);
    refuses(header, "Content-Length", "Inference-Header-Content-Length: 99999999\r\n");
    refuses(header, "Content-Length", "Inference-Header-Content-Length: many\r\n");
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet
