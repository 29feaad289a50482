#include "engine/hypotheses/search_codes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "engine/common/thread_limit.hpp"
#include "engine/libraries/build_code_lists.hpp"
#include "kernels/spin_images/nearest_centroids.hpp"
#include "support/random.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kStride = 64;

/// Clustered codes, like those of real features.
Column<std::uint8_t> clustered(test::Random& random, std::size_t n, std::size_t num_clusters) {
  Column<std::uint8_t> centers(num_clusters * kStride), codes;
  for (std::uint8_t& c : centers) c = static_cast<std::uint8_t>(60 + random.below(136));
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = random.below(static_cast<std::uint32_t>(num_clusters)) * kStride;
    for (std::size_t j = 0; j < kStride; ++j)
      codes.push_back(static_cast<std::uint8_t>(centers[at + j] + random.below(41) - 20));
  }
  return codes;
}

/// An index over codes, with the codes in the order of its lists.
struct Indexed {
  explicit Indexed(std::span<const std::uint8_t> codes) : lists(build_code_lists(codes, kStride)) {
    order.resize(lists.list.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return lists.list[i]; });
    for (const std::uint32_t i : order) {
      const auto code = codes.subspan(i * kStride, kStride);
      in_order.insert(in_order.end(), code.begin(), code.end());
    }
  }
  kernels::CodeIndexView view() const {
    return {kStride, lists.centroids, lists.offsets, in_order};
  }
  CodeLists lists;
  std::vector<std::uint32_t> order;  // the codes, list by list
  Column<std::uint8_t> in_order;
};

class SearchCodes : public testing::Test {
 protected:
  SearchCodes() {
    test::Random random;
    codes_ = clustered(random, 30000, 400);
    queries_.assign(codes_.begin(), codes_.begin() + 200 * kStride);
    for (std::uint8_t& q : queries_) q = static_cast<std::uint8_t>(q + random.below(21) - 10);
  }
  std::vector<kernels::CodeNeighbor> exact(const Indexed& index, std::size_t q,
                                           std::size_t k) const {
    std::vector<std::uint32_t> squared(index.view().size());
    Column<std::int32_t> norms(squared.size());
    kernels::code_norms(index.in_order, kStride, norms);
    kernels::code_distances(std::span(queries_).subspan(q * kStride, kStride), index.in_order,
                            norms, squared);
    std::vector<kernels::CodeNeighbor> nearest(k);
    kernels::keep_nearest(squared, 0, nearest);
    return nearest;
  }
  Column<std::uint8_t> codes_, queries_;
};

TEST_F(SearchCodes, EachCodeStandsInTheListOfItsNearestCentroid) {
  const Indexed index(codes_);
  EXPECT_EQ(index.view().num_lists(), 15U);
  EXPECT_EQ(index.view().size(), codes_.size() / kStride);
  Column<std::int32_t> norms(index.view().num_lists());
  kernels::code_norms(index.lists.centroids, kStride, norms);
  std::vector<std::uint32_t> nearest(index.view().size());
  kernels::nearest_centroids(index.in_order, kStride, index.lists.centroids, norms, nearest);
  for (std::uint32_t l = 0; l < index.view().num_lists(); ++l) {
    for (std::uint32_t at = index.lists.offsets[l]; at < index.lists.offsets[l + 1]; ++at)
      ASSERT_EQ(nearest[at], l);
  }
}

TEST_F(SearchCodes, IsExactWhenAllListsAreSearched) {
  const Indexed index(codes_);
  const CodeNeighbors found = search_codes(index.view(), queries_, 100, 5);
  for (std::size_t q = 0; q < 200; ++q)
    EXPECT_TRUE(std::ranges::equal(found.of(q), exact(index, q, 5))) << q;
}

TEST_F(SearchCodes, FindsMostInAFewLists) {
  const Indexed index(codes_);
  const CodeNeighbors found = search_codes(index.view(), queries_, 3, 1);
  std::size_t right = 0;
  for (std::size_t q = 0; q < 200; ++q) right += found.of(q)[0] == exact(index, q, 1)[0];
  EXPECT_GT(right, 190U);
}

TEST_F(SearchCodes, ReportsMissingNeighbors) {
  const Indexed index{std::span(codes_).first(2 * kStride)};
  const CodeNeighbors found = search_codes(index.view(), queries_, 4, 3);
  for (std::size_t q = 0; q < 200; ++q) {
    EXPECT_NE(found.of(q)[1].index, kernels::CodeNeighbor::kNone);
    EXPECT_EQ(found.of(q)[2].index, kernels::CodeNeighbor::kNone);
  }
}

TEST_F(SearchCodes, RestsAfterEachPartOfALargeIndex) {
  constexpr std::size_t kListSize = 4096, kNumLists = 300;  // 75 MiB
  const Column<std::uint8_t> centroids(kNumLists * kStride, 100);
  Column<std::uint8_t> codes(kNumLists * kListSize * kStride, 100);
  std::vector<std::uint32_t> offsets;
  for (std::uint32_t l = 0; l <= kNumLists; ++l) offsets.push_back(l * kListSize);
  const std::size_t first = kListSize + 7, last = (kNumLists - 1) * kListSize + 9;
  for (const std::size_t i : {first, last}) codes[i * kStride] = 90;
  Column<std::uint8_t> query(kStride, 100);
  query[0] = 90;
  int rests = 0;
  const CodeNeighbors found =
      search_codes({kStride, centroids, offsets, codes}, query, kNumLists, 2, [&] { ++rests; });
  EXPECT_EQ(rests, 2);
  EXPECT_EQ(found.all[0].index, first);
  EXPECT_EQ(found.all[1].index, last);
}

TEST_F(SearchCodes, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto all = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    const Indexed index(codes_);
    return search_codes(index.view(), queries_, 4, 10).all;
  };
  EXPECT_EQ(all(1), all(2));
}

}  // namespace
}  // namespace trivet::engine
