#include "engine/simulation/sensor_flaws.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "engine/common/thread_limit.hpp"
#include "engine/simulation/echo_scene.hpp"
#include "engine/simulation/match_scene.hpp"
#include "engine/simulation/measure_scene.hpp"
#include "support/shapes.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using kernels::RayScene;
using test::Shape;

constexpr std::uint32_t kWidth = 320, kHeight = 240;
const Camera kCamera{572, 572, 159.5, 119.5, 1};

Shape sheet(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d) {
  Shape out;
  out.add(a, b, c, d);
  return out;
}
Shape wall(float z) { return sheet({-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}); }

/// Depths [m] of a scene.
std::vector<double> scan(const std::vector<Shape>& shapes, Sensor sensor, const SensorFlaws& flaws,
                         double reflectance = 0.5) {
  std::vector<RayScene> meshes;
  for (const Shape& shape : shapes)
    meshes.push_back(std::move(*RayScene::from_mesh(shape.vertices, shape.triangles)));
  std::vector<RayScene::Instance> instances;
  for (const RayScene& mesh : meshes) instances.push_back({&mesh, Pose::Identity()});
  const auto rays = RayScene::from_instances(instances);
  EXPECT_TRUE(rays);
  const ExactImage image = render_exactly(*rays, kCamera, kWidth, kHeight);
  const std::vector<Finish> finishes(shapes.size(), Finish{false, reflectance});
  std::vector<double> out;
  for (const std::uint16_t raw :
       measure_scene({*rays, kCamera, image, finishes}, {.sensor = sensor}, 1, 0, flaws))
    out.push_back(raw * traits_of(sensor).depth_step);
  return out;
}

double share(const std::vector<double>& depths, std::uint32_t column, double low, double high) {
  double n = 0;
  for (std::size_t v = 20; v < kHeight - 20; ++v) {
    const double z = depths[v * kWidth + column];
    n += z > low && z < high ? 1 : 0;
  }
  return n / (kHeight - 40);
}

SensorFlaws matched() {
  SensorFlaws flaws;
  flaws.match.half_window_pixel = 4;
  flaws.match.noise_pixel = 0.05;
  return flaws;
}

TEST(SensorFlaws, LeaveScansAsTheyAreWhereThereAreNone) {
  const std::vector<Shape> shapes{wall(0.9F)};
  for (const Sensor sensor :
       {Sensor::structured_light, Sensor::time_of_flight, Sensor::stereo, Sensor::laser}) {
    SensorFlaws unused;  // strengths without effect by themselves
    unused.match.noise_pixel = 1;
    unused.patch_length_pixel = 3;
    unused.hole_radius_pixel = 50;
    EXPECT_EQ(scan(shapes, sensor, {}), scan(shapes, sensor, unused));
  }
}

// A sheet in front of a wall: it grows on the side where the light beside the camera leaves a
// shadow, the side away from the light.
TEST(SensorFlaws, FattenTheSideAwayFromTheLight) {
  const Shape front =
      sheet({-0.05F, -5, 0.7F}, {0.05F, -5, 0.7F}, {0.05F, 5, 0.7F}, {-0.05F, 5, 0.7F});
  // Columns beyond the ends at +-0.05 m.
  const auto left = static_cast<std::uint32_t>(std::ceil(159.5 - 0.05 * 572 / 0.7)) - 1,
             right = static_cast<std::uint32_t>(std::floor(159.5 + 0.05 * 572 / 0.7)) + 1;
  for (const bool light_on_left : {true, false}) {
    SensorFlaws flaws = matched();
    flaws.match.light_on_left = light_on_left;
    const std::vector<double> depths = scan({front, wall(1)}, Sensor::structured_light, flaws);
    const double on_left = share(depths, left - 1, 0.65, 0.75),
                 on_right = share(depths, right + 1, 0.65, 0.75);
    EXPECT_GT(light_on_left ? on_right : on_left, 0.6);
    EXPECT_LT(light_on_left ? on_left : on_right, 0.4);
    EXPECT_EQ(share(depths, left - 5, 0.65, 0.75), 0) << "half a window at most";
    EXPECT_EQ(share(depths, right + 5, 0.65, 0.75), 0);
  }
}

TEST(SensorFlaws, ErrAlikeInNeighborsAndMoreWithTheSquareOfDepth) {
  const auto spread = [](double z) {
    const std::vector<double> depths =
        scan({wall(static_cast<float>(z))}, Sensor::structured_light, matched());
    double squares = 0, products = 0, n = 0;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (i % kWidth < 10 || i % kWidth > kWidth - 10 || depths[i] == 0 || depths[i + 1] == 0)
        continue;
      squares += (depths[i] - z) * (depths[i] - z);
      products += (depths[i] - z) * (depths[i + 1] - z);
      n += 1;
    }
    EXPECT_GT(products / squares, 0.7) << "a window's dots are its neighbor's";
    return std::sqrt(squares / n);
  };
  const double near = spread(0.6), far = spread(1.2);
  EXPECT_NEAR(far / near, 4, 0.6);
  EXPECT_NEAR(far, 1.2 * 1.2 * 0.05 / (572 * 0.075), 0.4 * far);
}

