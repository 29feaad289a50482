/// Marks which pose explains each pixel of a scene.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/range_image.hpp"
#include "kernels/verification/examine_pose.hpp"

namespace trivet::engine {

/// How much of a pose is already explained.
struct Cover {
  float share = 0;            ///< share of its pixels explained by all chosen poses
  std::uint32_t most_by = 0;  ///< pose that explains most of them; valid if share > 0
  float most_share = 0;
};

/// The pixels of all images, each marked with the index of the chosen pose that explained it first.
class PixelMarks {
 public:
  /// images  kept by reference
  PixelMarks(std::span<const kernels::RangeImage> images, std::size_t num_poses);

  /// If several poses explain the same number, the one that comes first in `pixels` counts.
  Cover cover_of(const kernels::ExplainedPixels& explained);
  void mark(std::uint32_t pose, const kernels::ExplainedPixels& explained);

  /// One value per pixel: 1 if a pose with holds(index) explains it.
  template <class Holds>
  std::vector<std::uint8_t> marked(Holds&& holds) const {
    std::vector<std::uint8_t> out(marks_.size());
    std::ranges::transform(marks_, out.begin(), [&](std::uint32_t by) {
      return static_cast<std::uint8_t>(by != 0 && holds(by - 1) ? 1 : 0);
    });
    return out;
  }

 private:
  std::span<const kernels::RangeImage> images_;
  std::vector<std::size_t> first_;     // first pixel of each image
  std::vector<std::uint32_t> marks_;   // index of the pose + 1; 0: unmarked
  std::vector<std::uint32_t> counts_;  // count per mark; 0 between calls
};

}  // namespace trivet::engine
