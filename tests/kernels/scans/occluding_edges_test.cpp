#include "kernels/scans/occluding_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "kernels/scans/estimate_normals_grid.hpp"
#include "support/random.hpp"
#include "support/rendered_bodies.hpp"

namespace trivet::kernels {
namespace {

using test::Body;

constexpr float kTurn = 0.4F;                                             // of the sheet [rad]
constexpr float kHalfLength = 0.08F, kHalfWidth = 0.05F, kFace = 0.594F;  // [m]
constexpr float kPixel = 0.6F / 150;

/// A sheet of 6 mm that lies on a table, turned.
RangeImage sheet() {
  static const Body body({kHalfLength, kHalfWidth, 0.003F});
  return test::render({{&body, test::pose_of({0, 0, kTurn}, {0, 0, 0.597F})}}, 0.6F);
}

/// Fit the normals of an image.
void fit_normals(RangeImage& image) {
  const std::size_t n = image.depth.size();
  Points points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(image.geometry.back_project(i, image.depth[i]));
  PixelGrid grid;
  grid.width = image.geometry.width;
  grid.height = image.geometry.height;
  grid.point_index.resize(n);
  std::iota(grid.point_index.begin(), grid.point_index.end(), 0U);
  PixelPoints pixels;
  arrange_pixels(grid, points, pixels);
  estimate_normals_grid({grid, pixels, Eigen::Vector3f::Zero()}, {.window = 2}, 0,
                        image.geometry.height, image.normals);
}

struct FoundEdges {
  Points points;
  Normals directions;
};

FoundEdges find(const RangeImage& image, std::size_t rows_at_a_time = 1000) {
  const SensorModel sensor{.range = 0.6F, .noise = 0.0005F};
  FoundEdges edges;
  const std::size_t height = image.geometry.height;
  for (std::size_t v = 0; v < height; v += rows_at_a_time)
    find_occluding_edges(image, {sensor, 0.4F}, v, std::min(rows_at_a_time, height - v),
                         edges.points, edges.directions);
  return edges;
}

Eigen::Vector2f in_sheet(const Eigen::Vector3f& v) {
  return Eigen::Rotation2Df(-kTurn) * v.head<2>();
}

TEST(OccludingEdges, OfASheetPointOutOfItsFourSides) {
  RangeImage image = sheet();
  fit_normals(image);
  const FoundEdges edges = find(image);
  std::array<int, 4> of_side{};
  int oblique = 0;
  for (std::size_t i = 0; i < edges.points.size(); ++i) {
    const Eigen::Vector2f p = in_sheet(edges.points[i]), out = in_sheet(edges.directions[i]);
    EXPECT_NEAR(edges.points[i].z(), kFace, 1e-4F);
    EXPECT_NEAR(edges.directions[i].norm(), 1, 1e-5F);
    const float to_end = kHalfLength - std::abs(p.x()), to_side = kHalfWidth - std::abs(p.y());
    EXPECT_LT(std::min(to_end, to_side), 1.5F * kPixel) << p.transpose();
    if (std::max(to_end, to_side) < 6 * kPixel) continue;  // at a corner, of two sides
    const bool is_end = to_end < to_side;
    const float cosine =
        is_end ? std::copysign(out.x(), out.x() * p.x()) : std::copysign(out.y(), out.y() * p.y());
    oblique += cosine < std::cos(0.2F) ? 1 : 0;  // a cell of point pairs
    ++of_side[is_end ? (p.x() > 0 ? 0U : 1U) : (p.y() > 0 ? 2U : 3U)];
  }
  for (const int count : of_side) EXPECT_GT(count, 8);
  EXPECT_LT(oblique, 8);
}

TEST(OccludingEdges, AreNotWhereSomethingNearerHidesAFace) {
  static const Body body({kHalfLength, kHalfWidth, 0.003F}), cover({0.06F, 0.1F, 0.01F});
  const Pose on_table = test::pose_of({0, 0, 0}, {0, 0, 0.597F});
  RangeImage image =
      test::render({{&body, on_table}, {&cover, test::pose_of({0, 0, 0}, {0.06F, 0, 0.5F})}}, 0.6F);
  fit_normals(image);
  const FoundEdges edges = find(image);
  int of_sheet = 0;
  for (std::size_t i = 0; i < edges.points.size(); ++i) {
    if (std::abs(edges.points[i].z() - kFace) > 0.002F) continue;
    ++of_sheet;
    EXPECT_FALSE(edges.directions[i].x() > 0.9F) << "it points beneath the cover";
  }
  EXPECT_GT(of_sheet, 30);
}

TEST(OccludingEdges, AreNotWhereASurfaceBendsAwayNorInNoise) {
  static const Body rod = test::rod_of(0.1F, 0.15F);
  RangeImage image = test::render({{&rod, test::pose_of({0, 0, 0}, {0, 0, 0.6F})}}, 1);
  fit_normals(image);
  const FoundEdges edges = find(image);
  EXPECT_GT(edges.points.size(), 10U) << "its ends";
  for (std::size_t i = 0; i < edges.points.size(); ++i)
    EXPECT_GT(std::abs(edges.directions[i].x()), 0.5F);

  RangeImage table = test::render({}, 0.6F);
  test::Random random;
  for (float& d : table.depth) d += random.normal(0.0003F);
  fit_normals(table);
  EXPECT_EQ(find(table).points.size(), 0U);
}

TEST(OccludingEdges, AreSeenOverPixelsThatSensorsLoseThere) {
  const RangeImage whole = sheet();
  RangeImage image = whole;
  fit_normals(image);
  const std::size_t all = find(image).points.size();
  for (std::size_t i = 1; i + 1 < image.depth.size(); ++i) {
    if (whole.depth[i] > whole.depth[i - 1] + 0.001F ||
        whole.depth[i] > whole.depth[i + 1] + 0.001F)
      image.depth[i] = 0;
  }
  EXPECT_GT(find(image).points.size(), all / 2);
}

/// The same in double: the mean place of what lies on the face within a disk of 5 pixels.
struct EdgeReference {
  const RangeImage& image;
  double tolerance;  // three deviations

