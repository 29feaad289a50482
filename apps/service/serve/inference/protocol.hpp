/// The Open Inference Protocol, version 2, over HTTP, with its binary tensors.
///
/// Source: https://kserve.github.io/website, "Open Inference Protocol (V2)", and of Triton's
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
  bool is_binary = false;  ///< behind the JSON
};

/// An inference as it was asked for.
struct InferenceRequest {
  std::string id;
  Points points;                             ///< input "points", FP32 [N, 3]
  std::optional<Eigen::Vector3f> viewpoint;  ///< input "viewpoint", FP32 [3]
  Parameters options;                    ///< parameters of the request, for parse_recognize_query
  std::vector<RequestedOutput> outputs;  ///< in the order of the answer
  std::chrono::microseconds timeout{0};  ///< parameter of the request; 0: none
};

/// header_size  of the JSON at the front of the body; none: all of it
/// Errors: bad_data (names the path of the fault, what was expected and found).
Result<InferenceRequest> parse_inference(std::string_view body,
                                         std::optional<std::size_t> header_size);

/// The timeout of a request, before anything else of it is looked at; 0 also where the JSON is
/// faulty, which parse_inference tells.
std::chrono::microseconds inference_timeout(std::string_view json);

/// The finite points, which the request then has no more.
Cloud take_cloud(InferenceRequest& request);

struct InferenceResponse {
  std::string body;
  std::size_t header_size = 0;  ///< of the JSON in front; that of the body without binary tensors
};

/// The requested outputs, of M detections: see inference_tensors.
InferenceResponse write_inference(const InferenceRequest& request, const SceneResult& result,
                                  const std::string& model, std::uint64_t version);

}  // namespace trivet::apps::service
