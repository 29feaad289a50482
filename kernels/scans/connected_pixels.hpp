/// Pixels of an image that are connected over their sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/common/stop.hpp"

namespace trivet::kernels {

/// Grows connected sets of pixels; keeps its memory from set to set.
class ConnectedPixels {
 public:
  /// width, count  of the image's rows and of all its pixels
  ConnectedPixels(std::size_t width, std::size_t count) : width_(width), count_(count) {}

  /// Call `body(pixel)` for each pixel that is connected to `first` by pixels that `take` accepts.
  ///
  /// take  whether a pixel belongs to the set and was not taken before; it is asked repeatedly, and
  ///       has to remember what it took
  template <class Take, class Body>
  void grow(std::size_t first, const Take& take, const Body& body) {
    const auto visit = [&](std::size_t pixel) {
      if (take(pixel)) open_.push_back(static_cast<std::uint32_t>(pixel));
    };
    visit(first);
    while (!open_.empty()) {
      check_stop_();
      const std::size_t pixel = open_.back(), column = pixel % width_;
      open_.pop_back();
      body(pixel);
      if (column > 0) visit(pixel - 1);
      if (column + 1 < width_) visit(pixel + 1);
      if (pixel >= width_) visit(pixel - width_);
      if (pixel + width_ < count_) visit(pixel + width_);
    }
  }

 private:
  std::size_t width_, count_;
  std::vector<std::uint32_t> open_;
  StopCheck check_stop_{1 << 16};
};

}  // namespace trivet::kernels
