/// The Open Inference Protocol, version 2, over HTTP, with its binary tensors.
///
/// Source: https://kserve.github.io/website, "Open Inference Protocol (V2)", and Triton's
/// extensions binary_tensor_data (a JSON header of Inference-Header-Content-Length bytes, then the
/// tensors one after the other, little-endian), schedule_policy and sequence.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/query.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"
#include "storage/data/points.hpp"

namespace trivet::apps::service {

struct RequestedOutput {
  std::string name;
  bool is_binary = false;  ///< stored after the JSON
};

/// A parsed inference request.
struct InferenceRequest {
  std::string id;
  Points points;                             ///< input "points", FP32 [N, 3]
  std::optional<Eigen::Vector3f> viewpoint;  ///< input "viewpoint", FP32 [3]
  Parameters options;                    ///< parameters of the request, for parse_recognize_query
  std::vector<RequestedOutput> outputs;  ///< requested outputs in the order of the response
  std::chrono::microseconds timeout{0};  ///< parameter of the request; 0: none
};

/// header_size  size of the JSON at the front of the body; none: the whole body
/// Errors: bad_data (names the path of the fault, what was expected and found).
Result<InferenceRequest> parse_inference(std::string_view body,
                                         std::optional<std::size_t> header_size);

/// The timeout of a request, read before the rest of it. Also 0 if the JSON is faulty, which
/// parse_inference reports.
std::chrono::microseconds inference_timeout(std::string_view json);

/// Moves the finite points out of the request.
Cloud extract_cloud(InferenceRequest& request);

struct InferenceResponse {
  std::string body;
  std::size_t header_size = 0;  ///< size of the JSON header, or of a body without binary tensors
};

/// The requested outputs for M detections: see inference_tensors.
InferenceResponse write_inference(const InferenceRequest& request, const SceneResult& result,
                                  const std::string& model, std::uint64_t version);

}  // namespace trivet::apps::service
