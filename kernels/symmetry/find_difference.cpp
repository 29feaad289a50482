#include "kernels/symmetry/find_difference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/surfaces/visibility.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr float kDiscRadius = 1.5F;     // [spacings]
constexpr float kFacingTheSame = 0.5F;  // cosine
constexpr float kLinked = 3;            // [spacings]
constexpr float kOfLargest = 0.5F;
constexpr std::size_t kDistanceLanes = 16;

/// The squared distance of a point from discs of a radius about the samples that face its way, and
/// from all samples.
TRIVET_SIMD_CLONES
float squared_distance(const ModelSamples& surface, const Eigen::Vector3f& point,
                       const Eigen::Vector3f& normal, float radius) noexcept {
  const float *const xs = surface.points.x.data(), *const ys = surface.points.y.data(),
                     *const zs = surface.points.z.data();
  const float *const us = surface.normals.x.data(), *const vs = surface.normals.y.data(),
                     *const ws = surface.normals.z.data();
  const float px = point.x(), py = point.y(), pz = point.z();
  const float mx = normal.x(), my = normal.y(), mz = normal.z();
  const auto squared = [&](std::size_t k) {
    const float dx = px - xs[k], dy = py - ys[k], dz = pz - zs[k];
    const float height = dx * us[k] + dy * vs[k] + dz * ws[k];
    const float all = dx * dx + dy * dy + dz * dz;
    const float along = std::sqrt(std::max(all - height * height, 0.0F));
    const float beyond = std::max(along - radius, 0.0F);
    const bool faces_alike = us[k] * mx + vs[k] * my + ws[k] * mz > kFacingTheSame;
    return faces_alike ? height * height + beyond * beyond : all;
  };
  std::array<float, kDistanceLanes> least;
  least.fill(std::numeric_limits<float>::max());
  const std::size_t n = surface.points.size(), whole = n - n % kDistanceLanes;
  for (std::size_t k = 0; k < whole; k += kDistanceLanes) {
    for (std::size_t lane = 0; lane < kDistanceLanes; ++lane) {
      const float distance = squared(k + lane);
      least[lane] = distance < least[lane] ? distance : least[lane];
    }
  }
  for (std::size_t k = whole; k < n; ++k) least[0] = std::min(least[0], squared(k));
  return *std::min_element(least.begin(), least.end());
}

/// A sample of either surface, in the frame of the first.
struct Differing {
  Eigen::Vector3f point, normal;
  float distance;
  const ViewMask* views;
  bool of_second;
};

/// The samples that are far from the other surface and linked to the farthest one.
std::vector<Differing> region_around_largest(std::vector<Differing> far, float link) {
  if (far.empty()) return far;
  std::swap(*std::ranges::max_element(far, {}, &Differing::distance), far.front());
  // Those before `linked` belong to the region; those before `next` have linked their neighbors.
  std::size_t linked = 1;
  for (std::size_t next = 0; next < linked; ++next) {
    for (std::size_t k = linked; k < far.size(); ++k) {
      if ((far[k].point - far[next].point).squaredNorm() <= link * link)
        std::swap(far[k], far[linked++]);
    }
  }
  far.resize(linked);
  return far;
}

Eigen::Vector3f best_view(std::span<const Differing> region, const Eigen::Matrix3f& R) {
  float most = 0;
  Eigen::Vector3f best = Eigen::Vector3f::Zero();
  for (std::size_t view = 0; view < kNumViews; ++view) {
    const Eigen::Vector3f direction = view_direction(view);
    const std::size_t view_of_second = nearest_view(R.transpose() * direction);
    float seen = 0;
    for (const Differing& sample : region) {
      if (is_visible(*sample.views, sample.of_second ? view_of_second : view))
        seen += sample.distance * std::max(sample.normal.dot(direction), 0.0F);
    }
    if (seen <= most) continue;
    most = seen;
    best = direction;
  }
  return best;
}

}  // namespace

void surface_distances(const ModelSamples& surface, PointsView points, NormalsView normals,
                       std::span<float> out) noexcept {
  const float radius = kDiscRadius * surface.spacing;
  for (std::size_t i = 0; i < points.size(); ++i)
    out[i] = std::sqrt(squared_distance(surface, points[i], normals[i], radius));
}

SurfaceDifference find_difference(const ModelSamples& first, const ModelSamples& second,
                                  const Pose& T_first_second) {
  const Pose T_second_first = T_first_second.inverse();
  std::vector<Differing> samples;
  const auto add = [&](const ModelSamples& of, const ModelSamples& other, const Pose& T_other_of,
                       const Pose& T_first_of, bool of_second) {
    Points moved;
    Normals turned;
    for (std::size_t i = 0; i < of.points.size(); ++i) {
      moved.push_back(T_other_of * of.points[i]);
      turned.push_back(T_other_of.linear() * of.normals[i]);
    }
    std::vector<float> distances(moved.size());
    surface_distances(other, moved, turned, distances);
    for (std::size_t i = 0; i < moved.size(); ++i)
      samples.push_back({T_first_of * of.points[i], T_first_of.linear() * of.normals[i],
                         distances[i], &of.views[i], of_second});
  };
  add(first, second, T_second_first, Pose::Identity(), false);
  add(second, first, T_first_second, T_first_second, true);

  SurfaceDifference out;
  out.deviation = std::ranges::max_element(samples, {}, &Differing::distance)->distance;
  std::erase_if(samples, [&](const Differing& sample) {
    return !(sample.distance >= kOfLargest * out.deviation);
  });
  const std::vector<Differing> region =
      region_around_largest(std::move(samples), kLinked * std::max(first.spacing, second.spacing));
  for (const Differing& sample : region)
    out.center += sample.point / static_cast<float>(region.size());
  for (const Differing& sample : region)
    out.size = std::max(out.size, 2 * (sample.point - out.center).norm());
  out.look_from = best_view(region, T_first_second.linear());
  return out;
}

}  // namespace trivet::kernels
