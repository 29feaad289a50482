#include "engine/libraries/centroids.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/common/thread_limit.hpp"
#include "kernels/spin_images/code_index.hpp"
#include "support/random.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kStride = 64, kNumMany = 2100, kNumCodes = 20'000;

/// Codes that vary more in 4 directions than in all others, like those of real features.
Column<std::uint8_t> random_codes(std::uint32_t seed, std::size_t n) {
  test::Random directions, random(seed);
  std::array<std::array<float, kStride>, 4> axes{};
  for (auto& axis : axes) std::ranges::generate(axis, [&] { return directions.normal(1); });
  Column<std::uint8_t> codes;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<float, 4> at{};
    std::ranges::generate(at, [&] { return random.normal(12); });
    for (std::size_t j = 0; j < kStride; ++j) {
      float value = 128 + random.normal(4);
      for (std::size_t k = 0; k < at.size(); ++k) value += at[k] * axes[k][j];
      codes.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F)));
    }
  }
  return codes;
}

double squared_distance(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return sum;
}

class Centroids : public testing::Test {
 protected:
  std::span<const std::uint8_t> code(std::size_t i) const {
    return std::span(codes_).subspan(i * kStride, kStride);
  }
  std::span<const std::uint8_t> centroid(std::size_t i) const {
    return std::span(many_).subspan(i * kStride, kStride);
  }
  Column<std::uint8_t> codes_ = random_codes(1, kNumCodes), many_ = random_codes(2, kNumMany);
};

TEST_F(Centroids, OfManyThatOfACodeIsTheNearestOrNearlySo) {
  const CentroidFinder finder(many_, kStride);
  std::vector<std::uint32_t> found(kNumCodes), nearest(kNumCodes);
  finder.find(codes_, found);
  ComparedCodes(many_, kStride).find_nearest(codes_, nearest);
  std::size_t num_same = 0;
  double sum = 0, least = 0;
  for (std::size_t i = 0; i < kNumCodes; ++i) {
    num_same += found[i] == nearest[i];
    sum += squared_distance(code(i), centroid(found[i]));
    least += squared_distance(code(i), centroid(nearest[i]));
  }
  EXPECT_GT(num_same, kNumCodes * 99 / 100);
  EXPECT_LT(num_same, kNumCodes) << "all were compared";
  EXPECT_LT(sum, 1.005 * least);
}

TEST_F(Centroids, OfFewThatOfACodeIsTheNearest) {
  many_.resize(100 * kStride);
  const CentroidFinder finder(many_, kStride);
  std::vector<std::uint32_t> found(500);
  finder.find(std::span(codes_).first(found.size() * kStride), found);
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<double> squared;
    for (std::size_t c = 0; c < 100; ++c) squared.push_back(squared_distance(code(i), centroid(c)));
    EXPECT_EQ(squared[found[i]], std::ranges::min(squared)) << i;
  }
}

TEST_F(Centroids, AreTheSameForAnyThreadsAndChunks) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const unsigned threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    const CentroidFinder finder(many_, kStride);
    std::vector<std::uint32_t>& found = all.emplace_back(kNumCodes);
    const std::size_t at_once = threads == 1 ? kNumCodes : 777;
    for_chunks(kNumCodes, at_once, [&](std::size_t first, std::size_t count) {
      finder.find(std::span(codes_).subspan(first * kStride, count * kStride),
                  std::span(found).subspan(first, count));
    });
  }
  EXPECT_EQ(all[0], all[1]);
}

}  // namespace
}  // namespace trivet::engine
