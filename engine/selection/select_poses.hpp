/// Selection of the set of tested poses that together explain the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/poses/pose_table.hpp"
#include "engine/results/rejected_pose.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

struct SelectOptions {
  float min_score = 0.8F;  ///< minimum score of reported detections, 0..1
  /// Minimum score of doubtful detections; those from it to min_score are chosen last.
  std::optional<float> doubtful_score{};
  std::uint32_t max_instances = 100;  ///< per model
  float max_overlap = 0.4F;  ///< maximum share of a pose's pixels explained by better poses
  bool by_pixels = true;     ///< whether pixels reveal duplicates; otherwise poses alone do
  bool operator==(const SelectOptions&) const = default;
};

/// A pose that was not chosen.
struct Refusal {
  Row row = 0;
  Rejection reason = Rejection::too_low;
  /// The better pose that explains most of its pixels, and the share that it explains. Present if
  /// better poses explain more than max_overlap of them.
  std::optional<Row> explained_by{};
  float explained_share = 0;
};

struct Selection {
  std::vector<Row> chosen;  ///< sorted in the order of choice
  std::vector<std::uint8_t>
      explained;  ///< one value per pixel over all images: 1 if a confident pose explains it
  std::vector<Refusal> refused;  ///< all other poses, from the best to the worst
};

/// Input of the selection, all by reference.
struct TestedPoses {
  const Library& library;
  const PreparedScene& scene;
  const PoseTable& table;
  std::span<const Row> rows;  ///< rows tested in full, in the order of their tests
};

/// Choose poses by falling rank (score times area^0.25, since large surfaces are stronger
/// evidence). A pose is chosen unless better ones already explain more than max_overlap of its
/// pixels. This removes duplicates of one object whatever its symmetry; of two objects claiming one
/// place, the better explained one remains. Ties go to the earlier row. Doubtful poses come after
/// all others. Without pixels, the rank is the score, and a pose is dropped if it repeats the
/// placement of a better one of its model.
Selection select_poses(const TestedPoses& poses, const SelectOptions& options);

/// Choose refused poses from min_score that were hidden by a pose that was itself refused later.
/// They are chosen unless a standing pose or a better one of them explains them.
///
/// standing  rows that were chosen and not refused later, and rows refused for max_instances
/// refused   refusals of all poses; chosen poses are removed, and the others receive the pose that
///           hides them now
/// Returns the rows of the chosen poses, in the order of choice.
std::vector<Row> choose_unexplained(const TestedPoses& poses, std::span<const Row> standing,
                                    const SelectOptions& options, std::vector<Refusal>& refused);

/// The best refused poses of each model by score, at most `limit`. Poses whose pixels no better
/// pose of their model explains come first, as they may be further instances. Poses that repeat the
/// placement of one already included, or of a detection or its alternatives, are left out.
///
/// detections  rows of the chosen poses as they are reported
/// Returns rows by falling score, ties in the order of refusal.
std::vector<Row> best_refused(const Library& library, const PoseTable& table,
                              std::span<const Refusal> refused, std::span<const Row> detections,
                              std::uint32_t limit);

}  // namespace trivet::engine
