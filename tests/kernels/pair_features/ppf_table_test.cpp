#include "kernels/pair_features/ppf_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::OrientedCloud;
using test::Random;

const PpfQuantization kQuantization{0.3F, 9, 6};  // pairs of up to 2.7; the clouds reach 3.4

struct Table {
  std::vector<std::uint32_t> offsets;
  std::vector<PpfEntry> entries;
  bool operator==(const Table&) const = default;
};

/// The table of point pairs that start at the first num_references points.
Table build(const PpfPoints& model, std::size_t num_references, std::size_t num_chunks) {
  const std::size_t num_cells = kQuantization.num_cells();
  const auto chunk_first = [&](std::size_t chunk) { return num_references * chunk / num_chunks; };
  PairScratch scratch(model.points.size());
  std::vector<std::uint32_t> counts(num_chunks * num_cells, 0);
  const auto row = [&](std::size_t chunk) {
    return std::span(counts).subspan(chunk * num_cells, num_cells);
  };
  for (std::size_t c = 0; c < num_chunks; ++c) {
    count_ppf_pairs({model, kQuantization, chunk_first(c), chunk_first(c + 1) - chunk_first(c)},
                    scratch, row(c));
  }
  Table table;
  table.offsets.resize(num_cells + 1);
  table.entries.resize(scan_ppf_counts(counts, num_chunks, table.offsets));
  for (std::size_t c = num_chunks; c-- > 0;) {  // chunks may be filled in any order
    fill_ppf_entries({model, kQuantization, chunk_first(c), chunk_first(c + 1) - chunk_first(c)},
                     scratch, row(c), table.entries);
  }
  sort_ppf_cells(table.offsets, 0, num_cells, table.entries);
  return table;
}

/// A random cloud without pairs so close to a bin border that rounding chooses their cell.
OrientedCloud clear_cloud(Random& random, std::size_t n) {
  OrientedCloud cloud;
  while (cloud.points.size() < n) {
    const OrientedCloud one = test::random_oriented(random, 1);
    const Vector3f p = one.points[0], m = one.normals[0];
    bool clear = true;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3f q = cloud.points[i], k = cloud.normals[i];
      const Pose any = Pose::Identity();
      clear = clear &&
              !reference::near_border(reference::pair_feature(p, m, q, k, any), kQuantization) &&
              !reference::near_border(reference::pair_feature(q, k, p, m, any), kQuantization);
    }
    if (!clear) continue;
    cloud.points.push_back(p);
    cloud.normals.push_back(m);
  }
  return cloud;
}

struct NaiveEntry {
  std::uint32_t reference;
  double angle;  // in 2^-16 of a turn
};
using NaiveTable = std::map<std::uint32_t, std::vector<NaiveEntry>>;

template <class Keep>
NaiveTable naive_table(const OrientedCloud& model, Keep&& keep) {
  NaiveTable table;
  for (std::uint32_t r = 0; r < model.points.size(); ++r) {
    const Pose T = frame_pose(reference_frame(model.points[r], model.normals[r]));
    for (std::uint32_t i = 0; i < model.points.size(); ++i) {
      if (i == r || !keep(r, i)) continue;
      const auto f = reference::pair_feature(model.points[r], model.normals[r], model.points[i],
                                             model.normals[i], T);
      const auto cell = reference::cell_of(f, kQuantization);
      if (cell) table[*cell].push_back({r, reference::turn_units(f.rotation)});
    }
  }
  return table;
}

