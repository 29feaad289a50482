/// The Open Inference Protocol, version 2, over HTTP, with its binary tensors.
///
/// Source: https://kserve.github.io/website, "Open Inference Protocol (V2)", and its extension
/// binary_tensor_data: a JSON header of Inference-Header-Content-Length bytes, then the tensors one
/// after the other, little-endian.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/query.hpp"
#include "engine/recognize.hpp"
#include "storage/points.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

/// An inference as it was asked for.
struct InferenceRequest {
  std::string id;
  Points points;                             ///< input "points", FP32 [N, 3]
  std::optional<Eigen::Vector3f> viewpoint;  ///< input "viewpoint", FP32 [3]
  Parameters options;  ///< parameters of the request, for parse_recognize_query
  std::vector<std::string> binary_outputs;  ///< outputs that are to be binary
  bool all_binary = false;
};

/// header_size  of the JSON at the front of the body; none: all of it
/// Errors: bad_data (names the path of the fault, what was expected and found).
Result<InferenceRequest> parse_inference(std::string_view body,
                                         std::optional<std::size_t> header_size);

/// The finite points, which the request then has no more.
Cloud take_cloud(InferenceRequest& request);

struct InferenceResponse {
  std::string body;
  std::size_t header_size = 0;  ///< of the JSON in front; that of the body without binary tensors
};

/// Outputs of M detections: "poses" FP32 [M, 4, 4], model point to scene point, "scores" FP32 [M],
/// "models" BYTES [M].
InferenceResponse write_inference(const InferenceRequest& request, const SceneResult& result,
                                  const std::string& model, std::uint64_t version);

/// What a client may send and gets.
nlohmann::ordered_json inference_metadata(const std::string& model, std::uint64_t version);

}  // namespace trivet::apps::service
