#include "engine/loaded_library/find_families.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "engine/common/thread_limit.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

/// Plates with a rib whose posts rise by 6 mm from one to the next, the last one moved; and a lever.
class FindFamilies : public testing::Test {
 protected:
  static test::Shape plate(float post) {
    return test::box({-0.08F, -0.05F, 0}, {0.08F, 0.05F, 0.02F})
        .join(test::box({-0.07F, -0.04F, 0.02F}, {-0.03F, 0.01F, 0.05F}))
        .join(test::box({0.03F, 0.01F, 0.02F}, {0.05F, 0.03F, 0.02F + post}));
  }
  static void SetUpTestSuite() {
    static const test::Shape lever = test::lever(), low = plate(0.01F), middle = plate(0.016F),
                             top = plate(0.022F).moved(
                                 test::pose_of({0.4F, -1.1F, 0.7F}, {0.3F, 0, 0}));
    recognizer_ = Recognizer(test::trained_library(
        {{"lever", &lever}, {"plate_a", &low}, {"plate_b", &middle}, {"plate_c", &top}},
        {.tri_spin_images = false}));
  }
  static std::vector<Family> found(std::optional<float> deviation = {}) {
    const Result<std::vector<Family>> families = find_families(recognizer_, deviation);
    EXPECT_TRUE(families);
    return *families;
  }
  static inline Recognizer recognizer_{Library{}};
};

TEST_F(FindFamilies, LinksModelsByPairsWithinTheLimit) {
  const std::vector<Family> families = found(0.008F);
  ASSERT_EQ(families.size(), 1U);
  EXPECT_EQ(families[0].models, (std::vector<std::uint32_t>{1, 2, 3})) << "a to b, b to c";
  ASSERT_EQ(families[0].pairs.size(), 2U) << "a and c are 12 mm apart";
  for (const FamilyPair& pair : families[0].pairs)
    EXPECT_NEAR(pair.difference.deviation, 0.006F, 0.0015F);
  EXPECT_LT((families[0].pairs[0].difference.center - Eigen::Vector3f(0.04F, 0.02F, 0.035F)).norm(),
            0.01F)
      << families[0].pairs[0].difference.center.transpose();
}

TEST_F(FindFamilies, HaveNineTenthsOfTheirSurfacesInCommon) {
  const std::vector<Family> families = found();
  ASSERT_EQ(families.size(), 1U);
  EXPECT_EQ(families[0].models, (std::vector<std::uint32_t>{1, 2, 3}));
  for (const FamilyPair& pair : families[0].pairs) EXPECT_GE(pair.agreeing, kFamilyAgreement);
  EXPECT_TRUE(found(0.002F).empty());
}

TEST_F(FindFamilies, FindsTheSameForAnyNumberOfThreads) {
  const auto deviations = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<float> all;
    for (const Family& family : found()) {
      for (const FamilyPair& pair : family.pairs) all.push_back(pair.difference.deviation);
    }
    return all;
  };
  EXPECT_EQ(deviations(1), deviations(3));
}

}  // namespace
}  // namespace trivet
