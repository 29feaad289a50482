#include "kernels/common/projector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/common/pca.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Vectors of numbers between `middle` - 1 and `middle` + 1, times `scale`.
std::vector<float> some_vectors(std::size_t dimension, std::size_t n, float middle = 3,
                                float scale = 1) {
  test::Random random;
  std::vector<float> vectors;
  for (std::size_t i = 0; i < n * dimension; ++i)
    vectors.push_back(scale * (middle + random.uniform(-1, 1)));
  return vectors;
}

std::vector<float> project(const PcaBasis& basis, std::span<const float> vectors) {
  std::vector<float> out(vectors.size() / basis.dimension * basis.size());
  Projector(basis).project(vectors, out);
  return out;
}

/// The projection in double precision, from the definition.
double project_naively(const PcaBasis& basis, std::span<const float> vector, std::size_t k) {
  double sum = 0;
  for (std::size_t j = 0; j < basis.dimension; ++j)
    sum += (static_cast<double>(vector[j]) - static_cast<double>(basis.mean[j])) *
           static_cast<double>(basis.components[k * basis.dimension + j]);
  return sum;
}

double distance_from_mean(const PcaBasis& basis, std::span<const float> vector) {
  double squared = 0;
  for (std::size_t j = 0; j < basis.dimension; ++j)
    squared += std::pow(static_cast<double>(vector[j]) - static_cast<double>(basis.mean[j]), 2);
  return std::sqrt(squared);
}

TEST(Projector, AgreesWithANaiveReferenceAtAnyScale) {
  for (const float scale : {1e-12F, 1.0F, 1e15F}) {
    for (const std::size_t d : {1U, 5U, 32U, 33U, 675U}) {
      const std::vector<float> vectors = some_vectors(d, 61, 3, scale);
      PcaBasis basis = find_components(some_vectors(d, 61), d, std::min<std::size_t>(d, 7));
      for (float& value : basis.mean) value *= scale;
      const std::vector<float> out = project(basis, vectors);
      for (std::size_t i = 0; i < 61; ++i) {
        const auto vector = std::span(vectors).subspan(i * d, d);
        for (std::size_t k = 0; k < basis.size(); ++k)
          EXPECT_NEAR(out[i * basis.size() + k], project_naively(basis, vector, k),
                      1e-4 * distance_from_mean(basis, vector))
              << d << " numbers, vector " << i;
      }
    }
  }
}

TEST(Projector, KeepsDistancesInAFullBasis) {
  const std::vector<float> vectors = some_vectors(33, 60);
  const PcaBasis basis = find_components(vectors, 33, 33);
  const std::vector<float> out = project(basis, vectors);
  const auto distance = [](std::span<const float> all) {
    double squared = 0;
    for (std::size_t j = 0; j < 33; ++j) squared += std::pow(all[3 * 33 + j] - all[4 * 33 + j], 2);
    return std::sqrt(squared);
  };
  EXPECT_NEAR(distance(out), distance(vectors), 1e-3);
}

// The largest possible sums: vectors along a component, with all of it in one number or spread. In
// these sums all numbers may be rounded the same way.
TEST(Projector, HoldsTheLongestProducts) {
  for (const std::size_t d : {1U, 4U, 1024U}) {
    PcaBasis basis;
    basis.dimension = d;
    basis.mean.assign(d, 0);
    basis.energies.assign(1, 1);
    basis.components.assign(d, 1 / std::sqrt(static_cast<float>(d)));
    for (const float length : {1.0F, 1.999F, -1.0F, 0.51F}) {
      const std::vector<float> vector(d, length / std::sqrt(static_cast<float>(d)));
      EXPECT_NEAR(project(basis, vector).front() / length, 1, 1e-3) << d;
    }
  }
}

TEST(Projector, GivesNothingOfTheMean) {
  PcaBasis basis = find_components(some_vectors(20, 50), 20, 4);
  const std::vector<float> mean(basis.mean.begin(), basis.mean.end());
  for (const float value : project(basis, mean)) EXPECT_EQ(value, 0);
}

TEST(Projector, GivesTheSameBitsForAnyChunkingAndAllocatesNothing) {
  const std::vector<float> vectors = some_vectors(21, 100);
  const Projector projector(find_components(vectors, 21, 6));
  std::vector<float> whole(600), parts(600);
  EXPECT_EQ(test::allocations_in([&] { projector.project(vectors, whole); }), 0U);
  test::for_chunks(100, 7, [&](std::size_t first, std::size_t count) {
    projector.project(std::span(vectors).subspan(first * 21, count * 21),
                      std::span(parts).subspan(first * 6, count * 6));
  });
  EXPECT_TRUE(test::same_bits(whole, parts));
}

}  // namespace
}  // namespace trivet::kernels
