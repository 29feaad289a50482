#include "kernels/common/pca.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Vectors with spreads of 1, 1/2, 1/3, ... along the axes of a random frame, about a mean.
struct Cloud {
  std::size_t dimension;
  std::vector<float> vectors;
  Eigen::MatrixXd frame;

  Cloud(test::Random& random, std::size_t d, std::size_t n) : dimension(d) {
    const auto size = static_cast<Eigen::Index>(d);
    Eigen::MatrixXd random_matrix(size, size);
    for (double& value : random_matrix.reshaped()) value = static_cast<double>(random.normal(1));
    frame = Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix).householderQ();
    for (std::size_t i = 0; i < n; ++i) {
      Eigen::VectorXd v = Eigen::VectorXd::Constant(size, 3);
      for (Eigen::Index k = 0; k < size; ++k)
        v += static_cast<double>(random.normal(1)) / static_cast<double>(k + 1) * frame.col(k);
      for (const double value : v) vectors.push_back(static_cast<float>(value));
    }
  }
};

std::span<const float> component(const PcaBasis& basis, std::size_t k) {
  return std::span(basis.components).subspan(k * basis.dimension, basis.dimension);
}
double dot(std::span<const float> a, std::span<const float> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

TEST(FindComponents, FindsTheAxesThatTheVectorsSpreadAlong) {
  test::Random random;
  const Cloud cloud(random, 12, 20000);
  const PcaBasis basis = find_components(cloud.vectors, 12, 4);
  ASSERT_EQ(basis.size(), 4U);
  for (const float value : basis.mean) EXPECT_NEAR(value, 3, 0.05);
  for (std::size_t k = 0; k < 4; ++k) {
    double along = 0;
    for (std::size_t i = 0; i < 12; ++i)
      along += static_cast<double>(component(basis, k)[i]) *
               cloud.frame(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
    EXPECT_GT(std::abs(along), 0.99) << k;
    EXPECT_NEAR(basis.energies[k], 1.0 / std::pow(k + 1, 2), 0.05) << k;
    EXPECT_GT(*std::ranges::max_element(component(basis, k)),
              -*std::ranges::min_element(component(basis, k)));
  }
}

TEST(FindComponents, GivesAnOrthonormalBasisByFallingEnergy) {
  test::Random random;
  const Cloud cloud(random, 20, 300);
  const PcaBasis basis = find_components(cloud.vectors, 20, 20);
  ASSERT_EQ(basis.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) {
    for (std::size_t k = 0; k <= i; ++k)
      EXPECT_NEAR(dot(component(basis, i), component(basis, k)), i == k, 1e-5);
    EXPECT_LE(basis.energies[i], basis.energies[i > 0 ? i - 1 : 0]);
  }
  EXPECT_NEAR(std::accumulate(basis.energies.begin(), basis.energies.end(), 0.0), basis.all_energy,
              1e-4);
}

TEST(FindComponents, KeepsAsManyAsTheEnergyAsksFor) {
  test::Random random;
  const Cloud cloud(random, 30, 500);
  for (const double energy : {0.0, 0.5, 0.9, 0.99, 1.0}) {
    const PcaBasis basis = find_components(cloud.vectors, 30, 100, energy);
    const double kept = std::accumulate(basis.energies.begin(), basis.energies.end(), 0.0);
    EXPECT_GE(kept, (energy - 1e-6) * basis.all_energy);
    if (basis.size() > 1) {
      EXPECT_LT(kept - static_cast<double>(basis.energies.back()), energy * basis.all_energy);
    }
  }
  EXPECT_EQ(find_components(cloud.vectors, 30, 100, 0).size(), 1U) << "the thesis' one";
  EXPECT_EQ(find_components(cloud.vectors, 30, 7).size(), 7U);
}

}  // namespace
}  // namespace trivet::kernels
