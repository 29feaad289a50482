#include "engine/scene/find_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/meshing/surface_from_points.hpp"
#include "engine/scene/read_scene.hpp"
#include "kernels/meshing/boundary_share.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Parts in front of a wall, scanned from the origin, with triangles between neighboring pixels: a
/// mesh with a very short border.
Cloud triangulated_scan() {
  static const test::Shape bracket = test::bracket(), wall = test::box({-1, -1, 0}, {1, 1, 0.1F});
  const Cloud scan =
      test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.05F, 0, 0.9F})},
                         {&wall, test::pose_of({0, 0, 0}, {0, 0, 1.2F})}});
  const Result<Surface> surface = surface_from_points(scan, "scan");
  EXPECT_TRUE(surface) << surface.error().message;
  Cloud mesh;
  mesh.points = surface->mesh.points;
  mesh.triangles = surface->mesh.triangles;
  EXPECT_LT(kernels::boundary_share(mesh.triangles), 0.02);
  return mesh;
}

/// A closed surface whose triangles share their corners.
Cloud closed_surface() {
  const test::Shape shape = test::ellipsoid({0.1F, 0.02F, 0.015F}, 24);
  std::map<std::array<long, 3>, std::uint32_t> known;  // rounded to hundredths of a millimeter
  Cloud cloud;
  const auto welded = [&](std::uint32_t corner) {
    const Vector3f p = shape.vertices[corner], grid = 1e5F * p;
    const auto [at, added] =
        known.try_emplace({std::lround(grid.x()), std::lround(grid.y()), std::lround(grid.z())},
                          static_cast<std::uint32_t>(cloud.points.size()));
    if (added) cloud.points.push_back(p);
    return at->second;
  };
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    cloud.triangles.push_back(welded(shape.triangles.a[t]), welded(shape.triangles.b[t]),
                              welded(shape.triangles.c[t]));
  }
  return cloud;
}

Cloud moved(Cloud cloud, const Pose& motion) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points.set(i, motion * cloud.points[i]);
  return cloud;
}

Cloud wound_the_other_way(Cloud cloud) {
  std::swap(cloud.triangles.b, cloud.triangles.c);
  return cloud;
}

SceneView find_view(const Cloud& cloud, const SceneInput& input) {
  const Result<engine::FoundView> found = engine::find_view(cloud, input);
  EXPECT_TRUE(found) << found.error().message;
  return found ? found->view : SceneView{};
}

void expect_view(const SceneView& view, SceneKind kind, ViewSource source,
                 const std::optional<Vector3d>& viewpoint) {
  EXPECT_EQ(name_of(view.kind), name_of(kind));
  EXPECT_EQ(name_of(view.source), name_of(source));
  EXPECT_EQ(view.viewpoint, viewpoint);
}

TEST(FindView, PlacesTheViewpointOfATriangulatedScanAtTheOrigin) {
  const Cloud scan = triangulated_scan();
  expect_view(find_view(scan, {}), SceneKind::points, ViewSource::faces, Vector3d::Zero());
  expect_view(find_view(wound_the_other_way(scan), {}), SceneKind::points, ViewSource::faces,
              Vector3d::Zero());
}

TEST(FindView, FindsTheViewpointOfATriangulatedScanThatWasMoved) {
  const Pose motion = test::pose_of({0.4F, -1.2F, 2}, {0.1F, 0.2F, 0});
  const Cloud scan = moved(triangulated_scan(), motion * Eigen::Translation3f(0, 0, -1));
  const SceneView view = find_view(scan, {});
  EXPECT_EQ(view.kind, SceneKind::points);
  EXPECT_EQ(view.source, ViewSource::faces);
  ASSERT_TRUE(view.viewpoint);
  const Vector3f towards = (view.viewpoint->cast<float>() - motion.translation()).normalized();
  EXPECT_GT(towards.dot(motion.linear() * -Vector3f::UnitZ()), 0.98F);
}

TEST(FindView, TreatsAClosedMeshAsACompleteSurfaceWhereverItIs) {
  const Cloud closed = closed_surface();
  EXPECT_LT(kernels::boundary_share(closed.triangles), 0.02);
  for (const Vector3f& place : {Vector3f(0, 0, 0), Vector3f(0, 0, 1), Vector3f(3, -200, 5)}) {
    const Cloud there = moved(closed, test::pose_of({1, 0.2F, -0.4F}, place));
    expect_view(find_view(there, {}), SceneKind::surface, ViewSource::faces, std::nullopt);
    expect_view(find_view(wound_the_other_way(there), {}), SceneKind::surface, ViewSource::faces,
                std::nullopt);
  }
}

