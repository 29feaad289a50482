/// Which pose explains each pixel of a scene.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/range_image.hpp"
#include "kernels/verification/examine_pose.hpp"

namespace trivet::engine {

/// How much of a pose is explained already.
struct Cover {
  float share = 0;            ///< of its pixels, by all chosen poses
  std::uint32_t most_by = 0;  ///< the one that explains most of them; with a share above 0
  float most_share = 0;
};

/// The pixels of all images, marked with the index of the chosen pose that explained them first.
class PixelMarks {
 public:
  /// images  are referred to
  PixelMarks(std::span<const kernels::RangeImage> images, std::size_t num_poses);

  /// Of several that explain as much, the one that comes first in `pixels` counts.
  Cover cover_of(const kernels::ExplainedPixels& explained);
  void mark(std::uint32_t pose, const kernels::ExplainedPixels& explained);

  /// One a pixel: 1 where a pose explained it of which `holds(index)` is true.
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
  std::vector<std::size_t> first_;     // pixel of each image
  std::vector<std::uint32_t> marks_;   // index of the pose + 1; 0: none
  std::vector<std::uint32_t> counts_;  // by mark; 0 between calls
};

}  // namespace trivet::engine