TEST(SensorFlaws, LoseDarkSurfacesOfMatchedWindows) {
  SensorFlaws flaws = matched();
  flaws.match.least_light = 0.1;
  const auto missing = [&](double reflectance) {
    const std::vector<double> depths =
        scan({wall(1)}, Sensor::structured_light, flaws, reflectance);
    return static_cast<double>(std::count(depths.begin(), depths.end(), 0.0)) /
           static_cast<double>(depths.size());
  };
  EXPECT_LT(missing(0.5), 0.05);
  EXPECT_GT(missing(0.05), 0.95);
}

// Two white walls that meet at a right angle in front of a time-of-flight camera.
TEST(SensorFlaws, ReadConcaveCornersTooFarByBouncedLight) {
  const Shape left = sheet({0, -5, 1}, {-1, -5, 0}, {-1, 5, 0}, {0, 5, 1}),
              right = sheet({0, -5, 1}, {1, -5, 0}, {1, 5, 0}, {0, 5, 1});
  SensorFlaws flaws;
  flaws.echo.noise = 0;
  const std::vector<double> none = scan({left, right}, Sensor::time_of_flight, flaws, 0.8);
  flaws.echo.multipath = 1;
  const std::vector<double> bounced = scan({left, right}, Sensor::time_of_flight, flaws, 0.8);
  const std::size_t row = kWidth * (kHeight / 2);
  for (const std::size_t u : {60U, 110U, 210U, 260U}) {
    const double more = bounced[row + u] - none[row + u];
    EXPECT_GT(more, 0.005) << u;
    EXPECT_LT(more, 0.15) << u;
  }
  EXPECT_EQ(scan({wall(1)}, Sensor::time_of_flight, flaws)[row + 100],
            scan({wall(1)}, Sensor::time_of_flight,
                 [] {
                   SensorFlaws alone;
                   alone.echo.noise = 0;
                   return alone;
                 }())[row + 100])
      << "a flat wall lights nothing of itself";
}

TEST(SensorFlaws, BiasTheEdgesOfALaserToBothSidesAlike) {
  const Shape front =
      sheet({-0.05F, -5, 0.7F}, {0.05F, -5, 0.7F}, {0.05F, 5, 0.7F}, {-0.05F, 5, 0.7F});
  SensorFlaws flaws;
  flaws.line.noise = 0;
  flaws.line.beam_m = 0.001;
  const std::vector<double> depths = scan({front, wall(1)}, Sensor::laser, flaws);
  const auto first = static_cast<std::uint32_t>(std::ceil(159.5 - 0.05 * 572 / 0.7)),
             last = static_cast<std::uint32_t>(std::floor(159.5 + 0.05 * 572 / 0.7));
  // Half a line times z / b: 1.75 mm at most.
  EXPECT_GT(share(depths, first, 0.698, 0.69995), 0.9);
  EXPECT_GT(share(depths, last, 0.70005, 0.702), 0.9);
  EXPECT_GT(share(depths, first + 3, 0.69995, 0.70005), 0.99);
}

TEST(SensorFlaws, GiveTheSameBytesForAnyNumberOfThreads) {
  const Shape front =
      sheet({-0.05F, -5, 0.7F}, {0.05F, -5, 0.7F}, {0.05F, 5, 0.7F}, {-0.05F, 5, 0.7F});
  for (const Sensor sensor :
       {Sensor::structured_light, Sensor::time_of_flight, Sensor::stereo, Sensor::laser}) {
    for (std::uint64_t i = 0; i < 4; ++i) {
      kernels::CounterRandom random(7, i, 0);
      const SensorFlaws flaws = draw_flaws(sensor, random);
      const std::vector<double> parallel = scan({front, wall(1)}, sensor, flaws);
      const ThreadLimit limit(1);
      EXPECT_EQ(scan({front, wall(1)}, sensor, flaws), parallel);
    }
  }
}

