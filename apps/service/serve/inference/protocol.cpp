#include "apps/service/serve/inference/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "apps/service/http/json_parameters.hpp"
#include "apps/service/serve/inference/metadata.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "tensors are little-endian");

constexpr int kMaxPoints = 100'000'000;
constexpr std::chrono::hours kMaxTimeout{1};
constexpr std::size_t kMaxJsonBytes = 16 << 20;  ///< parsing takes up to 20 times the memory

/// Bytes after the header that no tensor has used yet.
struct Rest {
  std::string_view bytes;

  std::string_view read_bytes(std::size_t n, const JsonNode& node) {
    if (n > bytes.size())
      node.refuse(fmt::format("expected at most {} bytes behind the header", bytes.size()));
    const std::string_view front = bytes.substr(0, n);
    bytes.remove_prefix(n);
    return front;
  }
};

/// Fails on unknown members of an object, which would otherwise be ignored silently.
void expect_members(const JsonNode& object, std::string_view expected) {
  for (const auto& [name, value] : object.members()) {
    if (name != expected)
      object.at(name).refuse(fmt::format("expected no parameter here but {}", expected));
  }
}

/// Reads an FP32 tensor with this many numbers.
std::vector<float> read_numbers(const JsonNode& input, std::size_t count, Rest& rest) {
  if (input.at("datatype").string() != "FP32") input.at("datatype").refuse("expected FP32");
  std::vector<float> numbers;
  if (input.has("parameters")) expect_members(input.at("parameters"), "binary_data_size");
  const bool is_binary = input.has("parameters") && input.at("parameters").has("binary_data_size");
  if (is_binary) {
    const JsonNode size = input.at("parameters").at("binary_data_size");
    if (size.number() != static_cast<double>(4 * count))
      size.refuse(fmt::format("expected {} bytes, as the shape says", 4 * count));
    const std::string_view bytes = rest.read_bytes(4 * count, size);
    numbers.resize(count);
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
  }
  for (const double number : input.at("data").flat_numbers())
    numbers.push_back(static_cast<float>(number));
  if (numbers.size() != count)
    input.at("data").refuse(fmt::format("expected {} numbers, as the shape says", count));
  return numbers;
}

void read_input(const JsonNode& input, InferenceRequest& request, Rest& rest) {
  const std::string name = input.at("name").string();
  const std::vector<JsonNode> shape = input.at("shape").elements();
  if (name == "viewpoint") {
    if (shape.size() != 1 || shape[0].integer(3, 3) != 3) input.at("shape").refuse("expected [3]");
    const std::vector<float> v = read_numbers(input, 3, rest);
    request.viewpoint = Eigen::Vector3f(v[0], v[1], v[2]);
    return;
  }
  if (name != "points") input.at("name").refuse("expected points or viewpoint");
  if (shape.size() != 2) input.at("shape").refuse("expected [N, 3]");
  const auto n = static_cast<std::size_t>(shape[0].integer(0, kMaxPoints));
  (void)shape[1].integer(3, 3);
  const std::vector<float> numbers = read_numbers(input, 3 * n, rest);
  request.points = Points();
  for (std::size_t i = 0; i < n; ++i)
    request.points.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
}

std::uint64_t read_unsigned(const JsonNode& node, std::uint64_t high) {
  const nlohmann::json& value = node.value();
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > high)
    node.refuse(fmt::format("expected a whole number from 0 to {}", high));
  return value.get<std::uint64_t>();
}

std::chrono::microseconds read_timeout(const JsonNode& parameters) {
  if (!parameters.has("timeout")) return {};
  const std::uint64_t high = std::chrono::microseconds(kMaxTimeout).count();
  return std::chrono::microseconds(read_unsigned(parameters.at("timeout"), high));
}

/// Reads parameters that control scheduling. The rest are options of the recognition.
void read_parameters(const JsonNode& parameters, InferenceRequest& request, bool& all_binary) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  request.options = parameters_of(parameters, {"binary_data_output", "timeout", "priority",
                                               "sequence_id", "sequence_start", "sequence_end"});
  request.timeout = read_timeout(parameters);
  const auto boolean = [&](const char* name) {
    return parameters.has(name) && parameters.at(name).boolean();
  };
  all_binary = boolean("binary_data_output");
  // Requests are independent, so a sequence of them is treated as single requests; all wait in the
  // order of their arrival.
  (void)boolean("sequence_start");
  (void)boolean("sequence_end");
  if (parameters.has("priority")) (void)read_unsigned(parameters.at("priority"), kAny);
  if (parameters.has("sequence_id") && !parameters.at("sequence_id").is_string())
    (void)read_unsigned(parameters.at("sequence_id"), kAny);
}

RequestedOutput read_output(const JsonNode& output, bool all_binary) {
  RequestedOutput out{output.at("name").string(), all_binary};
  if (!std::ranges::any_of(inference_tensors(), [&](const InferenceTensor& tensor) {
        return !tensor.is_input && tensor.name == out.name;
      })) {
    output.at("name").refuse("expected poses, scores or models");
  }
  if (!output.has("parameters")) return out;
  const JsonNode parameters = output.at("parameters");
  expect_members(parameters, "binary_data");
  if (parameters.has("binary_data")) out.is_binary = parameters.at("binary_data").boolean();
  return out;
}