  double depth(int u, int v) const {
    const auto& g = image.geometry;
    if (u < 0 || v < 0 || u >= static_cast<int>(g.width) || v >= static_cast<int>(g.height))
      return 0;
    return static_cast<double>(
        image.depth[static_cast<std::size_t>(v) * g.width + static_cast<std::size_t>(u)]);
  }
  Eigen::Vector3d point(int u, int v) const {
    const auto& g = image.geometry;
    const double z = depth(u, v);
    return {(u - static_cast<double>(g.cx)) * z / static_cast<double>(g.fx),
            (v - static_cast<double>(g.cy)) * z / static_cast<double>(g.fy), z};
  }
  /// Whether an edge is at a pixel in one of four directions, which must not be close to a limit.
  bool find(int u, int v, Eigen::Vector3d& out) const {
    for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = u + du, y = v + dv, u0 = u - 3 * du, v0 = v - 3 * dv;
      if (!(depth(x, y) > depth(u, v) + tolerance) || !(depth(u0, v0) > 0)) continue;
      const Eigen::Vector3d n = image
                                    .normals[static_cast<std::size_t>(v0) * image.geometry.width +
                                             static_cast<std::size_t>(u0)]
                                    .cast<double>();
      const double offset = n.dot(point(u0, v0));
      if (!(-n.dot(point(u0, v0).normalized()) > 0.5)) continue;
      const auto height = [&](int i, int j) { return n.dot(point(i, j)) - offset; };
      if (std::abs(height(u, v)) > tolerance ||
          !(height(x, y) < std::min(height(u, v), 0.0) - tolerance))
        continue;
      Eigen::Vector3d inward = Eigen::Vector3d::Zero();
      double on = 0, behind = 0, before = 0;
      for (int i = -5; i <= 5; ++i) {
        for (int j = -5; j <= 5; ++j) {
          if (i * i + j * j > 25 || !(depth(u + i, v + j) > 0)) continue;
          const double h = height(u + i, v + j);
          (h < -tolerance ? behind : h > tolerance ? before : on) += 1;
          if (std::abs(h) <= tolerance) inward += point(u + i, v + j) - point(u, v);
        }
      }
      if (on < 0.2 * 81 || behind < 0.15 * 81 || before > 0.1 * 81) continue;
      out = -(inward - n * n.dot(inward)).normalized();
      return true;
    }
    return false;
  }
};

TEST(OccludingEdges, AreThoseOfANaiveReferenceWhateverTheChunks) {
  RangeImage image = sheet();
  test::Random random;
  for (float& d : image.depth) d = random.below(40) == 0 ? d : d + random.normal(2e-4F);
  fit_normals(image);
  const FoundEdges edges = find(image), of_rows = find(image, 7);
  ASSERT_EQ(edges.points.size(), of_rows.points.size());
  for (std::size_t i = 0; i < edges.points.size(); ++i) {
    EXPECT_EQ(edges.points[i], of_rows.points[i]);
    EXPECT_EQ(edges.directions[i], of_rows.directions[i]);
  }
  const EdgeReference reference{image, 3 * 0.0005};
  std::size_t k = 0;
  for (int v = 0; v < static_cast<int>(image.geometry.height); ++v) {
    for (int u = 0; u < static_cast<int>(image.geometry.width); ++u) {
      Eigen::Vector3d out;
      if (!reference.find(u, v, out)) continue;
      ASSERT_LT(k, edges.points.size());
      EXPECT_LT((edges.points[k].cast<double>() - reference.point(u, v)).norm(), 1e-6);
      EXPECT_LT((edges.directions[k].cast<double>() - out).norm(), 1e-3);
      ++k;
    }
  }
  EXPECT_EQ(k, edges.points.size());
  EXPECT_GT(k, 100U);
}

}  // namespace
}  // namespace trivet::kernels
