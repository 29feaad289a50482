/// What the inference protocol tells of the library, which it calls a model.
///
/// Source: https://kserve.github.io/website, "Open Inference Protocol (V2)", and of Triton's
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
  std::array<int, 3> shape;  ///< -1: any number; M of the outputs is that of the detections
  std::size_t rank;          ///< of the shape
  bool is_input;
  bool is_optional;
};

/// Inputs "points" [N, 3] and, if it is known, "viewpoint" [3]; outputs "poses" [M, 4, 4], model
/// point to scene point, "scores" [M] and "models" [M].
std::span<const InferenceTensor> inference_tensors();

/// Names, datatypes and shapes.
nlohmann::ordered_json inference_metadata(const std::string& model, std::uint64_t version);

/// The same as Triton's configuration of a model has it.
nlohmann::ordered_json inference_configuration(const std::string& model);

/// What a repository of one model holds.
nlohmann::ordered_json repository_index(const std::string& model, std::uint64_t version,
                                        bool is_ready, bool only_ready);

}  // namespace trivet::apps::service
