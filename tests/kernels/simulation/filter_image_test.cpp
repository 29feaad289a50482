#include "kernels/simulation/filter_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "kernels/common/counter_random.hpp"
#include "support/allocations.hpp"

namespace trivet::kernels {
namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 29;

using Filter = std::function<void(const ValueImage&, std::uint32_t, std::span<float>)>;

struct Named {
  const char* name;
  Filter filter;
};
std::vector<Named> filters() {
  return {{"rows", [](const ValueImage& in, std::uint32_t row,
                      std::span<float> out) { smooth_image(in, row, Along::rows, 3, 1.5F, out); }},
          {"columns",
           [](const ValueImage& in, std::uint32_t row, std::span<float> out) {
             smooth_image(in, row, Along::columns, 2, 1.5F, out);
           }},
          {"median", [](const ValueImage& in, std::uint32_t row,
                        std::span<float> out) { median_image(in, row, 2, out); }},
          {"fill", [](const ValueImage& in, std::uint32_t row,
                      std::span<float> out) { fill_image(in, row, 4, Fill::least, out); }},
          {"grow", [](const ValueImage& in, std::uint32_t row,
                      std::span<float> out) { grow_image(in, row, 2, 1.5F, out); }},
          {"coarsen", [](const ValueImage& in, std::uint32_t row, std::span<float> out) {
             coarsen_image(in, row, 3, out);
           }}};
}

/// Integers, for exact sums, and holes.
std::vector<float> image(std::uint64_t seed) {
  std::vector<float> values(kWidth * kHeight);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CounterRandom random(seed, 0, i);
    const double kind = random.uniform();
    values[i] = kind < 0.2 ? 0 : static_cast<float>(1 + random.next() % 6);
  }
  return values;
}

std::vector<float> run(const Filter& filter, const std::vector<float>& in) {
  std::vector<float> out(in.size());
  filter({in, kWidth}, 0, out);
  return out;
}

/// The value of a pixel; 0 beyond the image.
float at(const std::vector<float>& values, int u, int v) {
  if (u < 0 || v < 0 || u >= int{kWidth} || v >= int{kHeight}) return 0;
  return values[static_cast<std::size_t>(v) * kWidth + static_cast<std::size_t>(u)];
}

/// One pixel, from the definition.
float reference(const std::string& name, const std::vector<float>& in, int u, int v) {
  const float own = at(in, u, v);
  if (name == "coarsen") return at(in, u / 3 * 3, v / 3 * 3);
  if (name == "fill") {
    if (own != 0) return own;
    float least = 0;
    for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      int k = 1;
      while (k <= 4 && at(in, u + k * du, v + k * dv) == 0) ++k;
      if (k > 4) continue;
      const float value = at(in, u + k * du, v + k * dv);
      if (least == 0 || value < least) least = value;
    }
    return least;
  }
  if (own == 0) return 0;
  std::vector<float> near;
  if (name == "rows" || name == "columns") {
    const int radius = name == "rows" ? 3 : 2;
    double sum = 0, n = 0;
    for (int k = -radius; k <= radius; ++k) {
      const float value = name == "rows" ? at(in, u + k, v) : at(in, u, v + k);
      if (value == 0 || std::abs(value - own) > 1.5F) continue;
      sum += static_cast<double>(value);
      n += 1;
    }
    return static_cast<float>(sum / n);
  }
  for (int y = v - 2; y <= v + 2; ++y) {
    for (int x = u - 2; x <= u + 2; ++x) {
      if (at(in, x, y) != 0) near.push_back(at(in, x, y));
    }
  }
  std::sort(near.begin(), near.end());
  if (name == "median") return near[(near.size() - 1) / 2];
  return near.back() > own + 1.5F ? near.back() : own;  // grow
}

TEST(FilterImage, AgreesWithReference) {
  for (const Named& named : filters()) {
    const std::vector<float> in = image(3), out = run(named.filter, in);
    for (int v = 0; v < int{kHeight}; ++v) {
      for (int u = 0; u < int{kWidth}; ++u)
        ASSERT_FLOAT_EQ(at(out, u, v), reference(named.name, in, u, v))
            << named.name << " at " << u << ", " << v;
    }
  }
}

TEST(FilterImage, LeavesAFlatImageFlat) {
  for (const Named& named : filters()) {
    const std::vector<float> flat(kWidth * kHeight, 3.0F);
    EXPECT_EQ(run(named.filter, flat), flat) << named.name;
  }
}

TEST(FilterImage, GivesTheSameBitsForAnyChunking) {
  for (const Named& named : filters()) {
    const std::vector<float> in = image(5), whole = run(named.filter, in);
    std::vector<float> parts(in.size());
    for (std::uint32_t row = 0; row < kHeight;) {
      const std::uint32_t rows = std::min(kHeight - row, 1 + row % 5);
      named.filter({in, kWidth}, row,
                   std::span(parts).subspan(std::size_t{row} * kWidth, std::size_t{rows} * kWidth));
      row += rows;
    }
    EXPECT_EQ(whole, parts) << named.name;
  }
}

TEST(FilterImage, AllocatesNothing) {
  for (const Named& named : filters()) {
    const std::vector<float> in = image(5);
    std::vector<float> out(in.size());
    EXPECT_EQ(test::allocations_in([&] { named.filter({in, kWidth}, 0, out); }), 0U) << named.name;
  }
}

TEST(FilterImage, FillsWithTheMostWhereAsked) {
  std::vector<float> in(kWidth * kHeight, 2.0F), out(in.size());
  const std::size_t hole = 10 * kWidth + 10;
  in[hole] = 0;
  in[hole + 1] = 5;
  fill_image({in, kWidth}, 0, 1, Fill::most, out);
  EXPECT_EQ(out[hole], 5);
  fill_image({in, kWidth}, 0, 1, Fill::least, out);
  EXPECT_EQ(out[hole], 2);
}

}  // namespace
}  // namespace trivet::kernels
