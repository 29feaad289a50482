#include "kernels/scans/fit_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

struct Scan {
  PixelGrid grid;
  Points points;
};

/// A wavy wall seen by a camera, with holes and this noise of the pixel positions.
Scan scan_of(Random& random, const Camera& camera, double pixel_noise = 0) {
  Scan scan{{80, 60, {}}, {}};
  scan.grid.point_index.assign(80 * 60, PixelGrid::kNone);
  for (std::size_t pixel = 0; pixel < 80 * 60; ++pixel) {
    if (random.below(5) == 0) continue;
    const auto noise = [&] { return static_cast<double>(random.normal(1)) * pixel_noise; };
    const double u = static_cast<double>(pixel % 80), v = static_cast<double>(pixel / 80);
    const double z = 2 + 0.5 * std::sin(u / 9) * std::cos(v / 7);
    scan.grid.point_index[pixel] = static_cast<std::int32_t>(scan.points.size());
    scan.points.push_back(Eigen::Vector3d((u + noise() - camera.cx) / camera.fx * z,
                                          (v + noise() - camera.cy) / camera.fy * z, z)
                              .cast<float>());
  }
  return scan;
}

TEST(FitCamera, RecoversTheCameraOfAScan) {
  for (const Camera& camera : {Camera{70, 75, 39.5, 30.25, 1}, Camera{500, 500, -10, 90, 1}}) {
    Random random;
    const Scan scan = scan_of(random, camera);
    const auto found = fit_camera(scan.grid, scan.points);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->fx, camera.fx, 1e-3);
    EXPECT_NEAR(found->fy, camera.fy, 1e-3);
    EXPECT_NEAR(found->cx, camera.cx, 1e-3);
    EXPECT_NEAR(found->cy, camera.cy, 1e-3);
  }
}

TEST(FitCamera, BearsNoiseBelowHalfAPixelAndNoMore) {
  Random random;
  const Camera camera{70, 75, 39.5, 30.25, 1};
  const Scan fine = scan_of(random, camera, 0.15);
  const auto found = fit_camera(fine.grid, fine.points);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fx, camera.fx, 0.1);
  EXPECT_NEAR(found->cx, camera.cx, 0.1);
  const Scan coarse = scan_of(random, camera, 0.5);
  EXPECT_FALSE(fit_camera(coarse.grid, coarse.points));
}

TEST(FitCamera, RefusesGridsThatNoPinholeMakes) {
  Random random;
  const Camera camera{70, 75, 39.5, 30.25, 1};
  const Scan good = scan_of(random, camera);
  const auto refused = [&](auto&& move) {
    Scan scan = good;
    for (std::size_t i = 0; i < scan.points.size(); ++i) scan.points.set(i, move(scan.points[i]));
    return !fit_camera(scan.grid, scan.points);
  };
  EXPECT_FALSE(refused([](const Vector3f& p) { return p; }));
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(-p.x(), p.y(), p.z()); }))
      << "mirrored";
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(p.y(), p.x(), p.z()); })) << "turned";
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(p.x(), p.y(), -p.z()); }))
      << "behind";
  EXPECT_TRUE(refused([](const Vector3f& p) {
    return Vector3f(p.x() / p.z(), p.y() / p.z(), p.z());
  })) << "orthographic";
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(0, 0, p.z()); })) << "a line";
  EXPECT_FALSE(fit_camera({}, {})) << "nothing";
}

/// The scan with its points moved by T.
Scan moved_by(const Pose& T, Scan scan) {
  for (std::size_t i = 0; i < scan.points.size(); ++i) scan.points.set(i, T * scan.points[i]);
  return scan;
}

TEST(FitPosedCamera, RecoversCameraAndPlaceWhereverThePointsWereMovedTo) {
  for (const Camera& camera : {Camera{70, 75, 39.5, 30.25, 1}, Camera{500, 500, -10, 90, 1}}) {
    for (std::uint64_t k = 0; k < 10; ++k) {
      Random random(k);
      const Pose T = random.motion(3);
      const Scan scan = moved_by(T, scan_of(random, camera));
      const auto found = fit_posed_camera(scan.grid, scan.points);
      ASSERT_TRUE(found) << k;
      EXPECT_NEAR(found->geometry.fx, camera.fx, 2e-3 * camera.fx);
      EXPECT_NEAR(found->geometry.cy, camera.cy, 0.1);
      EXPECT_LT((found->center - T.translation().cast<double>()).norm(), 5e-3) << k;
      EXPECT_LT(found->residual, 0.01);
      EXPECT_LT((found->geometry.T_camera_scene * T.translation()).norm(), 5e-3);
      for (std::size_t pixel = 0; pixel < scan.grid.point_index.size(); ++pixel) {
        const std::int32_t i = scan.grid.point_index[pixel];
        if (i == PixelGrid::kNone) continue;
        const Vector3f p =
            found->geometry.T_camera_scene * scan.points[static_cast<std::size_t>(i)];
        ASSERT_EQ(found->geometry.pixel_of(p), static_cast<std::int64_t>(pixel));
      }
    }
  }
}

TEST(FitPosedCamera, IsNotMovedByNoiseAlongTheRays) {
  Random random;
  const Pose T = random.motion(3);
  Scan scan = scan_of(random, {70, 75, 39.5, 30.25, 1});
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    scan.points.set(i, (1 + random.normal(0.02F)) * scan.points[i]);
  const auto found = fit_posed_camera(moved_by(T, scan).grid, moved_by(T, scan).points);
  ASSERT_TRUE(found);
  EXPECT_LT((found->center - T.translation().cast<double>()).norm(), 5e-3);
}

TEST(FitPosedCamera, RefusesWhatDeterminesNoPlace) {
  Random random;
  const Scan good = scan_of(random, {70, 75, 39.5, 30.25, 1});
  const auto refused = [&](auto&& move) {
    Scan scan = good;
    for (std::size_t i = 0; i < scan.points.size(); ++i) scan.points.set(i, move(scan.points[i]));
    return !fit_posed_camera(scan.grid, scan.points);
  };
  EXPECT_FALSE(refused([](const Vector3f& p) { return p; }));
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(-p.x(), p.y(), p.z()); }))
      << "mirrored";
  EXPECT_TRUE(refused([](const Vector3f& p) { return Vector3f(2 * p / p.z()); })) << "a plane";
  EXPECT_TRUE(refused([](const Vector3f& p) {
    return Vector3f(p.x() / p.z(), p.y() / p.z(), p.z());
  })) << "orthographic";
  EXPECT_TRUE(refused([](const Vector3f&) { return Vector3f(1, 2, 3); })) << "one point";
  const Scan coarse = scan_of(random, {70, 75, 39.5, 30.25, 1}, 0.5);
  EXPECT_FALSE(fit_posed_camera(coarse.grid, coarse.points));
  EXPECT_FALSE(fit_posed_camera({}, {})) << "nothing";
}

}  // namespace
}  // namespace trivet::kernels
