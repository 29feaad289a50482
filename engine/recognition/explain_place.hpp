/// Why models are found at a place of the scene, or are not: a query over finished poses.
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

/// What became of a model's poses at the place that was asked about.
struct ExplainedModel {
  std::uint32_t model = 0;
  std::array<std::size_t, kNumPoseStages> num_poses{};  ///< that came to each stage there
  std::optional<Row> pose{};  ///< the detection there, else the best of those that came furthest
  bool given_up = false;      ///< before its full test, which was made for this alone
  std::vector<kernels::JudgedRay> rays{};  ///< of that pose
};

/// Explain the models that are asked about, or those of all poses that come near.
///
/// question     its point is in the cloud's frame and unit
/// least_score  of a refined pose by its samples that is worth the full test
/// table        of finished poses; gets a row for each that is tested after all
/// Returns what came furthest first, then by score. Errors: internal (no memory for ray tracing), bad_data (damaged).
Result<std::vector<ExplainedModel>> explain_place(const Library& library,
                                                  const PreparedScene& scene,
                                                  const PlaceQuestion& question, float least_score,
                                                  const PoseVerifier& verifier, PoseTable& table);

}  // namespace trivet::engine
