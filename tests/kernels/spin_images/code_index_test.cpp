#include "kernels/spin_images/code_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

Column<std::uint8_t> random_codes(test::Random& random, std::size_t n, std::size_t stride) {
  Column<std::uint8_t> codes(n * stride);
  for (std::uint8_t& code : codes) code = static_cast<std::uint8_t>(random.below(256));
  return codes;
}

Column<std::int32_t> norms_of(std::span<const std::uint8_t> codes, std::size_t stride) {
  Column<std::int32_t> norms(codes.size() / stride);
  code_norms(codes, stride, norms);
  return norms;
}

std::uint32_t squared_distance(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return static_cast<std::uint32_t>(sum);
}

TEST(CodeDistances, AreThoseOfIntegers) {
  test::Random random;
  for (const std::size_t stride : {16U, 64U, 80U, 688U}) {
    const auto codes = random_codes(random, 50, stride), query = random_codes(random, 1, stride);
    std::vector<std::uint32_t> squared(50);
    code_distances(query, codes, norms_of(codes, stride), squared);
    for (std::size_t i = 0; i < squared.size(); ++i)
      EXPECT_EQ(squared[i], squared_distance(query, std::span(codes).subspan(i * stride, stride)));
  }
  const Column<std::uint8_t> zeros(688, 0), ones(688, 255);
  std::vector<std::uint32_t> farthest(1);
  code_distances(zeros, ones, norms_of(ones, 688), farthest);
  EXPECT_EQ(farthest[0], 688U * 255 * 255);
  const Column<std::uint8_t> low(64, 0), high(64 * 16, 255);
  std::vector<std::uint32_t> sixteen(16);
  code_distances(low, high, norms_of(high, 64), sixteen);
  EXPECT_EQ(sixteen[15], 64U * 255 * 255);
}

TEST(PadCodes, FillsUpWithZeros) {
  const std::vector<std::uint8_t> codes{1, 2, 3, 4, 5, 6};
  std::vector<std::uint8_t> padded(32, 9);
  pad_codes(codes, 3, padded);
  const std::vector<std::uint8_t> expected{1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                           4, 5, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(padded, expected);
  EXPECT_EQ(code_stride(60), 64U);
  EXPECT_EQ(code_stride(64), 64U);
}

TEST(KeepNearest, LeavesTheNearestInAnyChunks) {
  test::Random random;
  std::vector<std::uint32_t> squared(333);
  for (std::uint32_t& s : squared) s = random.below(40);  // many equal distances
  std::vector<CodeNeighbor> expected;
  for (std::uint32_t i = 0; i < squared.size(); ++i) expected.push_back({squared[i], 100 + i});
  std::ranges::sort(expected);
  for (const std::size_t k : {1U, 7U, 400U}) {
    for (const std::size_t chunk : {1U, 16U, 50U, 333U}) {
      std::vector<CodeNeighbor> nearest(k);
      for (std::size_t first = 0; first < squared.size(); first += chunk) {
        const std::size_t count = std::min(chunk, squared.size() - first);
        keep_nearest(std::span(squared).subspan(first, count),
                     100 + static_cast<std::uint32_t>(first), nearest);
      }
      for (std::size_t i = 0; i < k; ++i)
        ASSERT_EQ(nearest[i], i < expected.size() ? expected[i] : CodeNeighbor{}) << k << chunk;
    }
  }
}

TEST(NearestLists, AreThoseOfTheNearestCentroids) {
  test::Random random;
  const auto centroids = random_codes(random, 40, 16), query = random_codes(random, 1, 16);
  const std::vector<std::uint32_t> offsets(41, 0);
  const CodeIndexView index{16, centroids, offsets, {}};
  EXPECT_EQ(index.num_lists(), 40U);
  std::vector<std::uint32_t> distances(40);
  std::vector<CodeNeighbor> lists(5);
  nearest_lists(index, query, norms_of(centroids, 16), distances, lists);
  for (std::size_t i = 0; i < 40; ++i) {
    const std::uint32_t squared = squared_distance(query, std::span(centroids).subspan(i * 16, 16));
    const bool is_listed =
        std::ranges::any_of(lists, [&](const CodeNeighbor& list) { return list.index == i; });
    EXPECT_EQ(is_listed, CodeNeighbor(squared, static_cast<std::uint32_t>(i)) <= lists.back());
  }
}

}  // namespace
}  // namespace trivet::kernels