/// Expects each entry of a table in the naive table and the other way round.
void expect_equal(const Table& table, NaiveTable naive) {
  ASSERT_EQ(table.offsets.front(), 0U);
  ASSERT_EQ(table.offsets.back(), table.entries.size());
  for (std::uint32_t cell = 0; cell < kQuantization.num_cells(); ++cell) {
    std::vector<NaiveEntry>& expected = naive[cell];
    ASSERT_EQ(table.offsets[cell + 1] - table.offsets[cell], expected.size()) << cell;
    for (std::uint32_t e = table.offsets[cell]; e < table.offsets[cell + 1]; ++e) {
      const PpfEntry entry = table.entries[e];
      const auto match = std::ranges::find_if(expected, [&](const NaiveEntry& other) {
        return other.reference == entry.reference &&
               reference::units_between(entry.angle, other.angle) < 1;
      });
      ASSERT_NE(match, expected.end()) << cell << ' ' << entry.reference;
      expected.erase(match);
    }
  }
}

TEST(PpfTable, HoldsAllPairsOfRandomModels) {
  for (const std::size_t n : {0U, 1U, 2U, 3U, 17U, 80U}) {
    Random random(n);
    const OrientedCloud model = clear_cloud(random, n);
    const Table table = build({model.points, model.normals, {}}, n, 1);
    expect_equal(table, naive_table(model, [](auto, auto) { return true; }));
    EXPECT_EQ(table.entries.empty(), n < 2);
  }
}

TEST(PpfTable, IsSortedByCellReferenceAndAngle) {
  Random random;
  // Duplicate points make cells with several entries of one reference.
  OrientedCloud model = test::random_oriented(random, 40);
  for (std::size_t i = 0; i < 80; ++i) {
    model.points.push_back(model.points[i % 40] + Vector3f::Constant(random.uniform(0, 0.01F)));
    model.normals.push_back(model.normals[i % 40]);
  }
  const Table table = build({model.points, model.normals, {}}, 120, 3);
  std::size_t runs = 0;
  for (std::size_t cell = 0; cell < kQuantization.num_cells(); ++cell) {
    ASSERT_LE(table.offsets[cell], table.offsets[cell + 1]);
    for (std::size_t e = table.offsets[cell] + 1; e < table.offsets[cell + 1]; ++e) {
      const PpfEntry a = table.entries[e - 1], b = table.entries[e];
      ASSERT_LE(std::pair(a.reference, a.angle), std::pair(b.reference, b.angle));
      runs += a.reference == b.reference;
    }
  }
  EXPECT_GT(runs, 100U);
}

TEST(PpfTable, IsTheSameForAnyNumberOfChunks) {
  Random random;
  const OrientedCloud model = test::random_oriented(random, 100);
  const PpfPoints points{model.points, model.normals, {}};
  const Table one = build(points, 100, 1);
  for (const std::size_t num_chunks : {2U, 3U, 7U, 100U}) {
    EXPECT_EQ(build(points, 100, num_chunks), one) << num_chunks;
  }
}

TEST(PpfTable, LeavesOutPairsWithoutACommonView) {
  Random random;
  const OrientedCloud model = clear_cloud(random, 60);
  std::vector<ViewMask> views(60, ViewMask{});
  std::vector<std::vector<int>> views_of(60);
  for (std::size_t i = 0; i < 60; ++i) {
    for (int k = 0; k < 20; ++k) {
      const int view = static_cast<int>(random.below(256));
      views_of[i].push_back(view);
      views[i][static_cast<std::size_t>(view / 64)] |= std::uint64_t{1} << (view % 64);
    }
  }
  std::size_t kept = 0;
  const NaiveTable naive = naive_table(model, [&](std::uint32_t a, std::uint32_t b) {
    const bool together = std::ranges::find_first_of(views_of[a], views_of[b]) != views_of[a].end();
    kept += together;
    return together;
  });
  EXPECT_GT(kept, 1000U);
  EXPECT_LT(kept, 3400U);  // of 3540 pairs
  expect_equal(build({model.points, model.normals, views}, 60, 2), naive);
}

TEST(PpfTable, StartsPairsAtTheReferencesAsked) {
  Random random;
  const OrientedCloud model = clear_cloud(random, 60);
  expect_equal(build({model.points, model.normals, {}}, 20, 2),
               naive_table(model, [](std::uint32_t r, std::uint32_t) { return r < 20; }));
}

