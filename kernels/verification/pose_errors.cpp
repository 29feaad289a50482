#include "kernels/verification/pose_errors.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kAxisSteps = 315;

/// The minimum over the symmetries of the maximum over the vertices. `squared_distance(S)` returns
/// a function of the vertex.
template <class SquaredDistance>
double least_greatest(PointsView vertices, std::span<const Isometry3d> symmetries,
                      const SquaredDistance& squared_distance) noexcept {
  assert(!vertices.empty() && !symmetries.empty() && "the identity is a symmetry");
  double least = kInfinity;
  std::size_t farthest = 0;  // start at the vertex where the last symmetry failed; the next one
                             // mostly fails there, too
  for (const Isometry3d& S : symmetries) {
    const auto of_vertex = squared_distance(S);
    const auto value = [&](std::size_t i) {
      const double squared = of_vertex(vertices[i].cast<double>());
      return std::isnan(squared) ? kInfinity : squared;
    };
    double greatest = value(farthest);
    for (std::size_t i = 0; i < vertices.size() && greatest < least; ++i) {
      const double here = value(i);
      if (here > greatest) {
        greatest = here;
        farthest = i;
      }
    }
    least = std::min(least, greatest);
  }
  return std::sqrt(least);
}

/// Call body(u, v, distance) for each non-empty pixel of the map.
template <class Body>
void for_surface(const DistanceMap& map, const Body& body) noexcept {
  const PixelWindow& window = map.window;
  assert(map.distance.size() == window.size() && "one distance a pixel");
  const float* distance = map.distance.data();
  for (std::uint32_t v = window.top; v < window.top + window.height; ++v) {
    for (std::uint32_t u = window.left; u < window.left + window.width; ++u, ++distance) {
      if (*distance > 0) body(u, v, *distance);
    }
  }
}

}  // namespace

std::vector<Isometry3d> discretize_symmetry(const Symmetry& symmetry) {
  std::vector<Isometry3d> discrete{Isometry3d::Identity()};
  for (const Pose& pose : symmetry.poses) discrete.emplace_back(pose.cast<double>());
  if (!symmetry.axis) return discrete;

  const Vector3d direction = symmetry.axis->direction.cast<double>().normalized();
  const Eigen::Translation3d to_axis(symmetry.axis->point.cast<double>());
  std::vector<Isometry3d> all;
  all.reserve(discrete.size() * kAxisSteps);
  for (const Isometry3d& first : discrete) {
    for (int step = 0; step < kAxisSteps; ++step) {
      const Eigen::AngleAxisd turn(2 * std::numbers::pi * step / kAxisSteps, direction);
      all.emplace_back(to_axis * turn * to_axis.inverse() * first);
    }
  }
  return all;
}

double mssd(PointsView vertices, const Isometry3d& estimate, const Isometry3d& truth,
            std::span<const Isometry3d> symmetries) noexcept {
  return least_greatest(vertices, symmetries, [&](const Isometry3d& S) {
    const Isometry3d target = truth * S;
    const Eigen::Matrix3d turn = estimate.linear() - target.linear();
    const Vector3d shift = estimate.translation() - target.translation();
    return [turn, shift](const Vector3d& vertex) -> double {
      return (turn * vertex + shift).squaredNorm();
    };
  });
}

double mspd(PointsView vertices, const Camera& camera, const Isometry3d& estimate,
            const Isometry3d& truth, std::span<const Isometry3d> symmetries) noexcept {
  return least_greatest(vertices, symmetries, [&](const Isometry3d& S) {
    return [&camera, &estimate, target = Isometry3d(truth * S)](const Vector3d& vertex) -> double {
      const Vector3d a = estimate * vertex, b = target * vertex;
      const double du = camera.fx * (a.x() / a.z() - b.x() / b.z());
      const double dv = camera.fy * (a.y() / a.z() - b.y() / b.z());
      return du * du + dv * dv;
    };
  });
}

void depths_to_distances(const Camera& camera, std::uint32_t width, std::span<float> depths) {
  TRIVET_REQUIRE(width > 0 && depths.size() % width == 0, "whole rows");
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double x = (static_cast<double>(i % width) - camera.cx) / camera.fx;
    const double y = (static_cast<double>(i / width) - camera.cy) / camera.fy;
    depths[i] = static_cast<float>(static_cast<double>(depths[i]) * std::sqrt(x * x + y * y + 1));
  }
}

void vsd(const DistanceMap& measured, const DistanceMap& estimate, const DistanceMap& truth,
         const VsdTolerances& tolerances, std::span<double> errors) {
  const double delta = tolerances.delta, diameter = tolerances.diameter;
  const std::span<const double> taus = tolerances.taus;
  TRIVET_REQUIRE(errors.size() == taus.size() && diameter > 0, "one error a tolerance");
  std::size_t in_truth = 0, in_estimate = 0, in_both = 0;
  for_surface(truth, [&](std::uint32_t u, std::uint32_t v, float distance) {
    if (is_visible(distance, measured.at(u, v), delta)) ++in_truth;
  });
  std::ranges::fill(errors, 0.0);  // first counts pixels of both that are too far apart
  for_surface(estimate, [&](std::uint32_t u, std::uint32_t v, float distance) {
    const float sensed = measured.at(u, v), expected = truth.at(u, v);
    if (!is_visible(expected, sensed, delta)) {
      if (is_visible(distance, sensed, delta)) ++in_estimate;
      return;
    }
    ++in_estimate;
    ++in_both;
    const double apart =
        std::abs(static_cast<double>(expected) - static_cast<double>(distance)) / diameter;
    for (std::size_t k = 0; k < taus.size(); ++k) errors[k] += apart >= taus[k] ? 1 : 0;
  });

  const std::size_t in_either = in_truth + in_estimate - in_both;
  const auto in_one = static_cast<double>(in_either - in_both);
  for (double& error : errors)
    error = in_either == 0 ? 1 : (error + in_one) / static_cast<double>(in_either);
}

}  // namespace trivet::kernels
