#include "kernels/simulation/match_windows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kMaxDots =
    std::size_t{2 * kMaxHalfWindow + 1} * std::size_t{2 * kMaxHalfWindow + 1};

/// The dots in a window.
struct Votes {
  std::array<float, kMaxDots> disparities, weights;
  std::size_t count = 0;
  float weight_of_all = 0;  // includes unseen dots
};

/// The dots of an image, row by row.
struct DotImage {
  std::span<const float> dots;
  int width, height;
};

void gather(const DotImage& image, int u, int v, const WindowMatching& options,
            Votes& votes) noexcept {
  const auto half = static_cast<int>(options.half_window);
  votes.count = 0;
  votes.weight_of_all = 0;
  const float loss = options.taper / static_cast<float>(2 * half);
  for (int y = std::max(0, v - half); y <= std::min(image.height - 1, v + half); ++y) {
    const float* row = image.dots.data() + static_cast<std::ptrdiff_t>(y) * image.width;
    for (int x = std::max(0, u - half); x <= std::min(image.width - 1, u + half); ++x) {
      const float dot = row[x];
      if (dot == kNoDot) continue;
      const float weight = 1 - loss * static_cast<float>(std::abs(x - u) + std::abs(y - v));
      votes.weight_of_all += weight;
      if (dot < 0) continue;
      votes.disparities[votes.count] = dot;
      votes.weights[votes.count] = weight;
      ++votes.count;
    }
  }
}

/// The dots that agree with a disparity.
struct Cluster {
  std::size_t count = 0;
  float weight = 0, sum = 0;
};

Cluster cluster_about(const Votes& votes, float disparity, float reach) noexcept {
  Cluster cluster;
  for (std::size_t k = 0; k < votes.count; ++k) {
    if (std::abs(votes.disparities[k] - disparity) > reach) continue;
    ++cluster.count;
    cluster.weight += votes.weights[k];
    cluster.sum += votes.weights[k] * votes.disparities[k];
  }
  return cluster;
}

Cluster winner(const Votes& votes, float reach) noexcept {
  float sum = 0;
  for (std::size_t k = 0; k < votes.count; ++k) sum += votes.disparities[k];
  // Far from edges all dots agree.
  Cluster best = cluster_about(votes, sum / static_cast<float>(votes.count), reach);
  if (best.count == votes.count) return best;
  best = {};
  for (std::size_t k = 0; k < votes.count; ++k) {
    const Cluster cluster = cluster_about(votes, votes.disparities[k], reach);
    if (cluster.weight > best.weight) best = cluster;
  }
  return best;
}

}  // namespace

void match_windows(std::span<const float> dots, std::uint32_t width, std::uint32_t first_row,
                   const WindowMatching& options, std::span<float> disparities) {
  TRIVET_REQUIRE(width > 0 && dots.size() % width == 0 && disparities.size() % width == 0,
                 "whole rows");
  TRIVET_REQUIRE(options.half_window >= 1 && options.half_window <= kMaxHalfWindow, "a window");
  const DotImage image{dots, static_cast<int>(width), static_cast<int>(dots.size() / width)};
  Votes votes;
  for (std::size_t i = 0; i < disparities.size(); ++i) {
    const auto u = static_cast<int>(i % width), v = static_cast<int>(first_row + i / width);
    disparities[i] = 0;
    gather(image, u, v, options, votes);
    if (votes.count < options.fewest_dots) continue;
    const Cluster cluster = winner(votes, options.reach_pixel);
    if (cluster.count < options.fewest_dots ||
        cluster.weight < options.least_share * votes.weight_of_all) {
      continue;
    }
    disparities[i] = cluster.sum / cluster.weight;
  }
}

}  // namespace trivet::kernels
