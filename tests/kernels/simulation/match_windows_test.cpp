#include "kernels/simulation/match_windows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "kernels/common/counter_random.hpp"
#include "support/allocations.hpp"

namespace trivet::kernels {
namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;

/// A dot pattern, each dot with the disparity that it sees; 0 where it sees none.
std::vector<float> pattern(const std::function<double(int, int)>& disparity, double share,
                           double noise = 0, std::uint64_t seed = 1) {
  std::vector<float> dots(kWidth * kHeight, kNoDot);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    CounterRandom random(seed, 0, i);
    if (random.uniform() >= share) continue;
    const double visible = disparity(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth));
    dots[i] = visible > 0 ? static_cast<float>(visible + noise * random.normal()) : kHiddenDot;
  }
  return dots;
}

std::vector<float> match(const std::vector<float>& dots, const WindowMatching& options) {
  std::vector<float> out(dots.size());
  match_windows(dots, kWidth, 0, options, out);
  return out;
}

/// The match from the definition: all pixels of the window within the image, in double.
double reference_match(const std::vector<float>& dots, int u, int v, const WindowMatching& o) {
  struct Dot {
    double disparity, weight;
  };
  std::vector<Dot> visible;
  double all = 0, sum = 0;
  const int half = static_cast<int>(o.half_window);
  for (int y = v - half; y <= v + half; ++y) {
    for (int x = u - half; x <= u + half; ++x) {
      if (x < 0 || y < 0 || x >= int{kWidth} || y >= int{kHeight}) continue;
      const double dot = dots[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
      if (dot == 0) continue;
      const double weight =
          1 - static_cast<double>(o.taper) * (std::abs(x - u) + std::abs(y - v)) / (2.0 * half);
      all += weight;
      if (dot < 0) continue;
      visible.push_back({dot, weight});
      sum += dot;
    }
  }
  if (visible.empty()) return 0;
  std::vector<double> centers{sum / static_cast<double>(visible.size())};
  for (const Dot& dot : visible) centers.push_back(dot.disparity);
  double best_weight = 0, best_mean = 0;
  std::size_t best_count = 0;
  for (std::size_t c = 0; c < centers.size(); ++c) {
    double weight = 0, moment = 0;
    std::size_t count = 0;
    for (const Dot& dot : visible) {
      if (std::abs(dot.disparity - centers[c]) > static_cast<double>(o.reach_pixel)) continue;
      weight += dot.weight;
      moment += dot.weight * dot.disparity;
      ++count;
    }
    if (c == 0 && count < visible.size()) continue;  // the mean counts only where all agree with it
    if (weight > best_weight) {
      best_weight = weight;
      best_mean = moment / weight;
      best_count = count;
    }
    if (c == 0) break;
  }
  if (best_count < o.fewest_dots || best_weight < static_cast<double>(o.least_share) * all)
    return 0;
  return best_mean;
}

TEST(MatchWindows, AgreesWithReferenceOnNoisySteps) {
  const auto steps = [](int u, int v) {
    if (v > 40 && u > 30 && u < 40) return 0.0;  // not seen
    return u < 48 ? 20.0 : v < 20 ? 20.7 : 24.0;
  };
  // Weights are whole sixteenths, so that equal sums are also equal in float.
  for (const std::uint32_t half : {1U, 2U, 4U}) {
    const WindowMatching options{.half_window = half,
                                 .taper = 0.5F,
                                 .reach_pixel = 1,
                                 .fewest_dots = 2,
                                 .least_share = 0.375F};
    const std::vector<float> dots = pattern(steps, 0.12, 0.4), out = match(dots, options);
    std::size_t matched = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double expected = reference_match(dots, static_cast<int>(i % kWidth),
                                              static_cast<int>(i / kWidth), options);
      matched += expected > 0 ? 1 : 0;
      ASSERT_NEAR(out[i], expected, 1e-4) << "pixel " << i << " half window " << half;
    }
    EXPECT_GT(matched, half == 1 ? 100U : 4000U);
  }
}

TEST(MatchWindows, LeavesAFlatWallFlat) {
  const std::vector<float> out =
      match(pattern([](int, int) { return 17.25; }, 0.1), {.half_window = 4});
  for (const float d : out) EXPECT_TRUE(d == 0 || std::abs(d - 17.25F) < 1e-5F) << d;
  EXPECT_GT(std::count_if(out.begin(), out.end(), [](float d) { return d > 0; }), 6000);
}

