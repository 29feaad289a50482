/// Metadata of the library, which the inference protocol calls a model.
///
/// Source: https://kserve.github.io/website, "Open Inference Protocol (V2)", and Triton's
/// extensions model_configuration and model_repository.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace trivet::apps::service {

struct InferenceTensor {
  std::string_view name, datatype;
  std::array<int, 3> shape;  ///< -1: any number; M of the outputs is the number of detections
  std::size_t rank;          ///< number of dimensions of the shape
  bool is_input;
  bool is_optional;
};

/// Inputs "points" [N, 3] and, if known, "viewpoint" [3]. Outputs "poses" [M, 4, 4], from model
/// point to scene point, "scores" [M] and "models" [M].
std::span<const InferenceTensor> inference_tensors();

/// Names, datatypes and shapes.
nlohmann::ordered_json inference_metadata(const std::string& model, std::uint64_t version);

/// The same data in the form of Triton's model configuration.
nlohmann::ordered_json inference_configuration(const std::string& model);

/// The index of a repository with this one model.
nlohmann::ordered_json repository_index(const std::string& model, std::uint64_t version,
                                        bool is_ready, bool only_ready);

}  // namespace trivet::apps::service
