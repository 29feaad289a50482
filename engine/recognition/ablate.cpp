#include "engine/recognition/ablate.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace trivet::engine {

RecognizeOptions ablate(RecognizeOptions options) {
  constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();
  const auto is_ablated = [&](Improvement improvement) {
    return options.ablated.contains(improvement);
  };
  if (is_ablated(Improvement::clusters)) {
    options.max_instances = 1;
    options.pose.cluster_translation = 0.1F;
    options.pose.cluster_rotation_deg = 12;
  }
  for (VoteOptions* vote : {&options.vote, &options.later}) {
    if (is_ablated(Improvement::ball)) vote->radius = 1;
    if (is_ablated(Improvement::full_cells)) vote->max_votes = kAll;
    if (is_ablated(Improvement::references)) vote->reference_share = 0.2F;
  }
  if (is_ablated(Improvement::normals)) options.normal_window = 2;
  if (is_ablated(Improvement::second_round))
    options.pose.rounds = std::min(options.pose.rounds, 1U);
  // The contour lowers the score of what is seen: where that is not asked for, there is none.
  if (is_ablated(Improvement::visibility)) options.ablated.insert(Improvement::contour);
  if (is_ablated(Improvement::rays))
    options.ablated.insert(Improvement::alternatives);  // compared by rays
  return options;
}

}  // namespace trivet::engine
