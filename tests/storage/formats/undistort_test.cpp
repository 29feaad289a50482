// Depth images of lenses with distortion, and depths measured along the ray.
#include "storage/formats/undistort.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <vector>

#include "storage/formats/memory_cloud.hpp"

namespace trivet {
namespace {

constexpr std::uint32_t kColumns = 160, kRows = 120;

Camera bent_camera() {
  Camera camera{150, 150, 80.5, 58.5};
  camera.distortion = {-0.25, 0.08, 0.002, -0.001, 0.01};
  return camera;
}

/// The lens distortion by definition (OpenCV, "Camera Calibration and 3D Reconstruction"), in
/// matrices.
Eigen::Vector2d bend(const LensDistortion& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm(), r4 = r2 * r2, r6 = r4 * r2;
  const double radial =
      (1 + d.k1 * r2 + d.k2 * r4 + d.k3 * r6) / (1 + d.k4 * r2 + d.k5 * r4 + d.k6 * r6);
  return radial * p + Eigen::Vector2d(2 * d.p1 * p.x() * p.y() + d.p2 * (r2 + 2 * p.x() * p.x()),
                                      d.p1 * (r2 + 2 * p.y() * p.y()) + 2 * d.p2 * p.x() * p.y());
}

/// The ray whose distorted image is this pixel, by fixed-point iteration to the last digits.
Eigen::Vector2d ray_of_pixel(const Camera& camera, double u, double v) {
  const Eigen::Vector2d bent((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
  Eigen::Vector2d ray = bent;
  for (int step = 0; step < 200; ++step) ray += bent - bend(camera.distortion, ray);
  return ray;
}

/// The depth image of the surface z(x, y), whose pixels measure along their distorted rays.
std::vector<float> render_image(const Camera& camera,
                                const std::function<double(const Eigen::Vector2d&)>& z_along) {
  std::vector<float> image;
  for (std::uint32_t v = 0; v < kRows; ++v) {
    for (std::uint32_t u = 0; u < kColumns; ++u) {
      const Eigen::Vector2d ray = ray_of_pixel(camera, u, v);
      const double z = z_along(ray);
      image.push_back(static_cast<float>(
          camera.depth == DepthKind::ray ? z * std::hypot(1.0, ray.x(), ray.y()) : z));
    }
  }
  return image;
}

Cloud read(const std::vector<float>& image, const Camera& camera) {
  const Result<Cloud> cloud =
      cloud_from_depths(ArrayView::packed(image.data(), kRows, kColumns), camera);
  EXPECT_TRUE(cloud) << cloud.error().message;
  return cloud ? *cloud : Cloud{};
}

/// The depth of the plane n . p = 1 along a ray.
double plane_z(const Eigen::Vector3d& n, const Eigen::Vector2d& ray) {
  return 1 / n.dot(Eigen::Vector3d(ray.x(), ray.y(), 1));
}

TEST(Undistort, LeavesPlanesFlat) {
  const Eigen::Vector3d n(0.4, -0.3, 1.6);
  for (const DepthKind kind : {DepthKind::z, DepthKind::ray}) {
    Camera camera = bent_camera();
    camera.depth = kind;
    const std::vector<float> image =
        render_image(camera, [&](const Eigen::Vector2d& ray) { return plane_z(n, ray); });
    const Cloud cloud = read(image, camera);
    ASSERT_GT(cloud.points.size(), 0.9 * kColumns * kRows);
    double farthest = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      farthest = std::max(farthest, std::abs(n.dot(cloud.points[i].cast<double>()) - 1) / n.norm());
    // Bilinear interpolation errs by the image's curvature between pixels, some 1e-5 here. At the
    // image's border, where the nearest value is used, it errs by up to half a pixel's slope.
    EXPECT_LT(farthest, 0.0015);

    // Without undistortion the plane stays bent, so the test detects a missing correction.
    Camera straight = camera;
    straight.distortion = {};
    const Cloud wrong = read(image, straight);
    double worst = 0;
    for (std::size_t i = 0; i < wrong.points.size(); ++i)
      worst = std::max(worst, std::abs(n.dot(wrong.points[i].cast<double>()) - 1) / n.norm());
    EXPECT_GT(worst, 0.005);
  }
}

TEST(Undistort, PutsNothingBetweenTwoSurfaces) {
  const Camera camera = bent_camera();
  const auto step = [](const Eigen::Vector2d& ray) { return ray.norm() < 0.2 ? 0.6 : 0.7; };
  const Cloud cloud = read(render_image(camera, step), camera);
  ASSERT_GT(cloud.points.size(), 0.9 * kColumns * kRows);
  std::size_t num_misplaced = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    ASSERT_TRUE(std::abs(p.z() - 0.6F) < 1e-6F || std::abs(p.z() - 0.7F) < 1e-6F) << p.z();
    const double radius = std::hypot(p.x() / p.z(), p.y() / p.z());
    const bool near = std::abs(p.z() - 0.6F) < 1e-6F;
    num_misplaced += near ? radius > 0.2 + 1.0 / 150 : radius < 0.2 - 1.0 / 150;
  }
  EXPECT_EQ(num_misplaced, 0U) << "the outline stays within a pixel";
}

TEST(Undistort, KeepsWhatIsNotMeasured) {
  const Camera camera = bent_camera();
  const std::vector<float> nothing(std::size_t{kColumns} * kRows, 0);
  EXPECT_EQ(read(nothing, camera).points.size(), 0U);
}

TEST(Undistort, DistortsAsOpenCvWritesIt) {
  const LensDistortion lens{0.1, -0.2, 0.003, 0.004, 0.05, 0.06, -0.07, 0.08};
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {0.3, -0.2}, {-0.5, 0.4}, {0.7, 0.7}}) {
    const auto bent = formats::distort(lens, x, y);
    ASSERT_TRUE(bent);
    const Eigen::Vector2d expected = bend(lens, {x, y});
    EXPECT_NEAR(bent->first, expected.x(), 1e-14);
    EXPECT_NEAR(bent->second, expected.y(), 1e-14);
  }
  // 1 - 3 k r^2 is zero at r = 0.577 for k1 = -1: beyond it, the distortion is not invertible.
  EXPECT_TRUE(formats::distort({-1}, 0.57, 0));
  EXPECT_FALSE(formats::distort({-1}, 0.58, 0));
}

TEST(DepthAlongTheRay, LiesWhereTheRayEnds) {
  Camera camera{100, 120, 2, 1};
  camera.depth = DepthKind::ray;
  std::vector<float> image(15, 2.0F);
  const Result<Cloud> cloud = cloud_from_depths(ArrayView::packed(image.data(), 3, 5), camera);
  ASSERT_TRUE(cloud) << cloud.error().message;
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_NEAR(cloud->points[i].norm(), 2, 1e-6) << "a sphere around the camera";
    const Eigen::Vector3f p = cloud->points[i];
    EXPECT_NEAR(100 * p.x() / p.z() + 2, static_cast<double>(i % 5), 1e-4);
    EXPECT_NEAR(120 * p.y() / p.z() + 1, static_cast<double>(i / 5), 1e-4);
  }
}

}  // namespace
}  // namespace trivet
