#include "engine/recognition/leave_out.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace trivet::engine {

RecognizeOptions leave_out(RecognizeOptions options) {
  constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();
  const auto without = [&](Improvement improvement) {
    return options.without.contains(improvement);
  };
  if (without(Improvement::clusters)) {
    options.max_instances = 1;
    options.pose.cluster_translation = 0.1F;
    options.pose.cluster_rotation_deg = 12;
  }
  for (VoteOptions* vote : {&options.vote, &options.later}) {
    if (without(Improvement::ball)) vote->radius = 1;
    if (without(Improvement::full_cells)) vote->max_votes = kAll;
    if (without(Improvement::references)) vote->reference_share = 0.2F;
  }
  if (without(Improvement::normals)) options.normal_window = 2;
  if (without(Improvement::second_round)) options.pose.rounds = std::min(options.pose.rounds, 1U);
  // The contour lowers the score of what is seen: where that is not asked for, there is none.
  if (without(Improvement::visibility)) options.without.insert(Improvement::contour);
  if (without(Improvement::rays)) options.without.insert(Improvement::rivals);  // compared by rays
  return options;
}

}  // namespace trivet::engine
