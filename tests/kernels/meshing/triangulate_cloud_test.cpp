#include "kernels/meshing/triangulate_cloud.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "kernels/surfaces/sample_mesh.hpp"
#include "support/random.hpp"
#include "support/reference_mesh.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct Samples {
  Points points;
  Normals normals;  // outward
  float spacing = 0;

  Samples permuted(const std::vector<std::uint32_t>& order) const {
    return {test::permuted(points, order), test::permuted(normals, order), spacing};
  }
};

Samples sample(const test::Shape& shape, std::size_t n, std::uint64_t seed = 1) {
  std::vector<double> sums(shape.triangles.size());
  const double area = sum_areas(shape.vertices, shape.triangles, sums);
  Samples samples{Points(n), Normals(n),
                  static_cast<float>(std::sqrt(area / static_cast<double>(n)))};
  sample_mesh({shape.vertices, shape.triangles, sums}, seed, 0, n,
              {samples.points, samples.normals});
  return samples;
}

/// A torus of this radius and thickness: random points with exact normals.
Samples ring(std::size_t n, float radius, float thickness) {
  test::Random random;
  Samples samples;
  constexpr float turn = 2 * std::numbers::pi_v<float>;
  while (samples.points.size() < n) {
    const float u = random.uniform(0, turn), v = random.uniform(0, turn);
    const float out = radius + thickness * std::cos(v);
    if (random.uniform(0, radius + thickness) > out) continue;  // uniform over the area
    const Vector3f axis(std::cos(u), std::sin(u), 0);
    samples.normals.push_back(std::cos(v) * axis + std::sin(v) * Vector3f::UnitZ());
    samples.points.push_back(radius * axis + thickness * samples.normals[samples.points.size()]);
  }
  samples.spacing = turn * std::sqrt(radius * thickness / static_cast<float>(n));
  return samples;
}

Triangles triangulate(const Samples& samples, const TriangulateOptions& options = {}) {
  return *triangulate_cloud(samples.points, find_delaunay(samples.points), samples.normals,
                            options);
}

Mesh mesh_of(const Samples& samples) { return {samples.points, triangulate(samples)}; }

double longest_edge(const Mesh& mesh) {
  double longest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = reference::corners(mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f edge = mesh.vertices[c[k]] - mesh.vertices[c[(k + 1) % 3]];
      longest = std::max(longest, static_cast<double>(edge.norm()));
    }
  }
  return longest;
}

/// Triangles by the coordinates of their corners, independent of the order of vertices.
std::multiset<std::vector<float>> by_coordinates(const Mesh& mesh) {
  std::multiset<std::vector<float>> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto c = reference::corners(mesh, t);
    std::vector<std::vector<float>> corners;
    for (const std::uint32_t v : c)
      corners.push_back({mesh.vertices[v].x(), mesh.vertices[v].y(), mesh.vertices[v].z()});
    std::ranges::rotate(corners, std::ranges::min_element(corners));  // keeps the winding
    std::vector<float> flat;
    for (const auto& corner : corners) flat.insert(flat.end(), corner.begin(), corner.end());
    all.insert(flat);
  }
  return all;
}

TEST(TriangulateCloud, ClosesASphereOfRandomPoints) {
  for (const std::size_t n : {100U, 1000U, 3000U}) {
    SCOPED_TRACE(n);
    const Mesh mesh = mesh_of(sample(test::ellipsoid({1, 1, 1}), n));
    EXPECT_TRUE(reference::is_closed_manifold(mesh));
    EXPECT_EQ(reference::euler_characteristic(mesh), 2);
    const double volume = 4 * std::numbers::pi / 3;
    EXPECT_NEAR(reference::volume(mesh), volume, 20.0 / static_cast<double>(n) * volume);
  }
}

TEST(TriangulateCloud, ClosesATorusWithItsHole) {
  const Mesh mesh = mesh_of(ring(3000, 1, 0.35F));
  EXPECT_TRUE(reference::is_closed_manifold(mesh));
  EXPECT_EQ(reference::euler_characteristic(mesh), 0);
  const double volume = 2 * std::numbers::pi * std::numbers::pi * 0.35 * 0.35;
  EXPECT_NEAR(reference::volume(mesh), volume, 0.02 * volume);
}

TEST(TriangulateCloud, ClosesRegularSamples) {
  // Exact ties everywhere: the surface of a cube of 8 cells per side.
  Samples cube;
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const Eigen::Array3i at(i % 9, i / 9 % 9, i / 81);
    if ((at > 0 && at < 8).all()) continue;
    cube.points.push_back(at.cast<float>().matrix());
    const Vector3f outward = ((at == 8).cast<float>() - (at == 0).cast<float>()).matrix();
    cube.normals.push_back(outward.normalized());
  }
  const Mesh mesh = mesh_of(cube);
  EXPECT_TRUE(reference::is_closed_manifold(mesh));
  EXPECT_EQ(reference::euler_characteristic(mesh), 2);
  EXPECT_EQ(reference::volume(mesh), 512) << "edges are sharp";
}

