#include "kernels/spin_images/nearest_centroids.hpp"

#include <gtest/gtest.h>

#include "kernels/spin_images/code_index.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// `most` bounds the byte values: with few values, many centroids are equally near.
std::vector<std::uint8_t> random_codes(test::Random& random, std::size_t n, std::size_t stride,
                                       std::uint32_t most) {
  std::vector<std::uint8_t> codes(n * stride);
  for (std::uint8_t& code : codes) code = static_cast<std::uint8_t>(random.below(most + 1));
  return codes;
}

std::vector<std::int32_t> norms_of(std::span<const std::uint8_t> codes, std::size_t stride) {
  std::vector<std::int32_t> norms(codes.size() / stride);
  code_norms(codes, stride, norms);
  return norms;
}

/// The linear search as reference.
std::uint32_t first_nearest(std::span<const std::uint8_t> code,
                            std::span<const std::uint8_t> centroids) {
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t nearest = 0;
  for (std::size_t l = 0; l < centroids.size() / code.size(); ++l) {
    double squared = 0;
    for (std::size_t j = 0; j < code.size(); ++j) {
      const double d =
          static_cast<double>(code[j]) - static_cast<double>(centroids[l * code.size() + j]);
      squared += d * d;
    }
    if (squared >= least) continue;
    least = squared;
    nearest = static_cast<std::uint32_t>(l);
  }
  return nearest;
}

TEST(NearestCentroids, AreTheFirstOfTheNearest) {
  test::Random random;
  for (const std::size_t stride : {16U, 64U, 80U}) {
    for (const std::uint32_t most : {1U, 255U}) {
      for (const std::size_t num_lists : {1U, 5U, 6U, 7U, 300U}) {
        auto centroids = random_codes(random, num_lists, stride, most);
        if (num_lists > 6)  // a centroid with the same bytes as an earlier one
          std::copy_n(centroids.begin(), stride, centroids.begin() + 6 * stride);
        for (const std::size_t n : {0U, 1U, 63U, 64U, 65U, 200U}) {
          const auto codes = random_codes(random, n, stride, most);
          std::vector<std::uint32_t> nearest(n);
          nearest_centroids(codes, stride, centroids, norms_of(centroids, stride), nearest);
          for (std::size_t i = 0; i < n; ++i)
            ASSERT_EQ(nearest[i],
                      first_nearest(std::span(codes).subspan(i * stride, stride), centroids))
                << stride << ' ' << most << ' ' << num_lists << ' ' << n << ' ' << i;
        }
      }
    }
  }
}

TEST(NearestCentroids, AreFoundAmongTheFarthestBytes) {
  const std::vector<std::uint8_t> zeros(64, 0), ones(64, 255);
  std::vector<std::uint8_t> both(ones);
  both.insert(both.end(), zeros.begin(), zeros.end());
  std::vector<std::uint32_t> nearest(1);
  nearest_centroids(zeros, 64, both, norms_of(both, 64), nearest);
  EXPECT_EQ(nearest[0], 1U);
  nearest_centroids(ones, 64, both, norms_of(both, 64), nearest);
  EXPECT_EQ(nearest[0], 0U);
}

TEST(NearestCentroids, AllocateNothing) {
  test::Random random;
  const auto codes = random_codes(random, 100, 64, 255),
             centroids = random_codes(random, 9, 64, 255);
  const auto norms = norms_of(centroids, 64);
  std::vector<std::uint32_t> nearest(100);
  EXPECT_EQ(test::allocations_in([&] { nearest_centroids(codes, 64, centroids, norms, nearest); }),
            0U);
}

TEST(MoveCentroids, ToTheRoundedMeanOfTheirCodes) {
  std::vector<std::uint8_t> codes(3 * 16, 0), centroids(3 * 16, 0);
  for (std::size_t j = 0; j < 16; ++j) {
    codes[j] = 10;
    codes[16 + j] = 13;
    codes[32 + j] = 200;
    centroids[16 + j] = 250;
    centroids[32 + j] = 90;
  }
  std::vector<std::uint32_t> nearest(3);
  nearest_centroids(codes, 16, centroids, norms_of(centroids, 16), nearest);
  CentroidSums sums(3, 16);
  add_to_centroids(codes, 16, nearest, sums);
  move_centroids(sums, centroids);
  EXPECT_EQ(centroids[0], 12) << "11.5, rounded";
  EXPECT_EQ(centroids[16], 200);
  EXPECT_EQ(centroids[32], 90) << "has no codes";
}

}  // namespace
}  // namespace trivet::kernels
