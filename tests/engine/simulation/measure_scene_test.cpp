#include "engine/simulation/measure_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "kernels/simulation/sensor_noise.hpp"
#include "support/shapes.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using kernels::RayScene;
using test::Shape;

constexpr std::uint32_t kWidth = 320, kHeight = 240;
const Camera kCamera{572, 572, 159.5, 119.5, 1};
constexpr double kDegree = std::numbers::pi / 180;
constexpr Sensor kSensors[] = {Sensor::structured_light, Sensor::time_of_flight, Sensor::stereo,
                               Sensor::laser};

Shape sheet(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
            const Eigen::Vector3f& d) {
  Shape out;
  out.add(a, b, c, d);
  return out;
}

/// A plane that meets the optical axis at `z`, rotated about the camera's y axis.
Shape plane(double z, double angle) {
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::AngleAxisf(static_cast<float>(angle), Eigen::Vector3f::UnitY()).toRotationMatrix();
  pose.translation().z() = static_cast<float>(z);
  return sheet({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}).moved(pose);
}

struct Scan {
  ExactImage exact{0, 0};
  std::vector<std::uint16_t> depths;
  double step = 0;
  double at(std::size_t i) const { return depths[i] * step; }
};

Scan scan(const std::vector<Shape>& shapes, const SensorOptions& options, bool metal = false,
          double reflectance = 0.5) {
  std::vector<RayScene> meshes;
  for (const Shape& shape : shapes)
    meshes.push_back(std::move(*RayScene::from_mesh(shape.vertices, shape.triangles)));
  std::vector<RayScene::Instance> instances;
  for (const RayScene& mesh : meshes) instances.push_back({&mesh, Pose::Identity()});
  const auto rays = RayScene::from_instances(instances);
  EXPECT_TRUE(rays);
  Scan out;
  out.exact = render_exactly(*rays, kCamera, kWidth, kHeight);
  const std::vector<Finish> finishes(shapes.size(), Finish{metal, reflectance});
  out.depths = measure_scene({*rays, kCamera, out.exact, finishes}, options, 1, 0);
  out.step = traits_of(options.sensor).depth_step;
  return out;
}

Vector3d ray(std::size_t i) {
  return {(static_cast<double>(i % kWidth) - kCamera.cx) / kCamera.fx,
          (static_cast<double>(i / kWidth) - kCamera.cy) / kCamera.fy, 1};
}

/// The cosine between the normal of a plane and the direction to the light, or the second camera.
double light_cosine(Sensor sensor, std::size_t i, double z, const Vector3d& normal) {
  const Vector3d to_light = Vector3d(traits_of(sensor).baseline, 0, 0) - z * ray(i);
  return -normal.dot(to_light.normalized());
}

/// The noise law at a pixel that sees this plane: the standard deviation of its depth.
double law(Sensor sensor, std::size_t i, double z, const Vector3d& normal, double reflectance) {
  const Vector3d along = ray(i);
  const double cosine = std::abs(normal.dot(along)) / along.norm();
  const double baseline = traits_of(sensor).baseline;
  switch (sensor) {
    case Sensor::time_of_flight:
      return kernels::time_of_flight_sigma(
                 kernels::time_of_flight_signal(z * along.norm(), cosine, reflectance)) /
             along.norm();
    case Sensor::stereo:
      return kernels::stereo_sigma(z, kCamera.fx, baseline);
    case Sensor::laser:
      return kernels::laser_sigma(z, baseline);
    case Sensor::structured_light:
      break;
  }
  return kernels::structured_light_sigma(z, std::acos(cosine));
}

