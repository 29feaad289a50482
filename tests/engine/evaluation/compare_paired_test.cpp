#include "engine/evaluation/compare_paired.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/common/counter_random.hpp"

namespace trivet {
namespace {

using kernels::CounterRandom;
using Scenes = std::vector<PairedTrials>;

double p_of(std::size_t only_first, std::size_t only_second) {
  return compare_paired(Scenes{{5, only_first, only_second, 5}}, 1).p;
}

/// The p-value from its definition, for counts that a double represents exactly.
double reference_p(std::size_t b, std::size_t c) {
  const std::size_t n = b + c;
  double ways = 0, choose = 1;
  for (std::size_t i = 0; i <= std::min(b, c); ++i) {
    ways += choose;
    choose = choose * static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return std::min(1.0, 2 * ways / std::pow(2.0, static_cast<double>(n)));
}

/// Scenes of two methods with success rates of 0.7 and 0.6. A scene may be hard for all its trials.
Scenes simulated(std::size_t num_scenes, std::size_t num_trials, std::uint64_t seed) {
  Scenes scenes(num_scenes);
  for (std::size_t s = 0; s < num_scenes; ++s) {
    CounterRandom random(seed, 0, s);
    const double hardness = random.uniform(-0.2, 0.2);
    for (std::size_t t = 0; t < num_trials; ++t) {
      const bool first = random.uniform() < 0.7 - hardness,
                 second = random.uniform() < 0.6 - hardness;
      ++(first    ? second ? scenes[s].both : scenes[s].only_first
         : second ? scenes[s].only_second
                  : scenes[s].neither);
    }
  }
  return scenes;
}

TEST(ComparePaired, GivesMcNemarsExactP) {
  EXPECT_NEAR(p_of(1, 9), 0.021484375, 1e-15);
  EXPECT_NEAR(p_of(0, 5), 0.0625, 1e-15);
  EXPECT_EQ(p_of(4, 4), 1);
  EXPECT_EQ(p_of(0, 0), 1) << "nothing distinguishes them";
  for (std::size_t b = 0; b <= 25; ++b) {
    for (std::size_t c = 0; c <= 25; ++c) EXPECT_NEAR(p_of(b, c), reference_p(b, c), 1e-13);
  }
}

// The tail of the normal distribution, with continuity correction, is within 1 % of it there.
TEST(ComparePaired, StaysFiniteForManyTrials) {
  const double b = 40000, c = 41000;
  const double z = (c - b - 1) / std::sqrt(b + c);
  const double tail = std::erfc(z / std::numbers::sqrt2);
  EXPECT_NEAR(p_of(40000, 41000), tail, 0.01 * tail);
  EXPECT_EQ(p_of(40000, 40000), 1);
  EXPECT_EQ(p_of(0, 100000), 0) << "less than a double represents";
}

TEST(ComparePaired, GivesTheDifferenceOfTheRates) {
  const PairedComparison found = compare_paired(Scenes{{3, 2, 1, 4}, {0, 5, 2, 3}}, 1);
  EXPECT_EQ(found.total, (PairedTrials{3, 7, 3, 7}));
  EXPECT_DOUBLE_EQ(found.difference, 0.2);
}

TEST(ComparePaired, FindsNothingBetweenAMethodAndItself) {
  const PairedComparison same = compare_paired(Scenes{{3, 0, 0, 1}, {0, 0, 0, 6}, {7, 0, 0, 0}}, 1);
  EXPECT_EQ(same, (PairedComparison{{10, 0, 0, 7}, 0, 0, 0, 1}));
  EXPECT_EQ(compare_paired({}, 1), PairedComparison{});
  EXPECT_EQ(compare_paired(Scenes(3), 1), PairedComparison{}) << "scenes without trials";
}

TEST(ComparePaired, MirrorsWhenTheMethodsChangeSides) {
  Scenes scenes = simulated(40, 8, 3);
  const PairedComparison there = compare_paired(scenes, 9);
  for (PairedTrials& scene : scenes) std::swap(scene.only_first, scene.only_second);
  const PairedComparison back = compare_paired(scenes, 9);
  EXPECT_EQ(back.difference, -there.difference);
  EXPECT_EQ(back.p, there.p);
  EXPECT_NEAR(back.low, -there.high, 1e-12);
  EXPECT_NEAR(back.high, -there.low, 1e-12);
}

TEST(ComparePaired, DoesNotAskForTheOrderOfTheScenes) {
  Scenes scenes = simulated(40, 8, 3);
  const PairedComparison before = compare_paired(scenes, 9);
  std::reverse(scenes.begin(), scenes.end());
  const PairedComparison after = compare_paired(scenes, 9);
  EXPECT_EQ(after.difference, before.difference);
  EXPECT_EQ(after.p, before.p);
  EXPECT_NEAR(after.low, before.low, 0.02) << "other scenes are drawn";
  EXPECT_NEAR(after.high, before.high, 0.02);
}

TEST(ComparePaired, GivesTheSameForTheSameSeedOnly) {
  const Scenes scenes = simulated(40, 8, 3);
  EXPECT_EQ(compare_paired(scenes, 9), compare_paired(scenes, 9));
  EXPECT_NE(compare_paired(scenes, 9), compare_paired(scenes, 10));
}

// Of 300 studies 95 % have the true difference, 0.1, in the interval: 285, within 4 standard
// deviations of a binomial, 3.8 each.
TEST(ComparePaired, CoversTheTrueDifferenceAsOftenAsItSays) {
  constexpr int kStudies = 300;
  int covered = 0;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const PairedComparison found = compare_paired(simulated(60, 8, 100 + study), study);
    EXPECT_LE(found.low, found.high);
    covered += found.low <= 0.1 && 0.1 <= found.high;
  }
  EXPECT_NEAR(covered, 0.95 * kStudies, 15);
}

// Ten copies of each trial are no more evidence than one where the scene decides them all.
TEST(ComparePaired, TreatsTrialsOfASceneAsCopies) {
  const Scenes scenes = simulated(60, 1, 5);
  Scenes copies = scenes;
  for (PairedTrials& scene : copies) {
    for (std::size_t* count : {&scene.both, &scene.only_first, &scene.only_second, &scene.neither})
      *count *= 10;
  }
  const PairedComparison once = compare_paired(scenes, 2), tenfold = compare_paired(copies, 2);
  EXPECT_DOUBLE_EQ(tenfold.low, once.low);
  EXPECT_DOUBLE_EQ(tenfold.high, once.high);
  EXPECT_GT(once.high - once.low, 0.1);
}

}  // namespace
}  // namespace trivet
