#include "engine/training/standard_basis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "engine/training/find_basis.hpp"
#include "kernels/common/projector.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::engine {
namespace {

Eigen::Map<const Eigen::MatrixXf> columns_of(const PcaBasis& pca) {
  return {pca.components.data(), static_cast<Eigen::Index>(pca.dimension),
          static_cast<Eigen::Index>(pca.size())};
}

TEST(StandardBasis, HasOrthogonalUnitComponentsOfFallingVariance) {
  const PcaBasis all = standard_basis({.num_components = kMostComponents}).components;
  ASSERT_EQ(all.size(), kMostComponents);
  const Eigen::MatrixXf products = columns_of(all).transpose() * columns_of(all);
  EXPECT_TRUE(products.isIdentity(1e-4F));
  EXPECT_TRUE(std::ranges::is_sorted(all.energies, std::greater()));
  EXPECT_GT(all.all_energy, 0);
}

TEST(StandardBasis, GivesTheFirstComponentsThatAreAskedFor) {
  const TriSpinBasis all = standard_basis({.num_components = kMostComponents});
  const TriSpinBasis usual = standard_basis({});
  EXPECT_EQ(usual.components.size(), 60U);
  EXPECT_TRUE(std::ranges::equal(
      usual.components.components,
      std::span(all.components.components).first(usual.components.components.size())));
  EXPECT_EQ(usual.code_step, all.code_step);

  const std::size_t half = standard_basis({.component_energy = 0.5F}).components.size();
  EXPECT_GT(half, 1U);
  EXPECT_LT(half, 20U);
  EXPECT_EQ(standard_basis({.tri_spin_images = false}).components.size(), 0U);
}

// The basis was computed from other shapes and must suit any shape.
TEST(StandardBasis, HasNearlyTheVarianceThatAnImagesOwnBasisHas) {
  const auto images =
      sample_images(test::cloud_of(test::lever()), {"lever", "lever.ply", 1, {}}, 1000);
  ASSERT_TRUE(images);
  const auto share_left = [&](const PcaBasis& pca) {
    std::vector<float> numbers(images->size() / pca.dimension * pca.size());
    kernels::Projector(pca).project(*images, numbers);
    double all = 0, kept = 0;
    for (std::size_t i = 0; i < images->size(); ++i) {
      const float d = (*images)[i] - pca.mean[i % pca.dimension];
      all += static_cast<double>(d * d);
    }
    for (const float n : numbers) kept += static_cast<double>(n * n);
    return 1 - kept / all;
  };
  EXPECT_LT(share_left(standard_basis({}).components),
            share_left(basis_of(*images, 60).components) + 0.12);
}

TEST(ParseBasis, ReadsWhatWasWrittenAndNothingElse) {
  const TriSpinBasis basis = standard_basis({.num_components = 7});
  const std::string bytes = basis_bytes(basis);
  const Result<TriSpinBasis> again = parse_basis(bytes);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->components.components, basis.components.components);
  EXPECT_EQ(again->components.energies, basis.components.energies);
  EXPECT_EQ(again->components.mean, basis.components.mean);
  EXPECT_EQ(again->support, basis.support);
  for (const std::string& wrong : {std::string(), bytes.substr(0, bytes.size() - 1), bytes + "x"})
    EXPECT_FALSE(parse_basis(wrong));
}

}  // namespace
}  // namespace trivet::engine