TEST(MeasureScene, GivesExactDepthsWithoutNoise) {
  for (const Sensor sensor : kSensors) {
    for (const double angle : {0.0, 40 * kDegree}) {
      const Scan measured = scan({plane(0.8, angle)}, {sensor, 0, 0.0F});
      const Vector3d normal(std::sin(angle), 0, std::cos(angle));
      for (std::size_t i = 0; i < measured.depths.size(); ++i) {
        const double z = 0.8 * normal.z() / normal.dot(ray(i));
        ASSERT_NEAR(measured.exact.depth[i], z, 1e-6 * z) << "float precision";
        if (measured.depths[i] == 0) {
          EXPECT_GT(z, 1.2) << "beyond the laser's range";
        } else {
          ASSERT_NEAR(measured.at(i), z, 0.5 * measured.step + 1e-6 * z);
        }
      }
    }
  }
}

// The residuals divided by the law's sigma have the standard deviation 1. Quantization adds a
// twelfth of the squared depth step. With n numbers the standard error is 1 / sqrt(2 n); the bound
// is 5 of those.
TEST(MeasureScene, ErrsByTheLawOfItsSensor) {
  for (const Sensor sensor : kSensors) {
    for (const double z : {0.6, 0.8, 1.1}) {
      for (const double angle : {0.0, 30 * kDegree, -65 * kDegree}) {
        for (const float noise : {1.0F, 0.5F}) {
          const Scan measured = scan({plane(z, angle)}, {sensor, noise, 0.0F}, false, 0.3);
          const Vector3d normal(std::sin(angle), 0, std::cos(angle));
          double n = 0, sum = 0, squares = 0;
          for (std::size_t i = 0; i < measured.depths.size(); ++i) {
            const double exact = z * normal.z() / normal.dot(ray(i));
            // Away from the ends of the range, where half of the noise is clipped.
            const SensorTraits& traits = traits_of(sensor);
            if (exact < 1.1 * traits.nearest || exact > 0.9 * traits.farthest) continue;
            const double steepness = normal.dot(ray(i)) / ray(i).norm();
            if (std::min(light_cosine(sensor, i, exact, normal), steepness) < 0.174) continue;
            if (sensor == Sensor::time_of_flight && exact > 1.5) continue;  // too little light
            ASSERT_NE(measured.depths[i], 0);
            const double sigma = noise * law(sensor, i, exact, normal, 0.3);
            const double error = (measured.at(i) - exact) /
                                 std::sqrt(sigma * sigma + measured.step * measured.step / 12);
            n += 1;
            sum += error;
            squares += error * error;
          }
          ASSERT_GT(n, 10000);
          EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
          EXPECT_NEAR(std::sqrt(squares / n), 1, 5 / std::sqrt(2 * n))
              << "sensor " << static_cast<int>(sensor) << " at " << z << " m, angle " << angle;
        }
      }
    }
  }
}

TEST(MeasureScene, MeasuresDepthInStepsOfDisparity) {
  const Scan measured = scan({plane(0.9, 0.5)}, {Sensor::stereo, 1, 0.25F});
  const double fb = kCamera.fx * traits_of(Sensor::stereo).baseline;
  for (std::size_t i = 0; i < measured.depths.size(); ++i) {
    if (measured.depths[i] == 0) continue;
    const double steps = fb / measured.at(i) / 0.25;
    // Half a depth step, 0.05 mm, in disparity steps: fb / z^2 / 0.25.
    EXPECT_NEAR(steps, std::round(steps), 0.6e-4 * fb / (measured.at(i) * measured.at(i)) / 0.25);
  }
}

