#include "engine/meshing/surface_from_points.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "engine/common/thread_limit.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/random.hpp"
#include "support/reference_mesh.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;

/// A depth scan of a part in front of a wall.
Cloud part_scan() {
  static const test::Shape bracket = test::bracket();
  return test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {0, 0, 0.9F})}});
}

Cloud without_grid(Cloud cloud) {
  cloud.grid.reset();
  cloud.camera.reset();
  return cloud;
}

Surface surface_of(const Cloud& cloud, const SurfaceOptions& options = {}) {
  Result<Surface> surface = surface_from_points(cloud, "scan", options);
  EXPECT_TRUE(surface) << surface.error().message;
  return surface ? std::move(*surface) : Surface{};
}

double share(std::size_t part, std::size_t all) {
  return static_cast<double>(part) / static_cast<double>(all);
}

/// The fraction of triangles that face a viewpoint.
double share_facing(const Cloud& mesh, const Vector3f& viewpoint) {
  std::size_t num = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3f a = mesh.points[mesh.triangles.a[t]];
    const Vector3f n =
        (mesh.points[mesh.triangles.b[t]] - a).cross(mesh.points[mesh.triangles.c[t]] - a);
    num += n.dot(viewpoint - a) > 0;
  }
  return share(num, mesh.triangles.size());
}

testing::AssertionResult is_refused(const Result<Surface>& surface, ErrorCode code,
                                    const std::string& text) {
  if (!surface && surface.error().code == code &&
      surface.error().message.find(text) != std::string::npos) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << (surface ? "a surface" : surface.error().message);
}

TEST(SurfaceFromPoints, ChoosesTheFirstMethodThatTheCloudAllows) {
  const Cloud scan = part_scan();
  EXPECT_EQ(surface_of(scan).method, SurfaceMethod::grid);
  EXPECT_EQ(surface_of(without_grid(scan)).method, SurfaceMethod::greedy);
  EXPECT_EQ(surface_of(scan, {.method = SurfaceMethod::greedy}).method, SurfaceMethod::greedy);

  const Cloud faces = test::cloud_of(test::bracket());
  const Surface surface = surface_of(faces);
  EXPECT_EQ(surface.method, SurfaceMethod::faces);
  EXPECT_EQ(surface.num_used, faces.points.size());
  EXPECT_EQ(surface.mesh.triangles.a, faces.triangles.a);
}

TEST(SurfaceFromPoints, CoversAScanByItsPixelsAndByItsPointsAlike) {
  const Cloud scan = part_scan();
  const Surface grid = surface_of(scan), greedy = surface_of(without_grid(scan));
  for (const Surface* surface : {&grid, &greedy}) {
    EXPECT_GT(share(surface->num_used, scan.points.size()), 0.99);
    EXPECT_GT(share(surface->mesh.triangles.size(), 2 * scan.points.size()), 0.95);
    EXPECT_LT(surface->open_share, 0.05);
    EXPECT_GT(share_facing(surface->mesh, Vector3f::Zero()), 0.99);
    EXPECT_TRUE(surface->warning.empty()) << surface->warning;
    reference::count_open_edges(
        surface->mesh.triangles);  // fails where a side of an edge has two triangles
  }
}

TEST(SurfaceFromPoints, GivesTheSameBytesForAnyNumberOfThreads) {
  const Cloud scan = part_scan();
  for (const Cloud& cloud : {scan, without_grid(scan)}) {
    std::vector<Surface> surfaces;
    for (const unsigned threads : {1U, 2U, 3U}) {
      const ThreadLimit limit(threads);
      surfaces.push_back(surface_of(cloud));
    }
    for (const Surface& other : surfaces) {
      EXPECT_EQ(other.mesh.triangles.a, surfaces[0].mesh.triangles.a);
      EXPECT_EQ(other.mesh.triangles.b, surfaces[0].mesh.triangles.b);
      EXPECT_EQ(other.mesh.triangles.c, surfaces[0].mesh.triangles.c);
    }
  }
}

TEST(SurfaceFromPoints, WarnsOfAViewpointThatCouldNotSeeTheScan) {
  const Surface surface = surface_of(part_scan(), {.viewpoint = Eigen::Vector3d(0.5, 0, 0.9)});
  EXPECT_NE(surface.warning.find("--viewpoint"), std::string::npos) << surface.warning;
}

