/// Query over finished poses: why models are found at a place of the scene, or not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/results/explanation.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/verify_poses.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Outcome of a model's poses at the place.
struct ExplainedModel {
  std::uint32_t model = 0;
  /// Number of poses there that reached each stage.
  std::array<std::size_t, kNumPoseStages> num_poses{};
  /// The detection there, or else the best of the poses with the latest stage.
  std::optional<Row> pose{};
  /// Discarded before its full test, which was made for the explanation alone.
  bool given_up = false;
  std::vector<kernels::JudgedRay> rays{};  ///< rays of that pose's test
};

/// Explain the requested models, or else the models of all poses near the place.
///
/// question     question with its point in the cloud's frame and unit
/// least_score  minimum score by samples at which a refined pose is worth the full test
/// table        finished poses; receives a row for each pose tested for the explanation
/// Returns the models by the latest stage reached, then by score. Errors: internal (no memory for
/// ray tracing), damaged.
Result<std::vector<ExplainedModel>> explain_place(const Library& library,
                                                  const PreparedScene& scene,
                                                  const PlaceQuestion& question, float least_score,
                                                  const PoseVerifier& verifier, PoseTable& table);

}  // namespace trivet::engine