// A half plane at z1 that ends at x = 0, in front of a wall at z2. The ray from the light at x = b
// passes the end and meets the wall at -b (z2 - z1) / z1: from there to the camera's line of sight,
// x = 0, the wall is in shadow.
TEST(MeasureScene, LeavesTheShadowOfALightBesideTheCamera) {
  const double z1 = 0.7, z2 = 0.9;
  for (const bool left : {true, false}) {
    const float far = left ? -5 : 5;
    const Shape front = sheet({far, -5, 0.7F}, {0, -5, 0.7F}, {0, 5, 0.7F}, {far, 5, 0.7F});
    for (const Sensor sensor : kSensors) {
      const Scan measured = scan({front, plane(z2, 0)}, {sensor, 0, 0.0F});
      const double b = traits_of(sensor).baseline, shadow = b * (z2 - z1) / z1;
      std::size_t missing = 0;
      const std::size_t row = kWidth * (kHeight / 2);
      for (std::size_t u = 0; u < kWidth; ++u) missing += measured.depths[row + u] == 0 ? 1 : 0;
      // Seen from the light's side, only the edge itself is hidden.
      const double expected = !left && b > 0 ? shadow * kCamera.fx / z2 : 0;
      if (sensor == Sensor::time_of_flight) {
        EXPECT_EQ(missing, 0U);
      } else {
        EXPECT_NEAR(static_cast<double>(missing), expected + (expected > 0 ? 1 : 2), 1.01)
            << "sensor " << static_cast<int>(sensor) << " left " << left;
      }
    }
  }
}

TEST(MeasureScene, LetsPixelsOfATimeOfFlightCameraFloatAtEdges) {
  const Shape front = sheet({-5, -5, 0.7F}, {0.0005F, -5, 0.7F}, {0.0005F, 5, 0.7F}, {-5, 5, 0.7F});
  const Scan measured = scan({front, plane(0.9, 0)}, {Sensor::time_of_flight, 0, {}});
  const std::size_t row = kWidth * (kHeight / 2);
  int floating = 0;
  for (std::size_t u = 0; u < kWidth; ++u) {
    const double z = measured.at(row + u);
    if (z > 0.701 && z < 0.899) ++floating;
  }
  EXPECT_EQ(floating, 1) << "the one pixel that the edge crosses";
}

TEST(MeasureScene, LosesGrazingSurfaces) {
  for (const Sensor sensor : {Sensor::structured_light, Sensor::stereo, Sensor::laser}) {
    const double angle = 84 * kDegree;
    const Vector3d normal(std::sin(angle), 0, std::cos(angle));
    const Scan measured = scan({plane(0.8, angle)}, {sensor, 0, 0.0F});
    for (std::size_t i = 0; i < measured.depths.size(); ++i) {
      const Vector3d along = ray(i);
      if (std::abs(normal.dot(along)) / along.norm() < 0.1736) {
        EXPECT_EQ(measured.depths[i], 0);
      }
    }
  }
  const Scan dark = scan({plane(3, 70 * kDegree)}, {Sensor::time_of_flight, 0, {}}, false, 0.05);
  EXPECT_EQ(dark.depths[kWidth * kHeight / 2 + kWidth / 2], 0) << "too little light comes back";
}

// A metal plane perpendicular to the axis: the light at x = b is reflected into the camera at x = b
// / 2. A pixel at x deviates from that by atan((b - x) / z) - atan(x / z).
TEST(MeasureScene, LosesMetalThatMirrorsTheLight) {
  for (const Sensor sensor : kSensors) {
    const double z = 0.8, b = traits_of(sensor).baseline;
    const Scan measured = scan({plane(z, 0)}, {sensor, 0, 0.0F}, true);
    const std::size_t row = kHeight / 2;  // v within half a pixel of the center
    for (std::size_t u = 0; u < kWidth; ++u) {
      const double x = (static_cast<double>(u) - kCamera.cx) / kCamera.fx * z;
      const double off = std::abs(std::atan((b - x) / z) - std::atan(x / z)) / kDegree;
      if (std::abs(off - 5) < 0.1) continue;  // the border
      EXPECT_EQ(measured.depths[row * kWidth + u] != 0, off > 5)
          << "sensor " << static_cast<int>(sensor) << " pixel " << u;
    }
    const Scan plastic = scan({plane(z, 0)}, {sensor, 0, 0.0F}, false);
    EXPECT_EQ(std::count(plastic.depths.begin(), plastic.depths.end(), 0), 0);
  }
}

}  // namespace
}  // namespace trivet::engine
