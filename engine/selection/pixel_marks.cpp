#include "engine/selection/pixel_marks.hpp"

namespace trivet::engine {

PixelMarks::PixelMarks(std::span<const kernels::RangeImage> images, std::size_t num_poses)
    : images_(images), counts_(num_poses + 1, 0) {
  std::size_t n = 0;
  for (const kernels::RangeImage& image : images) {
    first_.push_back(n);
    n += std::size_t{image.geometry.width} * image.geometry.height;
  }
  marks_.assign(n, 0);
}

Cover PixelMarks::cover_of(const kernels::ExplainedPixels& explained) {
  std::uint32_t marked = 0, most = 0;
  Cover cover;
  for (const std::uint32_t pixel : explained.pixels) {
    const std::uint32_t by = marks_[pixel];
    if (by == 0) continue;
    ++marked;
    if (++counts_[by] > most) {
      most = counts_[by];
      cover.most_by = by - 1;
    }
  }
  for (const std::uint32_t pixel : explained.pixels) counts_[marks_[pixel]] = 0;
  if (marked == 0) return cover;
  const auto all = static_cast<float>(explained.pixels.size());
  cover.share = static_cast<float>(marked) / all;
  cover.most_share = static_cast<float>(most) / all;
  return cover;
}

void PixelMarks::mark(std::uint32_t pose, const kernels::ExplainedPixels& explained) {
  const auto side = static_cast<std::ptrdiff_t>(explained.square);
  const std::ptrdiff_t before = (side - 1) / 2, after = side / 2;
  for (const std::uint32_t pixel : explained.pixels) {
    const auto at = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), pixel) -
                                             first_.begin()) -
                    1;
    const auto local = static_cast<std::ptrdiff_t>(pixel - first_[at]);
    const auto width = static_cast<std::ptrdiff_t>(images_[at].geometry.width);
    const auto height = static_cast<std::ptrdiff_t>(images_[at].geometry.height);
    const std::ptrdiff_t u = local % width, v = local / width;
    for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, v - before);
         y <= std::min(height - 1, v + after); ++y) {
      for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, u - before);
           x <= std::min(width - 1, u + after); ++x) {
        std::uint32_t& by = marks_[first_[at] + static_cast<std::size_t>(y * width + x)];
        if (by == 0) by = pose + 1;
      }
    }
  }
}

}  // namespace trivet::engine