TEST(TriangulateCloud, KeepsTheEdgesOfABoxSharp) {
  const test::Shape box = test::box({-0.5F, -0.3F, -0.2F}, {0.5F, 0.3F, 0.2F});
  const Samples samples = sample(box, 2600);
  const Mesh mesh = mesh_of(samples);
  EXPECT_LE(reference::count_open_edges(mesh.triangles), 20U) << "of 7800";
  // Triangles between points of a convex body lie in it; the volume that they cut off lies along
  // the edges.
  const double volume = 1.0 * 0.6 * 0.4;
  const double edges = 4 * (1.0 + 0.6 + 0.4);
  EXPECT_LT(reference::volume(mesh), volume);
  EXPECT_GT(reference::volume(mesh), volume - 0.5 * edges * samples.spacing * samples.spacing);
  EXPECT_LT(longest_edge(mesh), 5 * samples.spacing);
}

TEST(TriangulateCloud, KeepsTheSheetsOfAThinPlateApart) {
  // Two open sheets, closer to each other than the spacing of their points.
  test::Random random;
  Samples plate;
  plate.spacing = 1.0F / 30;
  for (int i = 0; i < 1800; ++i) {
    const float side = i % 2 == 0 ? 1.0F : -1.0F;
    plate.points.push_back(
        {random.uniform(0, 1), random.uniform(0, 1), side * 0.25F * plate.spacing});
    plate.normals.push_back({0, 0, side});
  }
  const Triangles triangles = triangulate(plate);
  std::size_t num_joining = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array c{triangles.a[t], triangles.b[t], triangles.c[t]};
    bool inside = true;
    for (const std::uint32_t v : c) {
      const Vector3f p = plate.points[v];
      inside &= std::min({p.x(), p.y(), 1 - p.x(), 1 - p.y()}) > 4 * plate.spacing;
    }
    const bool joins = c[0] % 2 != c[1] % 2 || c[1] % 2 != c[2] % 2;
    if (inside && joins) ++num_joining;
  }
  EXPECT_GT(triangles.size(), 3000U);
  EXPECT_LE(num_joining, triangles.size() / 200);
}

TEST(TriangulateCloud, LeavesTheBoundaryOfAPatchOpen) {
  Samples patch;
  for (int i = 0; i < 400; ++i) {
    const float x = static_cast<float>(i % 20), y = static_cast<float>(i / 20);
    patch.points.push_back({x, y, 0});
    patch.normals.push_back({0, 0, 1});
  }
  const Mesh mesh{patch.points, triangulate(patch)};
  EXPECT_EQ(mesh.triangles.size(), 2U * 19 * 19);
  EXPECT_EQ(reference::count_open_edges(mesh.triangles), 4U * 19);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = reference::corners(mesh, t);
    EXPECT_GT((mesh.vertices[c[1]] - mesh.vertices[c[0]])
                  .cross(mesh.vertices[c[2]] - mesh.vertices[c[0]])
                  .z(),
              0)
        << "counter-clockwise";
  }
}

TEST(TriangulateCloud, DoesNotCoverTheBackOfASmallPatch) {
  // The boundary is shorter than those of the holes that are filled.
  Samples patch;
  for (int i = 0; i < 9; ++i) {
    patch.points.push_back({static_cast<float>(i % 3), static_cast<float>(i / 3), 0});
    patch.normals.push_back({0, 0, 1});
  }
  const Triangles triangles = triangulate(patch);
  EXPECT_EQ(triangles.size(), 8U);
  EXPECT_EQ(reference::count_open_edges(triangles), 8U);
}

TEST(TriangulateCloud, LeavesAWideGapOpen) {
  Samples patch;
  for (int i = 0; i < 900; ++i) {
    const float x = static_cast<float>(i % 30), y = static_cast<float>(i / 30);
    if (std::hypot(x - 15, y - 15) < 6) continue;
    patch.points.push_back({x, y, 0});
    patch.normals.push_back({0, 0, 1});
  }
  EXPECT_GT(reference::count_open_edges(triangulate(patch)), 4U * 29 + 20);
  EXPECT_LT(longest_edge(mesh_of(patch)), 3);
}

TEST(TriangulateCloud, FillsHolesOfFewEdges) {
  // A lens thinner than its point spacing: balls through one side contain points of the other.
  const Samples lens = sample(test::ellipsoid({1, 1, 0.04F}), 1500);
  const std::size_t left = reference::count_open_edges(triangulate(lens, {.max_hole_edges = 0}));
  EXPECT_GT(left, 20U);
  EXPECT_LT(reference::count_open_edges(triangulate(lens)), 3 * left / 4);
}