void read_outputs(const JsonNode& root, InferenceRequest& request, bool all_binary) {
  if (root.has("outputs")) {
    std::set<std::string> names;
    for (const JsonNode& output : root.at("outputs").elements()) {
      request.outputs.push_back(read_output(output, all_binary));
      if (!names.insert(request.outputs.back().name).second)
        output.at("name").refuse("expected each output once");
    }
  }
  if (!request.outputs.empty()) return;
  for (const InferenceTensor& tensor : inference_tensors()) {
    if (!tensor.is_input) request.outputs.push_back({std::string(tensor.name), all_binary});
  }
}

void read_request(const JsonNode& root, InferenceRequest& request, Rest& rest) {
  if (root.has("id")) request.id = root.at("id").string();
  bool all_binary = false;
  if (root.has("parameters")) read_parameters(root.at("parameters"), request, all_binary);
  std::set<std::string> names;
  for (const JsonNode& input : root.at("inputs").elements()) {
    read_input(input, request, rest);
    if (!names.insert(input.at("name").string()).second)
      input.at("name").refuse("expected each input once");
  }
  if (!names.contains("points")) root.at("inputs").refuse("expected an input named points");
  read_outputs(root, request, all_binary);
}

/// The data of an output tensor, in both forms.
struct OutputData {
  Json shape, values = Json::array();
  std::string bytes{};
};

template <class Value>
void append(Value value, std::string& bytes) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

OutputData poses_of(std::span<const Detection> detections) {
  OutputData out{{detections.size(), 4, 4}};
  for (const Detection& detection : detections) {
    const Eigen::Matrix4f matrix = detection.T_scene_model.matrix();
    for (Eigen::Index row = 0; row < 4; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) {
        out.values.push_back(matrix(row, column));
        append(matrix(row, column), out.bytes);
      }
    }
  }
  return out;
}

OutputData scores_of(std::span<const Detection> detections) {
  OutputData out{Json::array({detections.size()})};
  for (const Detection& detection : detections) {
    out.values.push_back(detection.score);
    append(detection.score, out.bytes);
  }
  return out;
}

OutputData models_of(std::span<const Detection> detections) {
  OutputData out{Json::array({detections.size()})};
  for (const Detection& detection : detections) {
    out.values.push_back(detection.model);
    append(static_cast<std::uint32_t>(detection.model.size()), out.bytes);
    out.bytes += detection.model;
  }
  return out;
}

OutputData output_of(std::string_view name, std::span<const Detection> detections) {
  if (name == "poses") return poses_of(detections);
  return name == "scores" ? scores_of(detections) : models_of(detections);
}

}  // namespace

std::chrono::microseconds inference_timeout(std::string_view json) {
  std::chrono::microseconds timeout{0};
  (void)with_json(std::as_bytes(std::span(json)), "request", [&](const JsonNode& root) {
    if (root.has("parameters")) timeout = read_timeout(root.at("parameters"));
  });
  return timeout;
}

Result<InferenceRequest> parse_inference(std::string_view body,
                                         std::optional<std::size_t> header_size) {
  const std::size_t size = header_size.value_or(body.size());
  if (size > body.size()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("Inference-Header-Content-Length: expected at most the body's {} "
                             "bytes, found {}",
                             body.size(), size)};
  }
  if (size > kMaxJsonBytes) {
    return Error{ErrorCode::bad_data,
                 fmt::format("request: expected at most {} bytes of JSON, found {}; send larger "
                             "tensors as binary ones",
                             kMaxJsonBytes, size)};
  }
  InferenceRequest request;
  Rest rest{body.substr(size)};
  const std::string_view header = body.substr(0, size);
  const Result<void> done =
      with_json(std::as_bytes(std::span(header)), "request",
                [&](const JsonNode& root) { read_request(root, request, rest); });
  if (!done) return done.error();
  if (!rest.bytes.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("request: found {} bytes that belong to no tensor", rest.bytes.size())};
  }
  return request;
}

Cloud extract_cloud(InferenceRequest& request) {
  Cloud cloud;
  for (std::size_t i = 0; i < request.points.size(); ++i) {
    if (request.points[i].allFinite()) {
      cloud.points.push_back(request.points[i]);
    } else {
      ++cloud.num_invalid;
    }
  }
  request.points = Points();
  return cloud;
}

InferenceResponse write_inference(const InferenceRequest& request, const SceneResult& result,
                                  const std::string& model, std::uint64_t version) {
  Json outputs = Json::array();
  std::string bytes;
  for (const RequestedOutput& wanted : request.outputs) {
    OutputData data = output_of(wanted.name, result.detections);
    const InferenceTensor& tensor =
        *std::ranges::find(inference_tensors(), wanted.name, &InferenceTensor::name);
    Json output{
        {"name", wanted.name}, {"datatype", tensor.datatype}, {"shape", std::move(data.shape)}};
    if (wanted.is_binary) {
      output["parameters"] = {{"binary_data_size", data.bytes.size()}};
      bytes += data.bytes;
    } else {
      output["data"] = std::move(data.values);
    }
    outputs.push_back(std::move(output));
  }
  Json json{{"model_name", model}, {"model_version", std::to_string(version)}};
  if (!request.id.empty()) json["id"] = request.id;
  json["outputs"] = std::move(outputs);
  // Models are named after files, whose names need not be UTF-8.
  InferenceResponse response{json_text(json), 0};
  response.header_size = response.body.size();
  response.body += bytes;
  return response;
}

}  // namespace trivet::apps::service
