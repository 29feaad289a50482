/// Matching of detections between two results.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/evaluation/pose_error.hpp"
#include "engine/results/recognize_result.hpp"

namespace trivet {

/// Limits within which two poses of one model match, if its surface is unknown.
struct PoseTolerance {
  double translation = 0;  ///< translation of the model's origin, in the scene's unit
  double rotation_deg = 12;
};

/// Indices of two matching detections.
struct DetectionMatch {
  std::size_t first = 0, second = 0;
  bool operator==(const DetectionMatch&) const = default;
};

/// Decides which poses match. Not thread-safe.
class PoseMatcher {
 public:
  /// Uses the limits of `evaluate`: a tenth of the diameter and 12 degrees, at best over the
  /// symmetries. Poses of models without a mesh never match.
  ///
  /// meshes  in the scenes' unit; they must outlive the matcher
  explicit PoseMatcher(std::span<const EvaluationMesh> meshes);
  /// Uses the same tolerance for every model; symmetries are unknown.
  explicit PoseMatcher(const PoseTolerance& tolerance) : tolerance_(tolerance) {}

  /// Match detections of one model with similar poses, the nearest ones first, each detection at
  /// most once. Pairs are in the order of `first`; exchanging the results exchanges the pairs.
  /// Cost: the product of both numbers.
  ///
  /// first, second  detections in the frame of one cloud
  std::vector<DetectionMatch> match(std::span<const Detection> first,
                                    std::span<const Detection> second) const;

 private:
  /// Sum of both errors relative to their limits; absent if the poses do not match.
  std::optional<double> distance(const Detection& first, const Detection& second) const;

  PoseTolerance tolerance_;
  std::map<std::string, engine::PoseJudge> judges_;
  bool has_meshes_ = false;
};

}  // namespace trivet