TEST(TriangulateCloud, DoesNotDependOnTheOrderOfThePoints) {
  const Samples samples = sample(test::ellipsoid({1, 0.7F, 0.4F}), 800);
  const auto expected = by_coordinates(mesh_of(samples));
  test::Random random;
  for (int trial = 0; trial < 3; ++trial)
    EXPECT_EQ(by_coordinates(mesh_of(samples.permuted(random.permutation(800)))), expected);
}

TEST(TriangulateCloud, MovesAndScalesWithTheCloud) {
  // The lattice rounds to 2^-20 of the extent, so ties between random points are very unlikely.
  const Samples samples = sample(test::ellipsoid({1, 0.7F, 0.4F}), 800);
  const Triangles triangles = triangulate(samples);
  const auto as_set = [](const Triangles& all) {
    std::set<std::set<std::uint32_t>> sets;
    for (std::size_t t = 0; t < all.size(); ++t) sets.insert({all.a[t], all.b[t], all.c[t]});
    return sets;
  };
  test::Random random;
  for (const float scale : {1.0F, 1e-3F, 1e4F}) {
    const Pose motion = random.motion();
    Samples moved;
    moved.points =
        test::transformed(samples.points, scale * motion.linear(), scale * motion.translation());
    moved.normals = test::transformed(samples.normals, motion.linear(), Vector3f::Zero());
    EXPECT_EQ(as_set(triangulate(moved)), as_set(triangles)) << scale;
  }
}

TEST(TriangulateCloud, AcceptsDuplicatesStrayPointsAndNone) {
  Samples samples = sample(test::ellipsoid({1, 1, 1}), 500);
  const auto expected = by_coordinates(mesh_of(samples));
  for (std::size_t i = 0; i < 500; i += 2) {
    samples.points.push_back(samples.points[i]);
    samples.normals.push_back(samples.normals[i]);
  }
  EXPECT_EQ(by_coordinates(mesh_of(samples)), expected);
  samples.points.push_back(Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  samples.normals.push_back({0, 0, 1});
  EXPECT_EQ(by_coordinates(mesh_of(samples)), expected);
  samples.points.push_back({5, 0, 0});
  samples.normals.push_back({1, 0, 0});
  const Triangles triangles = triangulate(samples);
  EXPECT_EQ(reference::count_open_edges(triangles), 0U);
  EXPECT_EQ(std::ranges::count(triangles.a, samples.points.size() - 1), 0) << "far from the rest";

  for (std::size_t n = 0; n < 3; ++n)
    EXPECT_TRUE(triangulate(sample(test::tetrahedron(), n)).empty());
  Samples line;
  for (int i = 0; i < 20; ++i) {
    line.points.push_back({static_cast<float>(i), 0, 0});
    line.normals.push_back({0, 0, 1});
  }
  EXPECT_TRUE(triangulate(line).empty());
}

TEST(TriangulateCloud, AcceptsUnknownNormals) {
  Samples samples = sample(test::ellipsoid({1, 0.7F, 0.4F}), 1000);
  for (std::size_t i = 0; i < 1000; i += 3)
    samples.normals.set(i, Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  const Mesh mesh = mesh_of(samples);
  EXPECT_TRUE(reference::is_closed_manifold(mesh));
  EXPECT_GT(reference::volume(mesh), 0) << "wound outward by those that are known";
}

TEST(OrientByEmptySpace, TurnsNormalsToTheOutside) {
  Samples samples = ring(2000, 1, 0.35F);
  test::Random random;
  Normals turned = samples.normals;
  for (std::size_t i = 0; i < turned.size(); ++i)
    if (random.below(2) == 0) turned.set(i, -turned[i]);
  const Delaunay delaunay = find_delaunay(samples.points);
  ASSERT_TRUE(orient_by_empty_space(samples.points, delaunay, 2.5F, turned));
  std::size_t num_right = 0;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    EXPECT_FALSE(turned[i].dot(samples.normals[i]) < 0) << i;
    if (turned[i].dot(samples.normals[i]) > 0) ++num_right;
  }
  EXPECT_GT(num_right, 1600U);
}

TEST(OrientByEmptySpace, KnowsNoOutsideOfAnOpenSheet) {
  test::Random random;
  Points sheet;
  Normals normals;
  for (int i = 0; i < 500; ++i) {
    sheet.push_back({random.uniform(-1, 1), random.uniform(-1, 1), 0});
    normals.push_back({0, 0, 1});
  }
  ASSERT_TRUE(orient_by_empty_space(sheet, find_delaunay(sheet), 2.5F, normals));
  EXPECT_GT(std::ranges::count_if(normals.view().z, [](float z) { return std::isnan(z); }), 450);
}

}  // namespace
}  // namespace trivet::kernels