TEST(DrawFlaws, ReachesOverWideRangesAndLeavesEachLawOutAtTimes) {
  std::set<std::uint32_t> windows;
  double focal = 0;
  int no_focal = 0, no_wave = 0, no_shift = 0, left = 0, growing = 0, no_holes = 0;
  constexpr int kDraws = 400;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    kernels::CounterRandom random(3, i, 0);
    const SensorFlaws flaws = draw_flaws(Sensor::structured_light, random);
    windows.insert(flaws.match.half_window_pixel);
    focal = std::max(focal, std::abs(flaws.calibration.focal));
    EXPECT_LE(std::abs(flaws.calibration.focal), 0.05);
    EXPECT_LE(std::abs(flaws.calibration.depth), 0.01);
    EXPECT_LE(std::abs(flaws.calibration.center_u_pixel), 8);
    EXPECT_LE(std::abs(flaws.calibration.shift_u_pixel), 3);
    EXPECT_LE(flaws.match.noise_pixel, 0.15);
    no_focal += flaws.calibration.focal == 0 ? 1 : 0;
    no_wave += flaws.match.wave_pixel == 0 ? 1 : 0;
    no_shift += flaws.calibration.shift_u_pixel == 0 ? 1 : 0;
    left += flaws.match.light_on_left ? 1 : 0;
    growing += flaws.match.grow_pixel > 0 ? 1 : 0;
    no_holes += flaws.holes == 0 ? 1 : 0;
    EXPECT_EQ(flaws.echo, EchoFlaws{}) << "of another kind of sensor";
    EXPECT_EQ(flaws.line, LineFlaws{});
  }
  EXPECT_EQ(windows, (std::set<std::uint32_t>{3, 4, 5, 6}));
  EXPECT_GT(focal, 0.04);
  for (const int n : {no_focal, no_wave, no_shift, left, growing, no_holes}) {
    EXPECT_GT(n, kDraws / 10);
    EXPECT_LT(n, kDraws * 9 / 10);
  }
}

TEST(DrawFlaws, GivesEachSensorItsKind) {
  for (const Sensor sensor :
       {Sensor::structured_light, Sensor::time_of_flight, Sensor::stereo, Sensor::laser}) {
    kernels::CounterRandom random(3, 1, 0);
    const SensorFlaws flaws = draw_flaws(sensor, random);
    EXPECT_EQ(flaws.match.half_window_pixel > 0,
              sensor == Sensor::structured_light || sensor == Sensor::stereo);
    EXPECT_EQ(flaws.echo != EchoFlaws{}, sensor == Sensor::time_of_flight);
    EXPECT_EQ(flaws.line != LineFlaws{}, sensor == Sensor::laser);
  }
}

const CalibrationFlaws kBad{.focal = -0.03,
                            .aspect = 0.008,
                            .center_u_pixel = 6,
                            .center_v_pixel = -4,
                            .depth = 0.01,
                            .shift_u_pixel = 2,
                            .shift_v_pixel = -1};

TEST(WrittenPose, IsTheTrueOneOfATrueCamera) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3f(0.1F, 0.2F, 0.9F);
  EXPECT_EQ(written_pose(pose, {0, 0, 0}, kCamera, {}).matrix(), pose.matrix());
  EXPECT_EQ(written_camera(kCamera, {}), kCamera);
}

// Maps a point's pixel and depth through the written camera.
TEST(WrittenPose, MapsPointsToWhereTheirWrittenPixelsAndDepthsAre) {
  const Vector3d p(0.12, -0.07, 0.85);
  const double u = kCamera.fx * p.x() / p.z() + kCamera.cx + kBad.shift_u_pixel,
               v = kCamera.fy * p.y() / p.z() + kCamera.cy + kBad.shift_v_pixel,
               z = p.z() * (1 + kBad.depth);
  const Camera written = written_camera(kCamera, kBad);
  const Vector3d expected((u - written.cx) / written.fx * z, (v - written.cy) / written.fy * z, z);
  EXPECT_LT((written_from_true(kCamera, kBad) * p - expected).norm(), 1e-12);
}

// The best rigid motion from a ball's points to their written positions, by brute force about the
// pose: no small rotation or shift fits better.
TEST(WrittenPose, FitsWhatIsWrittenOfAnObjectBest) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisf(0.7F, Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Vector3f(0.15F, -0.1F, 0.8F);
  const Vector3d center(0.01, 0.02, -0.03);
  std::vector<Vector3d> points;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    kernels::CounterRandom random(5, i, 0);
    const Vector3d d(random.normal(), random.normal(), random.normal());
    points.push_back(center + 0.05 * d.normalized());
    points.push_back(center - 0.05 * d.normalized());
  }
  const Eigen::Matrix3d map = written_from_true(kCamera, kBad);
  const auto error = [&](const Eigen::Isometry3d& candidate) {
    double sum = 0;
    for (const Vector3d& p : points)
      sum += (candidate * p - map * (pose.cast<double>() * p)).squaredNorm();
    return sum;
  };
  const Eigen::Isometry3d written(
      written_pose(pose, center, kCamera, kBad).cast<double>().matrix());
  const double best = error(written);
  EXPECT_LT(best, 0.5 * error(Eigen::Isometry3d(pose.cast<double>().matrix())));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Eigen::Isometry3d shifted = written, turned = written;
      shifted.translation() += sign * 5e-4 * Vector3d::Unit(axis);
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(sign * 0.01, Vector3d::Unit(axis)).toRotationMatrix();
      turned.linear() = turn * written.linear();
      turned.translation() += written * center - turned * center;
      EXPECT_GT(error(shifted), best);
      EXPECT_GT(error(turned), best);
    }
  }
}

}  // namespace
}  // namespace trivet::engine
