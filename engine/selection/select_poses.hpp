/// Choose the set of tested poses that together explain the scene.
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
  float min_score = 0.8F;                 ///< that detections are reported from, 0..1
  std::optional<float> doubtful_score{};  ///< from it to min_score they are chosen last
  std::uint32_t max_instances = 100;      ///< per model
  float max_overlap = 0.4F;               ///< share of a pose's pixels that may be explained
  bool by_pixels = true;                  ///< else copies are told by their poses alone
  bool operator==(const SelectOptions&) const = default;
};

/// A pose that was not chosen.
struct Refusal {
  Row row = 0;
  Rejection reason = Rejection::too_low;
  /// The better pose that explains most of its pixels, where better ones explain more than
  /// max_overlap of them; and what share of them that one explains.
  std::optional<Row> explained_by{};
  float explained_share = 0;
};

struct Selection {
  std::vector<Row> chosen;  ///< in the order of choice
  std::vector<std::uint8_t>
      explained;  ///< one a pixel over all images: 1 where a quite sure pose explains it
  std::vector<Refusal> refused;  ///< all others, from the best to the worst
};

/// What the selection is made of. All is referred to.
struct TestedPoses {
  const Library& library;
  const PreparedScene& scene;
  const PoseTable& table;
  std::span<const Row> rows;  ///< tested in full, in the order of their tests
};

/// Choose poses by falling rank (score times area^0.25: large surfaces prove more), each unless
/// better ones already explain more than max_overlap of its pixels: copies of one object fall out
/// whatever their symmetry, and of two objects claiming one place the better explained stays. Ties
/// go to the earlier row. Doubtful ones come after all others. By poses alone, the rank is the
/// score, and a pose falls out that repeats the placement of a better one of its model.
Selection select_poses(const TestedPoses& poses, const SelectOptions& options);

/// Choose those of the refused poses from min_score on that were hidden by one that does not stand
/// after all, unless what stands explains them, or a better one of them does.
///
/// standing  the rows that were chosen and stand; what was one too many does, too
/// refused   of all poses; loses what is chosen, and gets what hides the others now
/// Returns the rows of those chosen, in the order of choice.
std::vector<Row> choose_unexplained(const TestedPoses& poses, std::span<const Row> standing,
                                    const SelectOptions& options, std::vector<Refusal>& refused);

/// Of each model the best refused poses by score, at most `limit`; first of all those whose pixels
/// no better one of their own model explains, which may be further instances. Those that repeat the
/// placement of one taken, or of a detection or its alternatives, are left out.
///
/// detections  rows of the chosen poses as they are reported
/// Returns rows by falling score, ties in the order of refusal.
std::vector<Row> best_refused(const Library& library, const PoseTable& table,
                              std::span<const Refusal> refused, std::span<const Row> detections,
                              std::uint32_t limit);

}  // namespace trivet::engine