TEST(FindView, BelievesTheCallerThenTheFile) {
  Cloud lever = test::cloud_of(test::lever());
  expect_view(find_view(lever, {.closed_surface = true}), SceneKind::surface, ViewSource::given,
              std::nullopt);
  lever.viewpoint = Vector3f(0, 0, 2);
  expect_view(find_view(lever, {.closed_surface = true}), SceneKind::points, ViewSource::file,
              Vector3d(0, 0, 2));
  expect_view(find_view(lever, {.viewpoint = Vector3d(1, 2, 3)}), SceneKind::points,
              ViewSource::given, Vector3d(1, 2, 3));
}

TEST(FindView, RefusesAnotherViewpointOfAnImageThanItsCamera) {
  const test::Shape bracket = test::bracket();
  const Cloud image =
      test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {0, 0, 0.9F})}});
  ASSERT_TRUE(image.camera && image.grid);
  const auto found = engine::find_view(image, {.file = "a.png", .viewpoint = Vector3d(0, 0, 0.5)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::usage);
  EXPECT_EQ(found.error().message,
            "a.png: expected no viewpoint, or 0, 0, 0: an image is seen from its camera; found "
            "(0, 0, 0.5); leave it out");
  EXPECT_TRUE(engine::find_view(image, {.viewpoint = Vector3d(0, 0, 0)}));
}

// pcl::transformPointCloud and most writers leave the file's viewpoint at the origin.
TEST(FindView, FindsWhereAnOrganizedScanThatWasMovedIsSeenFrom) {
  const test::Shape bracket = test::bracket();
  Cloud scan = test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {0, 0, 0.9F})}});
  scan.camera.reset();
  expect_view(find_view(scan, {}), SceneKind::points, ViewSource::file, Vector3d::Zero());
  const Pose motion = test::pose_of({0.4F, -1.2F, 2}, {0.85F, -0.22F, 1.1F});
  scan = moved(scan, motion);
  for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(4e5, 5.4e6, 0)}) {
    scan.offset = offset;
    scan.viewpoint = offset.isZero() ? std::optional(Vector3f(0, 0, 0)) : std::nullopt;
    const SceneView view = find_view(scan, {});
    EXPECT_EQ(name_of(view.kind), "image");
    EXPECT_EQ(name_of(view.source), "grid");
    ASSERT_TRUE(view.viewpoint && view.residual);
    EXPECT_LT((*view.viewpoint - offset - motion.translation().cast<double>()).norm(), 1e-3);
    EXPECT_LT(*view.residual, 0.05);
  }
  scan.offset.setZero();
  scan.viewpoint = Vector3f(0, 0, 2);
  expect_view(find_view(scan, {}), SceneKind::points, ViewSource::file, Vector3d(0, 0, 2));
}

TEST(FindView, KnowsTheOriginByTheRaysOfPointsAndBelievesACallerFirst) {
  const test::Shape bracket = test::bracket();
  Cloud list;
  list.points =
      test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {0, 0, 0.9F})}}).points;
  const SceneView view = find_view(list, {});
  EXPECT_EQ(name_of(view.source), "grid");
  EXPECT_EQ(view.viewpoint, Vector3d::Zero());
  ASSERT_TRUE(view.residual);
  EXPECT_LT(*view.residual, 0.01);
  EXPECT_EQ(name_of(find_view(list, {.viewpoint = Vector3d(0, 0, 0)}).source), "given");
  EXPECT_EQ(name_of(find_view(list, {.viewpoint = Vector3d(0.2, 0, 0)}).source), "given");
}

TEST(FindView, AssumesTheOriginForPoints) {
  Cloud points = moved(triangulated_scan(), test::pose_of({0.4F, -1.2F, 2}, {0.1F, 0.2F, 0}));
  points.triangles = {};
  expect_view(find_view(points, {}), SceneKind::points, ViewSource::assumed, Vector3d::Zero());
}

// The distant viewpoint that the faces point to is reported in the file's frame.
TEST(FindView, DetectsAViewOfFacesFarFromZero) {
  Cloud scan = triangulated_scan();
  scan.offset = {4e5, 5.4e6, 0};
  const SceneView view = find_view(scan, {});
  EXPECT_EQ(view.source, ViewSource::faces);
  ASSERT_TRUE(view.viewpoint);
  const Vector3d towards = (*view.viewpoint - scan.offset).normalized();
  EXPECT_LT(towards.z(), -0.95);
}

}  // namespace
}  // namespace trivet
