#include "kernels/pair_features/scene_pairs.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::OrientedCloud;
using test::Random;

const PpfQuantization kQuantization{0.3F, 9, 6};

struct Scratch {
  explicit Scratch(std::size_t n) : pairs(n) {}
  PairScratch pairs;
  VoteKeys keys;
  std::vector<SceneVote> votes;
};

/// The look-ups of the pairs that begin at the first point of a cloud.
std::vector<SceneVote> collect(const OrientedCloud& cloud, float share) {
  Scratch scratch(cloud.points.size());
  collect_scene_votes(reference_frame(cloud.points[0], cloud.normals[0]),
                      {cloud.points, cloud.normals}, {kQuantization, share}, scratch.pairs,
                      scratch.keys, scratch.votes);
  return scratch.votes;
}

reference::PairFeature feature_to(const OrientedCloud& cloud, std::size_t i) {
  const Pose T = frame_pose(reference_frame(cloud.points[0], cloud.normals[0]));
  return reference::pair_feature(cloud.points[0], cloud.normals[0], cloud.points[i],
                                 cloud.normals[i], T);
}

double rotation_bin_fraction(double units) {
  return reference::bin_of(units, 65536.0 / kRotationBins).fraction;
}

/// A random cloud in which no pair from the first point depends on rounding.
OrientedCloud clear_cloud(Random& random, std::size_t n, float share) {
  OrientedCloud cloud = test::random_oriented(random, 1);
  while (cloud.points.size() < n) {
    const OrientedCloud one = test::random_oriented(random, 1);
    cloud.points.push_back(one.points[0]);
    cloud.normals.push_back(one.normals[0]);
    const auto f = feature_to(cloud, cloud.points.size() - 1);
    const double turn = rotation_bin_fraction(reference::turn_units(f.rotation));
    if (!reference::near_border(f, kQuantization, {0, 1, share, 1 - share}) &&
        std::abs(turn - 0.5) < 0.499) {
      continue;
    }
    cloud.points.resize(cloud.points.size() - 1);
    cloud.normals.resize(cloud.normals.size() - 1);
  }
  return cloud;
}

/// Every bin in which a component is looked up: its bin, and an adjacent one that it nearly falls
/// in.
std::vector<std::int64_t> looked_up_bins(const reference::Bin& bin, double share,
                                         std::int64_t count) {
  std::vector<std::int64_t> bins{bin.index};
  if (bin.fraction < share && bin.index > 0) {
    bins.push_back(bin.index - 1);
  } else if (bin.fraction > 1 - share && bin.index + 1 < count) {
    bins.push_back(bin.index + 1);
  }
  return bins;
}

using Flags = std::map<std::pair<std::uint32_t, std::int64_t>, double>;  // lowest rotation of each

Flags naive_votes(const OrientedCloud& cloud, double share) {
  Flags flags;
  for (std::size_t i = 1; i < cloud.points.size(); ++i) {
    const auto f = feature_to(cloud, i);
    if (!reference::cell_of(f, kQuantization)) continue;
    const auto bins = reference::bins_of(f, kQuantization);
    const double turn = reference::turn_units(f.rotation);
    const std::int64_t turn_bin = reference::bin_of(turn, 65536.0 / kRotationBins).index;
    for (const auto b0 : looked_up_bins(bins[0], share, kQuantization.num_distance_bins)) {
      for (const auto b1 : looked_up_bins(bins[1], share, kQuantization.num_angle_bins)) {
        for (const auto b2 : looked_up_bins(bins[2], share, kQuantization.num_angle_bins)) {
          for (const auto b3 : looked_up_bins(bins[3], share, kQuantization.num_angle_bins)) {
            const auto cell = reference::cell_of_bins({b0, b1, b2, b3}, kQuantization);
            const auto [at, fresh] = flags.try_emplace({*cell, turn_bin}, turn);
            if (!fresh) at->second = std::min(at->second, turn);
          }
        }
      }
    }
  }
  return flags;
}

TEST(SceneVotes, AreTheNeighborCellsOfTheNaiveEnumeration) {
  for (const float share : {0.0F, 0.1F, 0.3F, 0.5F}) {
    for (const std::size_t n : {1U, 2U, 7U, 65U, 600U}) {
      Random random(n);
      const OrientedCloud cloud = clear_cloud(random, n, share);
      const std::vector<SceneVote> votes = collect(cloud, share);
      const Flags expected = naive_votes(cloud, static_cast<double>(share));
      ASSERT_EQ(votes.size(), expected.size());
      std::size_t k = 0;
      for (const auto& [flag, turn] : expected) {  // a map: by cell, then rotation bin
        EXPECT_EQ(votes[k].cell, flag.first);
        EXPECT_EQ(votes[k].rotation >> kRotationShift, flag.second);
        EXPECT_LE(reference::units_between(votes[k].rotation, turn), 2);
        ++k;
      }
    }
  }
}

TEST(SceneVotes, AreOneCellAtLeastAndSixteenAtMostForAPair) {
  std::map<std::size_t, int> occurrences;
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Random random(trial);
    const OrientedCloud cloud = test::random_oriented(random, 2, 0.7F);
    const std::size_t count = collect(cloud, 0.3F).size();
    ++occurrences[count];
  }
  for (const std::size_t count : {1U, 2U, 4U, 8U, 16U}) EXPECT_GT(occurrences[count], 0) << count;
  EXPECT_EQ(occurrences.size(), 5U);
}

// A large flat region repeats the same pair, whose vote counts once.
TEST(SceneVotes, HoldEachCellAndRotationBinOnce) {
  OrientedCloud plate;
  for (int y = -30; y <= 30; ++y) {
    for (int x = -30; x <= 30; ++x) {
      plate.points.push_back({static_cast<float>(x) * 0.05F, static_cast<float>(y) * 0.05F, 0});
      plate.normals.push_back({0, 0, 1});
    }
  }
  std::swap(plate.points.span().x[0],
            plate.points.span().x[30 * 61 + 30]);  // moves the middle point to the front
  std::swap(plate.points.span().y[0], plate.points.span().y[30 * 61 + 30]);
  const std::vector<SceneVote> votes = collect(plate, 0);
  // All angles are 0 or right angles: a distance bin has one cell with 32 rotations.
  EXPECT_LE(votes.size(), 9U * kRotationBins);
  EXPECT_GT(votes.size(), 6U * kRotationBins);
  for (std::size_t k = 1; k < votes.size(); ++k) {
    EXPECT_LT(std::pair(votes[k - 1].cell, votes[k - 1].rotation >> kRotationShift),
              std::pair(votes[k].cell, votes[k].rotation >> kRotationShift));
  }
}

TEST(SceneVotes, DoNotDependOnTheOrderOfTheNeighbors) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 300);
  std::vector<std::uint32_t> order = random.permutation(300);
  std::swap(*std::ranges::find(order, 0U), order[0]);
  const OrientedCloud shuffled{test::permuted(cloud.points, order),
                               test::permuted(cloud.normals, order)};
  const auto a = collect(cloud, 0.3F), b = collect(shuffled, 0.3F);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].cell, b[k].cell);
    EXPECT_EQ(a[k].rotation, b[k].rotation);
  }
}

TEST(SceneVotes, AllocateNothingOnceWarm) {
  Random random;
  const OrientedCloud cloud = test::random_oriented(random, 300);
  Scratch scratch(300);
  const auto run = [&] {
    collect_scene_votes(reference_frame(cloud.points[0], cloud.normals[0]),
                        {cloud.points, cloud.normals}, {kQuantization, 0.3F}, scratch.pairs,
                        scratch.keys, scratch.votes);
  };
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels
