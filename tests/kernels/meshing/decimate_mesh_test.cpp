#include "kernels/meshing/decimate_mesh.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "kernels/simulation/mesh_solid.hpp"
#include "support/random_solid.hpp"
#include "support/reference_mesh.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Random;

constexpr float kNoBound = std::numeric_limits<float>::infinity();

Mesh decimate(const Mesh& mesh, std::size_t num_triangles, float max_error = kNoBound) {
  return decimate_mesh(mesh.vertices, mesh.triangles, num_triangles, max_error);
}

/// A flat patch of n x n squares with side 1, in a plane oblique to all axes.
Mesh patch(std::uint32_t n, const Pose& pose) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      mesh.vertices.push_back(pose * Vector3f(static_cast<float>(x) / static_cast<float>(n),
                                              static_cast<float>(y) / static_cast<float>(n), 0));
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x;
      mesh.triangles.push_back(i, i + 1, i + n + 2);
      mesh.triangles.push_back(i, i + n + 2, i + n + 1);
    }
  }
  return mesh;
}

Vector3d area_vector(const Mesh& mesh, std::size_t t) {
  const Vector3d a = reference::corner(mesh.vertices, mesh.triangles.a, t);
  return (reference::corner(mesh.vertices, mesh.triangles.b, t) - a)
             .cross(reference::corner(mesh.vertices, mesh.triangles.c, t) - a) /
         2;
}

TEST(DecimateMesh, ClosedManifoldsStaySoWithTheirGenus) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Mesh fine = mesh_solid(test::random_solid(random), 0.06F);
    if (fine.triangles.empty()) continue;
    for (const std::size_t target : {fine.triangles.size() / 2, std::size_t{200}, std::size_t{1}}) {
      const Mesh thin = decimate(fine, target);
      EXPECT_TRUE(reference::is_closed_manifold(thin));
      EXPECT_EQ(reference::euler_characteristic(thin), reference::euler_characteristic(fine));
      EXPECT_EQ(reference::num_pieces(thin), reference::num_pieces(fine));
      EXPECT_LE(thin.triangles.size(), fine.triangles.size());
    }
  }
}

TEST(DecimateMesh, ReachesTheNumberAskedFor) {
  const Mesh fine = mesh_solid(torus(0.7F, 0.25F), 0.05F);
  for (const std::size_t target : {2000, 1001, 300, 100}) {
    const Mesh thin = decimate(fine, target);
    EXPECT_LE(thin.triangles.size(), target);
    EXPECT_GE(thin.triangles.size(), target - 1);
  }
}

// Fewer triangles are a matter of chance: below some sixty, the next possible collapse may be at a
// corner.
TEST(DecimateMesh, ABoxKeepsItsCornersInAHundredTriangles) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const Solid solid = moved(box({0.5F, 0.3F, 0.2F}), test::random_pose(random, 0.5F));
    const Mesh fine = mesh_solid(solid, 0.04F);
    const Mesh thin = decimate(fine, 100);
    EXPECT_LE(thin.triangles.size(), 100U);
    EXPECT_NEAR(reference::volume(thin), reference::volume(fine), 1e-3 * 0.24) << "seed " << seed;
  }
}

TEST(DecimateMesh, KeepsWithinTheErrorBound) {
  const Mesh fine = mesh_solid(torus(0.7F, 0.25F), 0.05F);
  std::size_t fewer = fine.triangles.size();
  for (const float bound : {1e-4F, 1e-3F, 1e-2F}) {
    const Mesh thin = decimate(fine, 0, bound);
    EXPECT_LT(thin.triangles.size(), fewer);
    fewer = thin.triangles.size();
    // Measured both ways: no bump appears and none is lost.
    double worst = 0;
    for (std::size_t i = 0; i < thin.vertices.size(); i += 3)
      worst = std::max(worst, reference::distance_to_mesh(thin.vertices[i].cast<double>(), fine));
    for (std::size_t i = 0; i < fine.vertices.size(); i += 7)
      worst = std::max(worst, reference::distance_to_mesh(fine.vertices[i].cast<double>(), thin));
    EXPECT_LT(worst, 1.5 * static_cast<double>(bound));
  }
}

