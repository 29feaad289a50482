/// What one scene may cost where a library is large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/options/recognize_options.hpp"
#include "engine/verification/pose_pool.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Work that does not grow with the library: matches first, since an index finds them among any
/// number of features; votes after them, on what no sure detection explains. Counts, never clocks.
struct SearchBudget {
  std::uint32_t num_neighbors = 10;  ///< features of models that each of a scene is matched with
  std::uint32_t num_lists = 8;       ///< of the index that each is looked for in
  /// Levels of features finer than these are left out: of the distance between measurements, and
  /// of their noise.
  float finest_spacing = 0.7F, finest_noise = 0.5F;
  PoseBudget poses{.looked_at = 30000, .refined = 1000, .examined = 200};  ///< of each pass
  std::uint32_t passes = 3;     ///< over what waits, in each round
  std::size_t look_alikes = 8;  ///< of a candidate, examined
  std::uint32_t climbs = 2;     ///< from a candidate to its look-alikes, to theirs, ..., in a pass
  std::size_t voted_models = 60;   ///< that the best poses are of which wait after the first round
  float reference_share = 0.1F;    ///< of the sampled points that are unexplained
  std::uint32_t max_votes = 8000;  ///< per reference point and model
};

/// Absent: every model is searched for on its own. So are those of small libraries, to which a
/// budget leaves nothing to choose.
std::optional<SearchBudget> budget_of(const RecognizeOptions& options, const Library& library,
                                      std::size_t num_models);

}  // namespace trivet::engine
