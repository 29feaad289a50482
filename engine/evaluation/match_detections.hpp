/// Which detections of two results are the same.
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

/// Below which two poses of one model are alike, where its surface is not known.
struct PoseTolerance {
  double translation = 0;  ///< of the model's origin, in the scene's unit
  double rotation_deg = 12;
};

/// Two detections, by their indices, that are alike.
struct DetectionMatch {
  std::size_t first = 0, second = 0;
  bool operator==(const DetectionMatch&) const = default;
};

/// Says which poses are alike. Not for use by two threads at once.
class PoseMatcher {
 public:
  /// As `evaluate` holds poses against the truth: a tenth of the diameter and 12 degrees,
  /// at best over the symmetries. Of models without a mesh no two poses are alike.
  ///
  /// meshes  in the scenes' unit; they outlive the matcher
  explicit PoseMatcher(std::span<const EvaluationMesh> meshes);
  /// The same for every model; symmetries are not known.
  explicit PoseMatcher(const PoseTolerance& tolerance) : tolerance_(tolerance) {}

  /// Detections of one model whose poses are alike, the nearest ones first, each detection at most
  /// once; in the order of `first`. Exchanging the results exchanges the pairs. Cost: the product of
  /// both numbers.
  ///
  /// first, second  detections in the frame of one cloud
  std::vector<DetectionMatch> match(std::span<const Detection> first,
                                    std::span<const Detection> second) const;

 private:
  /// Both errors as shares of their limits, added; none: not alike.
  std::optional<double> distance(const Detection& first, const Detection& second) const;

  PoseTolerance tolerance_;
  std::map<std::string, engine::PoseJudge> judges_;
  bool has_meshes_ = false;
};

}  // namespace trivet