TEST(DecimateMesh, NoTriangleTurnsOver) {
  Random random;
  const Pose pose = test::random_pose(random, 1);
  const Mesh thin = decimate(patch(20, pose), 10);
  const Vector3d up = pose.linear().cast<double>() * Vector3d::UnitZ();
  double area = 0;
  for (std::size_t t = 0; t < thin.triangles.size(); ++t) {
    EXPECT_GT(area_vector(thin, t).dot(up), 0);
    area += area_vector(thin, t).norm();
  }
  EXPECT_NEAR(area, 1, 1e-5);  // the border is still a square
  EXPECT_LE(thin.triangles.size(), 10U);
}

// Where no error guides the decimation, collapses about corners and notches fold the surface.
TEST(DecimateMesh, AFlatSheetOfUnevenTrianglesDoesNotFold) {
  constexpr std::uint32_t kSide = 40;
  Random random;
  const Mesh full = patch(kSide, Pose::Identity());
  Mesh sheet{full.vertices, {}};
  for (std::size_t i = 0; i < sheet.vertices.size(); ++i) {
    const Vector3f offset(random.uniform(-0.3F, 0.3F), random.uniform(-0.3F, 0.3F), 0);
    sheet.vertices.set(i, sheet.vertices[i] + offset / kSide);
  }
  for (std::size_t t = 0; t < full.triangles.size(); ++t) {
    const std::size_t square = t / 2, x = square % kSide, y = square / kSide;
    if (x / 3 % 2 == 1 && y > kSide / 2) continue;
    const auto c = reference::corners(full, t);
    sheet.triangles.push_back(c[0], c[1], c[2]);
  }
  for (const std::size_t target : {500, 200, 50}) {
    const Mesh thin = decimate(sheet, target);
    for (std::size_t t = 0; t < thin.triangles.size(); ++t)
      ASSERT_GT(area_vector(thin, t).z(), 0) << target;
  }
}

TEST(DecimateMesh, ReturnsTheMeshIfThereIsNothingToDo) {
  const Mesh mesh = patch(3, Pose::Identity());
  const Mesh same = decimate(mesh, 18);
  ASSERT_EQ(same.vertices.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_EQ(same.vertices[i], mesh.vertices[i]);
  EXPECT_EQ(same.triangles.a, mesh.triangles.a);
  EXPECT_EQ(same.triangles.b, mesh.triangles.b);
  EXPECT_EQ(same.triangles.c, mesh.triangles.c);
  EXPECT_TRUE(decimate({}, 0).vertices.empty());
}

TEST(DecimateMesh, TheSmallestPiecesRemain) {
  Mesh mesh;  // a tetrahedron and a triangle
  for (const Vector3f& p :
       {Vector3f(0, 0, 0), Vector3f(1, 0, 0), Vector3f(0, 1, 0), Vector3f(0, 0, 1),
        Vector3f(5, 0, 0), Vector3f(6, 0, 0), Vector3f(5, 1, 0)})
    mesh.vertices.push_back(p);
  for (const auto& [a, b, c] :
       {std::array{0U, 2U, 1U}, std::array{0U, 1U, 3U}, std::array{1U, 2U, 3U},
        std::array{2U, 0U, 3U}, std::array{4U, 5U, 6U}})
    mesh.triangles.push_back(a, b, c);
  EXPECT_EQ(decimate(mesh, 0).triangles.size(), 5U);
}

TEST(DecimateMesh, BearsAnyTriangles) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed);
    Mesh mesh;
    for (int i = 0; i < 30; ++i)
      mesh.vertices.push_back(i % 5 == 0 ? Vector3f::Zero().eval() : random.direction());
    for (int t = 0; t < 80; ++t)
      mesh.triangles.push_back(random.below(30), random.below(30), random.below(30));
    const Mesh thin = decimate(mesh, 0);
    for (std::size_t t = 0; t < thin.triangles.size(); ++t) {
      const auto c = reference::corners(thin, t);
      EXPECT_TRUE(c[0] != c[1] && c[1] != c[2] && c[2] != c[0]);
      EXPECT_LT(std::max({c[0], c[1], c[2]}), thin.vertices.size());
    }
  }
}

}  // namespace
}  // namespace trivet::kernels