// A bar of 30 columns, 12 pixels of disparity in front of a wall. The wall shows no dots for 12
// columns to the right of the bar, in the projector's shadow.
struct Edges {
  std::vector<double> lit, shadow;  // share of foreground at 1, 2, ... pixels beyond the bar
};
Edges beside_a_bar(const WindowMatching& options) {
  Edges edges{std::vector<double>(8), std::vector<double>(8)};
  double n = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto bar = [](int u, int) {
      return u >= 30 && u < 60 ? 40.0 : u >= 60 && u < 72 ? 0.0 : 28.0;
    };
    const std::vector<float> out = match(pattern(bar, 0.12, 0.1, seed), options);
    for (std::size_t v = 10; v < kHeight - 10; ++v) {
      n += 1;
      for (std::size_t d = 1; d <= 8; ++d) {
        edges.lit[d - 1] += out[v * kWidth + 30 - d] > 34 ? 1 : 0;
        edges.shadow[d - 1] += out[v * kWidth + 59 + d] > 34 ? 1 : 0;
      }
    }
  }
  for (double& share : edges.lit) share /= n;
  for (double& share : edges.shadow) share /= n;
  return edges;
}

TEST(MatchWindows, FattensOnTheShadowSideByHalfAWindow) {
  const Edges edges = beside_a_bar({.half_window = 4, .fewest_dots = 1});
  EXPECT_GT(edges.shadow[0], 0.9);
  EXPECT_GT(edges.shadow[2], 0.75);
  EXPECT_GT(edges.shadow[3], 0.5) << "the last column of the bar: 9 pixels, 1.1 dots";
  EXPECT_EQ(edges.shadow[4], 0) << "beyond half a window";
  EXPECT_LT(edges.lit[0], 0.5) << "the wall's dots are as many";
  EXPECT_LT(edges.lit[2], 0.15);
  for (std::size_t d = 0; d < 4; ++d) EXPECT_GT(edges.shadow[d], edges.lit[d] + 0.3);
}

TEST(MatchWindows, TurnsFatteningIntoHolesWhereMoreHaveToAgree) {
  const Edges loose = beside_a_bar({.half_window = 4}),
              strict = beside_a_bar({.half_window = 4, .least_share = 0.65F});
  EXPECT_LT(strict.shadow[1], 0.5 * loose.shadow[1]);
  EXPECT_LT(strict.shadow[3], 0.05);
}

// A square recess of L x L pixels in a face, shallower than the matching range: its depth is
// averaged over the window. Within half a window of the recess's border, the weight of the face is
// half at the border and zero in the middle. Over both sides and axes that is (h + 1/2) / L in all,
// 4.5 / L for a window of 9: about h (h + 1) / (2 h + 1) from each of two pairs of sides.
TEST(MatchWindows, FillsAShallowRecessByAboutHalfAWindowOverItsSide) {
  for (const int side : {20, 32}) {
    double sum = 0, n = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto recess = [&](int u, int v) {
        return std::abs(u - 48) < side / 2 && std::abs(v - 32) < side / 2 ? 19.5 : 20.0;
      };
      const std::vector<float> out =
          match(pattern(recess, 0.12, 0, seed), {.half_window = 4, .taper = 0});
      for (int v = 32 - side / 2 + 1; v < 32 + side / 2; ++v) {
        for (int u = 48 - side / 2 + 1; u < 48 + side / 2; ++u) {
          const float d = out[static_cast<std::size_t>(v) * kWidth + static_cast<std::size_t>(u)];
          if (d == 0) continue;
          sum += (d - 19.5) / 0.5;
          n += 1;
        }
      }
    }
    EXPECT_NEAR(sum / n, 4.5 / (side - 1), 0.25 * 4.5 / side) << side;
  }
}

TEST(MatchWindows, GivesTheSameBitsForAnyChunking) {
  const std::vector<float> dots =
      pattern([](int u, int) { return u < 40 ? 20.0 : 23.0; }, 0.1, 0.3);
  const WindowMatching options{.half_window = 3, .least_share = 0.3F};
  const std::vector<float> whole = match(dots, options);
  std::vector<float> parts(dots.size());
  for (std::uint32_t row = 0; row < kHeight;) {
    const std::uint32_t rows = std::min(kHeight - row, 1 + row % 7);
    match_windows(dots, kWidth, row, options,
                  std::span(parts).subspan(std::size_t{row} * kWidth, std::size_t{rows} * kWidth));
    row += rows;
  }
  EXPECT_EQ(std::memcmp(whole.data(), parts.data(), whole.size() * sizeof(float)), 0);
}

TEST(MatchWindows, AllocatesNothing) {
  const std::vector<float> dots = pattern([](int, int) { return 20.0; }, 0.1, 0.3);
  std::vector<float> out(dots.size());
  EXPECT_EQ(test::allocations_in([&] { match_windows(dots, kWidth, 0, {}, out); }), 0U);
}

TEST(MatchWindows, FindsNothingWithoutDots) {
  for (const float none : {kNoDot, kHiddenDot}) {
    const std::vector<float> out = match(std::vector<float>(kWidth * kHeight, none), {});
    EXPECT_EQ(std::count(out.begin(), out.end(), 0.0F), std::ptrdiff_t{kWidth * kHeight});
  }
}

}  // namespace
}  // namespace trivet::kernels