TEST(SurfaceFromPoints, RefusesWhatHasNoSurface) {
  Cloud cloud;
  EXPECT_TRUE(is_refused(surface_from_points(cloud, "none.ply"), ErrorCode::bad_data,
                         "none.ply: expected at least 3 points, found 0"));
  for (int i = 0; i < 10; ++i) cloud.points.push_back({static_cast<float>(i), 0, 1});
  EXPECT_TRUE(is_refused(surface_from_points(cloud, "line.ply"), ErrorCode::bad_data, "line.ply"));
  EXPECT_TRUE(is_refused(surface_from_points(cloud, "line.ply", {.method = SurfaceMethod::faces}),
                         ErrorCode::usage, "a file with faces"));
  EXPECT_TRUE(is_refused(surface_from_points(cloud, "line.ply", {.method = SurfaceMethod::grid}),
                         ErrorCode::usage, "an organized scan"));
}

TEST(SurfaceFromPoints, RefusesOptionsOutOfTheirRange) {
  const float nan = std::nanf("");
  for (const float bad : {nan, -1.0F, 200.0F}) {
    EXPECT_FALSE(validate({.grid = {.max_grazing_deg = bad}}));
    EXPECT_FALSE(validate({.greedy = {.min_angle_deg = bad}}));
    EXPECT_FALSE(validate({.greedy = {.max_angle_deg = bad}}));
    EXPECT_FALSE(validate({.greedy = {.max_normal_angle_deg = bad}}));
    EXPECT_FALSE(validate({.greedy = {.mu = bad}}));
  }
  EXPECT_FALSE(validate({.grid = {.max_jump = 0.5F}}));
  EXPECT_FALSE(validate({.greedy = {.radius = 0}}));
  EXPECT_FALSE(validate({.greedy = {.max_neighbors = 7}}));
  EXPECT_TRUE(validate(SurfaceOptions{}));
}

TEST(SurfaceFromPoints, NeedsASensorNearPointsThatAreFarFromZero) {
  Cloud cloud;
  for (int i = 0; i < 100; ++i)
    cloud.points.push_back({static_cast<float>(i % 10), static_cast<float>(i / 10), 0});
  cloud.offset = {512345, 5403210, 400};
  const Result<Surface> blind = surface_from_points(cloud, "far.xyz");
  ASSERT_FALSE(blind);
  EXPECT_NE(blind.error().message.find("far.xyz: the points lie around (512349.5, 5403214.5, 400)"),
            std::string::npos)
      << blind.error().message;
  const Eigen::Vector3d above = cloud.offset + Eigen::Vector3d(5, 5, 20);
  const Surface surface = surface_of(cloud, {.viewpoint = above});
  EXPECT_GT(share_facing(surface.mesh, Vector3f(5, 5, 20)), 0.99);
  EXPECT_EQ(surface.mesh.offset, cloud.offset);
}

struct RealScan {
  const char* file;
  std::optional<Eigen::Vector3d> viewpoint;
  std::optional<SurfaceMethod> method;
  double triangles_per_point, open_share;
};

TEST(SurfaceFromPoints, CoversRealScans) {
  const std::filesystem::path data = TRIVET_DATA;
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is absent: set TRIVET_DATA";
  const Eigen::Vector3d bunny_sensor(-0.024021, 0.096585, 2.509732);
  for (const RealScan& scan : std::initializer_list<RealScan>{
           {"stanford_bunny_scans/bun000.ply", bunny_sensor, {}, 1.93, 0.025},
           {"stanford_bunny_scans/bun000.ply", bunny_sensor, SurfaceMethod::greedy, 1.97, 0.01},
           {"pcl_kinect/milk_cartoon_all_small_clorox.pcd", {}, {}, 1.91, 0.035},
           {"uwa/models/chef.pcd", {}, {}, 1.91, 0.04},
           {"uwa/scenes/rs1_normals2.ply", {}, SurfaceMethod::greedy, 1.7, 0.1}}) {
    SCOPED_TRACE(scan.file);
    Result<Cloud> cloud = read_cloud(data / scan.file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const std::size_t n = cloud->points.size();
    const Surface surface =
        surface_of(*cloud, {.method = scan.method, .viewpoint = scan.viewpoint});
    EXPECT_GT(share(surface.num_used, n), 0.97);
    EXPECT_GT(share(surface.mesh.triangles.size(), n), scan.triangles_per_point);
    EXPECT_LT(surface.open_share, scan.open_share);
    if (n > 100000) continue;  // the reference is slow
    reference::count_open_edges(
        surface.mesh.triangles);  // fails where a side of an edge has two triangles
  }
}

}  // namespace
}  // namespace trivet