TEST(PpfTable, RefusesMoreEntriesThan32BitsCount) {
  std::vector<std::uint32_t> offsets(4);
  std::vector<std::uint32_t> most{1U << 31, 0, (1U << 31) - 1};
  EXPECT_EQ(scan_ppf_counts(most, 1, offsets), 0xFFFFFFFFU);
  EXPECT_EQ(offsets, (std::vector<std::uint32_t>{0, 1U << 31, 1U << 31, 0xFFFFFFFFU}));
  std::vector<std::uint32_t> too_many{1U << 31, 0, 1U << 31};
  EXPECT_EQ(scan_ppf_counts(too_many, 1, offsets), 0U);
}

TEST(PpfTable, CountingFillingAndSortingAllocateNothing) {
  Random random;
  const OrientedCloud model = test::random_oriented(random, 50);
  const PpfPoints points{model.points, model.normals, {}};
  PairScratch scratch(50);
  std::vector<std::uint32_t> counts(kQuantization.num_cells(), 0), offsets(counts.size() + 1);
  std::vector<PpfEntry> entries(50 * 49);
  EXPECT_EQ(test::allocations_in([&] {
              count_ppf_pairs({points, kQuantization, 0, 50}, scratch, counts);
              scan_ppf_counts(counts, 1, offsets);
              fill_ppf_entries({points, kQuantization, 0, 50}, scratch, counts, entries);
              sort_ppf_cells(offsets, 0, counts.size(), entries);
            }),
            0U);
}

const Vector3f kCenter(1, 2, 3);  // of symmetric models

/// Random points and all their images under the symmetry: orbit k is points [k * size, (k + 1) *
/// size).
struct Orbits {
  Points points;
  std::size_t size;
};

Orbits orbits_of(Random& random, const std::vector<Pose>& symmetries, std::size_t count) {
  Orbits orbits{{}, symmetries.size() + 1};
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3f p = kCenter + random.uniform(0.5F, 2) * random.direction();
    orbits.points.push_back(p);
    for (const Pose& S : symmetries) orbits.points.push_back(S * p);
  }
  return orbits;
}

/// Expects a reference in every orbit, and hardly more than one.
void expect_one_of_each_orbit(const Orbits& orbits, const Symmetry& symmetry) {
  std::vector<std::uint8_t> chosen(orbits.points.size(), 2);
  choose_references(orbits.points, symmetry, 0.01F, chosen);
  const std::size_t count = orbits.points.size() / orbits.size;
  std::size_t total = 0;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t here = 0;
    for (std::size_t i = k * orbits.size; i < (k + 1) * orbits.size; ++i) here += chosen[i] != 0;
    EXPECT_GE(here, 1U) << k;
    total += here;
  }
  EXPECT_LT(static_cast<double>(total), 1.15 * static_cast<double>(count));
}

TEST(ChooseReferences, KeepsOneOfEachOrbitOfABox) {
  Random random;
  Symmetry box;
  for (int axis = 0; axis < 3; ++axis) {
    box.poses.push_back(
        test::turn_about(Vector3f::Unit(axis), static_cast<float>(reference::kPi), kCenter));
  }
  expect_one_of_each_orbit(orbits_of(random, box.poses, 300), box);
}

TEST(ChooseReferences, KeepsOneOfEachOrbitOfATwelvefoldAxis) {
  Random random;
  Symmetry gear;
  gear.poses = test::turns(12, random.direction(), kCenter);
  expect_one_of_each_orbit(orbits_of(random, gear.poses, 300), gear);
}

TEST(ChooseReferences, KeepsAllWithoutSymmetry) {
  Random random;
  const Points points = random.surface(50);
  std::vector<std::uint8_t> chosen(50, 2);
  choose_references(points, {}, 0.01F, chosen);
  EXPECT_EQ(std::ranges::count(chosen, 1), 50);
}

