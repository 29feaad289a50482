/// Scenes and models given by formulas: rendered by analytic ray intersection, sampled without
/// meshes.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::test {

/// The first intersection of a ray with a surface, at origin + t direction; t is infinite without
/// one.
struct SurfaceHit {
  double t = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal{0, 0, 0};
};
using Surface =
    std::function<SurfaceHit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

inline Surface sphere(double radius) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) -> SurfaceHit {
    const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
    if (b * b < a * c) return {};
    const double t = (-b - std::sqrt(b * b - a * c)) / a;
    return t > 0 ? SurfaceHit{t, (o + t * d).normalized()} : SurfaceHit{};
  };
}

struct HalfSpace {
  Eigen::Vector3d normal;  ///< unit, outward
  double offset;           ///< inside: normal . p <= offset
};
using Solid = std::vector<HalfSpace>;  ///< the intersection of all half spaces

inline Solid box_of(const Eigen::Vector3d& half) {
  Solid out;
  for (int k = 0; k < 3; ++k) {
    out.push_back({Eigen::Vector3d::Unit(k), half[k]});
    out.push_back({-Eigen::Vector3d::Unit(k), half[k]});
  }
  return out;
}

/// A box with three different side lengths and a cut corner, without any symmetry.
inline Solid cut_box() {
  Solid out = box_of({0.5, 0.35, 0.25});
  out.push_back({Eigen::Vector3d(1, 2, 3).normalized(), 0.35});
  return out;
}

/// The boundary of a solid; for a single half space, a plane.
inline Surface boundary(const Solid& solid) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) -> SurfaceHit {
    SurfaceHit enter{0, {0, 0, 0}};
    double leave = std::numeric_limits<double>::infinity();
    for (const HalfSpace& side : solid) {
      const double along = side.normal.dot(d), height = side.offset - side.normal.dot(o);
      if (along < 0 && height / along > enter.t) enter = {height / along, side.normal};
      if (along > 0) leave = std::min(leave, height / along);
      if (along == 0 && height < 0) return {};
    }
    return enter.t > 0 && enter.t < leave ? enter : SurfaceHit{};
  };
}

inline Surface moved(const Surface& surface, const Pose& pose) {
  const Eigen::Matrix3d R = pose.linear().cast<double>();
  const Eigen::Vector3d t = pose.translation().cast<double>();
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    const SurfaceHit hit = surface(R.transpose() * (o - t), R.transpose() * d);
    return SurfaceHit{hit.t, R * hit.normal};
  };
}

/// A surface in the camera's frame, and the plane number of its pixels.
struct PlacedSurface {
  Surface surface;
  std::uint8_t plane = 0;
};

/// Renders surfaces given in the camera's frame.
inline kernels::RangeImage render(const kernels::ImageGeometry& geometry,
                                  const std::vector<PlacedSurface>& surfaces) {
  kernels::RangeImage image;
  image.geometry = geometry;
  const std::size_t n = std::size_t{geometry.width} * geometry.height;
  image.depth.assign(n, 0);
  image.plane.assign(n, 0);
  image.near_plane.assign(n, 0);
  image.normals.resize(n);
  for (std::size_t pixel = 0; pixel < n; ++pixel) {
    const Eigen::Vector3d ray = geometry.back_project(pixel, 1).cast<double>();
    SurfaceHit nearest;
    for (const PlacedSurface& entry : surfaces) {
      const SurfaceHit hit = entry.surface(Eigen::Vector3d::Zero(), ray);
      if (hit.t >= nearest.t) continue;
      nearest = hit;
      image.plane[pixel] = image.near_plane[pixel] = entry.plane;
    }
    const bool measured = std::isfinite(nearest.t);
    const auto nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    image.depth[pixel] = measured ? static_cast<float>(nearest.t) : 0;
    image.normals.set(pixel, (measured ? nearest.normal : nan.eval()).cast<float>());
  }
  return image;
}

/// Surface samples of a convex model about its origin, with the views that follow from its normals.
struct SampledModel {
  Points points;
  Normals normals;
  std::vector<ViewMask> views;
  float spacing = 0, diameter = 0;

  void add(const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
    points.push_back(p);
    normals.push_back(n);
    views.emplace_back();
    for (std::size_t d = 0; d < kernels::kNumViews; ++d) {
      if (n.dot(kernels::view_direction(d)) <= kernels::kMinViewCosine) continue;
      views.back()[d / 64] |= std::uint64_t{1} << (d % 64);
    }
  }
  kernels::ModelSamples view() const {
    return {points, normals, views, spacing, diameter, Eigen::Vector3f::Zero()};
  }
};

/// The k-th point of a low-discrepancy sequence in the unit square (multiples of 1/g and 1/g^2 with
/// g^3 = g + 1).
inline Eigen::Vector2d even(int k) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  return {fraction(0.5 + 0.7548776662466927 * k), fraction(0.5 + 0.5698402909980532 * k)};
}

inline SampledModel sampled_sphere(int n, float radius) {
  SampledModel model;
  for (int k = 0; k < n; ++k) {
    const double z = 2 * even(k).x() - 1, turn = 2 * std::numbers::pi * even(k).y();
    const double r = std::sqrt(1 - z * z);
    const auto direction =
        Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>().eval();
    model.add(radius * direction, direction);
  }
  model.spacing = radius * std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n));
  model.diameter = 2 * radius;
  return model;
}

/// Samples of equal density on every face, one face after the other in turn; `extent` bounds the
/// solid.
inline SampledModel sampled_solid(const Solid& solid, float spacing, float extent) {
  SampledModel model;
  const auto trials = static_cast<int>(4 * extent * extent / (spacing * spacing));
  for (int k = 0; k < trials; ++k) {
    for (const HalfSpace& face : solid) {
      const Eigen::Vector3d u = face.normal.unitOrthogonal(), v = face.normal.cross(u);
      const Eigen::Vector2d at = (2 * even(k).array() - 1) * static_cast<double>(extent);
      const Eigen::Vector3d p = face.offset * face.normal + at.x() * u + at.y() * v;
      const bool inside = std::ranges::all_of(solid, [&](const HalfSpace& other) {
        return other.normal.dot(p) <= other.offset + 1e-9;
      });
      if (inside) model.add(p.cast<float>(), face.normal.cast<float>());
    }
  }
  model.spacing = spacing;
  model.diameter = 2 * extent;
  return model;
}

/// A pose in front of the camera: a rotation vector and a position.
inline Pose placed(const Eigen::Vector3f& place, const Eigen::Vector3f& rotation = {0, 0, 0}) {
  Pose pose = Pose::Identity();
  const float angle = rotation.norm();
  if (angle > 0) pose.linear() = Eigen::AngleAxisf(angle, rotation / angle).toRotationMatrix();
  pose.translation() = place;
  return pose;
}

/// A wall that faces the camera at this depth; plane number 1 if it is background.
inline PlacedSurface wall(double depth, std::uint8_t plane = 0) {
  return {boundary({{Eigen::Vector3d(0, 0, -1), -depth}}), plane};
}

/// The left half of a wall: an occluder in front of an object.
inline PlacedSurface left_half(double depth) {
  Solid half = box_of({10, 10, 0.01});
  half[0].offset = 0;
  return {moved(boundary(half), placed({0, 0, static_cast<float>(depth)}))};
}

}  // namespace trivet::test
