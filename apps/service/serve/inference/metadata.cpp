#include "apps/service/serve/inference/metadata.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr InferenceTensor kTensors[]{
    {"points", "FP32", {-1, 3}, 2, true, false},    {"viewpoint", "FP32", {3}, 1, true, true},
    {"poses", "FP32", {-1, 4, 4}, 3, false, false}, {"scores", "FP32", {-1}, 1, false, false},
    {"models", "BYTES", {-1}, 1, false, false},
};

Json shape_of(const InferenceTensor& tensor) {
  Json shape = Json::array();
  for (std::size_t i = 0; i < tensor.rank; ++i) shape.push_back(tensor.shape[i]);
  return shape;
}

template <class Describe>
Json list_of(bool inputs, Describe describe) {
  Json list = Json::array();
  for (const InferenceTensor& tensor : kTensors) {
    if (tensor.is_input == inputs) list.push_back(describe(tensor));
  }
  return list;
}

Json metadata_of(const InferenceTensor& tensor) {
  return {{"name", tensor.name}, {"datatype", tensor.datatype}, {"shape", shape_of(tensor)}};
}

Json configuration_of(const InferenceTensor& tensor) {
  const bool is_text = tensor.datatype == "BYTES";
  Json json{{"name", tensor.name},
            {"data_type", is_text ? "TYPE_STRING" : "TYPE_" + std::string(tensor.datatype)},
            {"dims", shape_of(tensor)}};
  if (tensor.is_optional) json["optional"] = true;
  return json;
}

}  // namespace

std::span<const InferenceTensor> inference_tensors() { return kTensors; }

Json inference_metadata(const std::string& model, std::uint64_t version) {
  return {{"name", model},
          {"versions", Json::array({std::to_string(version)})},
          {"platform", "trivet"},
          {"inputs", list_of(true, metadata_of)},
          {"outputs", list_of(false, metadata_of)}};
}

Json inference_configuration(const std::string& model) {
  return {{"name", model},
          {"platform", "trivet"},
          {"backend", "trivet"},
          {"version_policy", {{"latest", {{"num_versions", 1}}}}},
          {"max_batch_size", 0},
          {"input", list_of(true, configuration_of)},
          {"output", list_of(false, configuration_of)}};
}

Json repository_index(const std::string& model, std::uint64_t version, bool is_ready,
                      bool only_ready) {
  Json index = Json::array();
  if (is_ready || !only_ready) {
    index.push_back({{"name", model},
                     {"version", std::to_string(version)},
                     {"state", is_ready ? "READY" : "UNAVAILABLE"},
                     {"reason", is_ready ? "" : "the service ends"}});
  }
  return index;
}

}  // namespace trivet::apps::service