// Samples do not map onto samples: there must be a reference near the circle of each position.
TEST(ChooseReferences, KeepsAStripOfARoundBody) {
  for (const bool flips : {false, true}) {
    Random random(flips);
    const Vector3f direction = random.direction();
    Symmetry can;
    can.axis = Symmetry::Axis{direction, kCenter};
    const Vector3f side = direction.unitOrthogonal();
    if (flips) {
      can.poses.push_back(test::turn_about(side, static_cast<float>(reference::kPi), kCenter));
    }
    constexpr float kMargin = 0.05F;
    Points points;
    for (int i = 0; i < 8000; ++i) {  // a cone's wall without a flip, a cylinder's with one
      const float h = random.uniform(-1, 1), turn = random.uniform(0, 6.2831853F);
      const float radius = flips ? 1 : 1 + 0.3F * h;
      points.push_back(kCenter + h * direction +
                       Eigen::AngleAxisf(turn, direction) * (radius * side));
    }
    std::vector<std::uint8_t> chosen(points.size(), 2);
    choose_references(points, can, kMargin, chosen);

    std::vector<float> heights;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (chosen[i] != 0) heights.push_back((points[i] - kCenter).dot(direction));
    }
    // The strip is 2 margins wide out of a circle of 2 pi; flips leave half of it.
    const double expected = 8000 * static_cast<double>(kMargin) / reference::kPi / (flips ? 2 : 1);
    EXPECT_NEAR(static_cast<double>(heights.size()), expected, 0.3 * expected);
    for (float h = flips ? 0.05F : -0.95F; h < 0.95F; h += 0.02F) {
      EXPECT_TRUE(
          std::ranges::any_of(heights, [&](float other) { return std::abs(other - h) < kMargin; }))
          << flips << ' ' << h;
    }
  }
}

/// In order: a marked point stays unless a kept point is near it and has a similar direction.
std::vector<std::uint8_t> naive_spread(const OrientedCloud& cloud, double distance,
                                       std::vector<std::uint8_t> marked) {
  for (std::size_t i = 0; i < marked.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double apart = (cloud.points[i] - cloud.points[k]).cast<double>().norm();
      const double cosine = cloud.normals[i].cast<double>().dot(cloud.normals[k].cast<double>());
      if (marked[k] != 0 && apart <= distance && cosine >= std::sqrt(0.5)) marked[i] = 0;
    }
  }
  return marked;
}

TEST(SpreadReferences, AgreesWithTheNaiveChoice) {
  for (const std::size_t n : {0U, 1U, 2U, 50U, 1000U}) {
    for (const float distance : {0.05F, 0.3F, 5.0F}) {
      Random random(n);
      const OrientedCloud cloud = test::random_oriented(random, n);
      std::vector<std::uint8_t> marked(n);
      for (auto& mark : marked) mark = random.below(4) != 0;
      const auto expected = naive_spread(cloud, static_cast<double>(distance), marked);
      spread_references(cloud.points, cloud.normals, distance, marked);
      EXPECT_EQ(marked, expected) << n << ' ' << distance;
    }
  }
}

TEST(SpreadReferences, KeepsAllAtNoDistanceAndBothSidesOfAWall) {
  OrientedCloud wall;
  for (int i = 0; i < 20; ++i) {
    wall.points.push_back({static_cast<float>(i / 2), 0, i % 2 == 0 ? 0 : 0.01F});
    wall.normals.push_back({0, 0, i % 2 == 0 ? -1.0F : 1.0F});
  }
  std::vector<std::uint8_t> marked(20, 1);
  spread_references(wall.points, wall.normals, 0, marked);
  EXPECT_EQ(std::ranges::count(marked, 1), 20);
  spread_references(wall.points, wall.normals, 0.5F, marked);
  EXPECT_EQ(std::ranges::count(marked, 1), 20) << "a thin wall's sides are near each other";
  spread_references(wall.points, wall.normals, 1.5F, marked);
  EXPECT_EQ(std::ranges::count(marked, 1), 10);
}

}  // namespace
}  // namespace trivet::kernels
