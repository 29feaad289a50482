#include "kernels/simulation/filter_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {

void smooth_image(const ValueImage& in, std::uint32_t first_row, Along along, std::uint32_t radius,
                  float reach, std::span<float> out) noexcept {
  const auto width = static_cast<int>(in.width), height = static_cast<int>(in.height()),
             r = static_cast<int>(radius);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = std::size_t{first_row} * in.width + i;
    const float* center = in.values.data() + pixel;
    const auto u = static_cast<int>(pixel % in.width), v = static_cast<int>(pixel / in.width);
    const bool by_rows = along == Along::rows;
    const int place = by_rows ? u : v, size = by_rows ? width : height;
    const std::ptrdiff_t stride = by_rows ? 1 : width;
    out[i] = 0;
    if (*center == 0) continue;
    float sum = 0, count = 0;
    for (int k = std::max(-r, -place); k <= std::min(r, size - 1 - place); ++k) {
      const float value = center[k * stride];
      const bool near = value != 0 && std::abs(value - *center) <= reach;
      sum += near ? value : 0;
      count += near ? 1.0F : 0.0F;
    }
    out[i] = sum / count;
  }
}

void median_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t radius,
                  std::span<float> out) {
  TRIVET_REQUIRE(radius <= kMaxMedianRadius, "a small square");
  constexpr std::size_t kMaxSide = 2 * kMaxMedianRadius + 1;
  std::array<float, kMaxSide * kMaxSide> values;
  const auto width = static_cast<int>(in.width), height = static_cast<int>(in.height()),
             r = static_cast<int>(radius);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = std::size_t{first_row} * in.width + i;
    const auto u = static_cast<int>(pixel % in.width), v = static_cast<int>(pixel / in.width);
    out[i] = 0;
    if (in.values[pixel] == 0) continue;
    std::ptrdiff_t count = 0;
    for (int y = std::max(0, v - r); y <= std::min(height - 1, v + r); ++y) {
      for (int x = std::max(0, u - r); x <= std::min(width - 1, u + r); ++x) {
        const float value =
            in.values[static_cast<std::size_t>(y) * in.width + static_cast<std::size_t>(x)];
        if (value != 0) values[static_cast<std::size_t>(count++)] = value;
      }
    }
    const auto middle = values.begin() + (count - 1) / 2;
    std::nth_element(values.begin(), middle, values.begin() + count);
    out[i] = *middle;
  }
}

void fill_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t reach, Fill fill,
                std::span<float> out) noexcept {
  const auto width = static_cast<int>(in.width), height = static_cast<int>(in.height()),
             farthest = static_cast<int>(reach);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = std::size_t{first_row} * in.width + i;
    const auto u = static_cast<int>(pixel % in.width), v = static_cast<int>(pixel / in.width);
    const float* center = in.values.data() + pixel;
    out[i] = *center;
    if (*center != 0) continue;
    const auto search = [&](int room, std::ptrdiff_t stride) {
      for (int k = 1; k <= std::min(farthest, room); ++k) {
        const float value = center[k * stride];
        if (value == 0) continue;
        if (out[i] == 0 || (fill == Fill::least ? value < out[i] : value > out[i])) out[i] = value;
        return;
      }
    };
    search(u, -1);
    search(width - 1 - u, 1);
    search(v, -std::ptrdiff_t{width});
    search(height - 1 - v, width);
  }
}

void grow_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t radius,
                float least_jump, std::span<float> out) noexcept {
  const auto width = static_cast<int>(in.width), height = static_cast<int>(in.height()),
             r = static_cast<int>(radius);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = std::size_t{first_row} * in.width + i;
    const auto u = static_cast<int>(pixel % in.width), v = static_cast<int>(pixel / in.width);
    out[i] = in.values[pixel];
    if (out[i] == 0) continue;
    float greatest = 0;
    for (int y = std::max(0, v - r); y <= std::min(height - 1, v + r); ++y) {
      for (int x = std::max(0, u - r); x <= std::min(width - 1, u + r); ++x) {
        greatest = std::max(
            greatest,
            in.values[static_cast<std::size_t>(y) * in.width + static_cast<std::size_t>(x)]);
      }
    }
    if (greatest > out[i] + least_jump) out[i] = greatest;
  }
}

void coarsen_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t block,
                   std::span<float> out) noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t pixel = std::size_t{first_row} * in.width + i;
    const std::size_t u = pixel % in.width, v = pixel / in.width;
    out[i] = in.values[v / block * block * in.width + u / block * block];
  }
}

}  // namespace trivet::kernels
