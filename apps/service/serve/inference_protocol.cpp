#include "apps/service/serve/inference_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>
#include <span>

#include "apps/service/serve/json_parameters.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "tensors are little-endian");

constexpr int kMaxPoints = 100'000'000;
constexpr std::size_t kMaxJsonBytes = 16 << 20;  ///< a parsed document takes up to 20 times as much

/// Bytes after the header that no tensor has taken yet.
struct Rest {
  std::string_view bytes;

  std::string_view take(std::size_t n, const JsonNode& node) {
    if (n > bytes.size())
      node.refuse(fmt::format("expected at most {} bytes behind the header", bytes.size()));
    const std::string_view taken = bytes.substr(0, n);
    bytes.remove_prefix(n);
    return taken;
  }
};

/// The numbers of an FP32 tensor of this many.
std::vector<float> read_numbers(const JsonNode& input, std::size_t count, Rest& rest) {
  if (input.at("datatype").string() != "FP32") input.at("datatype").refuse("expected FP32");
  std::vector<float> numbers;
  const bool is_binary = input.has("parameters") && input.at("parameters").has("binary_data_size");
  if (is_binary) {
    const JsonNode size = input.at("parameters").at("binary_data_size");
    if (size.number() != static_cast<double>(4 * count))
      size.refuse(fmt::format("expected {} bytes, as the shape says", 4 * count));
    const std::string_view bytes = rest.take(4 * count, size);
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

void read_request(const JsonNode& root, InferenceRequest& request, Rest& rest) {
  if (root.has("id")) request.id = root.at("id").string();
  if (root.has("parameters")) {
    constexpr std::string_view kBinary = "binary_data_output";
    const JsonNode parameters = root.at("parameters");
    request.options = parameters_of(parameters, kBinary);
    if (parameters.has(kBinary)) request.all_binary = parameters.at(kBinary).boolean();
  }
  std::set<std::string> names;
  for (const JsonNode& input : root.at("inputs").elements()) {
    read_input(input, request, rest);
    if (!names.insert(input.at("name").string()).second)
      input.at("name").refuse("expected each input once");
  }
  if (!names.contains("points")) root.at("inputs").refuse("expected an input named points");
  if (!root.has("outputs")) return;
  for (const JsonNode& output : root.at("outputs").elements()) {
    if (output.has("parameters") && output.at("parameters").has("binary_data") &&
        output.at("parameters").at("binary_data").boolean()) {
      request.binary_outputs.push_back(output.at("name").string());
    }
  }
}

/// One output: its description, and its bytes where it is binary.
class OutputWriter {
 public:
  explicit OutputWriter(const InferenceRequest& request) : request_(request) {}

  void add(const std::string& name, const char* datatype, Json shape, Json data,
           const std::string& bytes) {
    Json output{{"name", name}, {"datatype", datatype}, {"shape", std::move(shape)}};
    const bool is_binary =
        request_.all_binary ||
        std::ranges::find(request_.binary_outputs, name) != request_.binary_outputs.end();
    if (is_binary) {
      output["parameters"] = {{"binary_data_size", bytes.size()}};
      bytes_ += bytes;
    } else {
      output["data"] = std::move(data);
    }
    outputs_.push_back(std::move(output));
  }
  Json take_outputs() { return std::move(outputs_); }
  const std::string& bytes() const { return bytes_; }

 private:
  const InferenceRequest& request_;
  Json outputs_ = Json::array();
  std::string bytes_;
};

template <class Value>
void append(Value value, std::string& bytes) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

}  // namespace

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

Cloud take_cloud(InferenceRequest& request) {
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
  const std::size_t n = result.detections.size();
  Json poses = Json::array(), scores = Json::array(), models = Json::array();
  std::string pose_bytes, score_bytes, model_bytes;
  for (const Detection& detection : result.detections) {
    const Eigen::Matrix4f matrix = detection.T_scene_model.matrix();
    for (Eigen::Index row = 0; row < 4; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) {
        poses.push_back(matrix(row, column));
        append(matrix(row, column), pose_bytes);
      }
    }
    scores.push_back(detection.score);
    append(detection.score, score_bytes);
    models.push_back(detection.model);
    append(static_cast<std::uint32_t>(detection.model.size()), model_bytes);
    model_bytes += detection.model;
  }
  OutputWriter outputs(request);
  outputs.add("poses", "FP32", {n, 4, 4}, std::move(poses), pose_bytes);
  outputs.add("scores", "FP32", {n}, std::move(scores), score_bytes);
  outputs.add("models", "BYTES", {n}, std::move(models), model_bytes);
  Json json{{"model_name", model}, {"model_version", std::to_string(version)}};
  if (!request.id.empty()) json["id"] = request.id;
  json["outputs"] = outputs.take_outputs();
  // Models are named by files, which need not be UTF-8.
  InferenceResponse response{json.dump(-1, ' ', false, Json::error_handler_t::replace), 0};
  response.header_size = response.body.size();
  response.body += outputs.bytes();
  return response;
}

Json inference_metadata(const std::string& model, std::uint64_t version) {
  const auto tensor = [](const char* name, const char* datatype, Json shape) {
    return Json{{"name", name}, {"datatype", datatype}, {"shape", std::move(shape)}};
  };
  return {{"name", model},
          {"versions", Json::array({std::to_string(version)})},
          {"platform", "trivet"},
          {"inputs", Json::array({tensor("points", "FP32", {-1, 3}),
                                  tensor("viewpoint", "FP32", Json::array({3}))})},
          {"outputs", Json::array({tensor("poses", "FP32", {-1, 4, 4}),
                                   tensor("scores", "FP32", Json::array({-1})),
                                   tensor("models", "BYTES", Json::array({-1}))})}};
}

}  // namespace trivet::apps::service
