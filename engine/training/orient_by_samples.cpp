#include "engine/training/orient_by_samples.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/common/parallel.hpp"
#include "kernels/common/voxel_hash.hpp"

namespace trivet::engine {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kOtherSheet = 16;  // factor on the squared distance if normals disagree
// Radius within which nearly all points have a sample [spacings]; samples beyond it cannot cost
// less.
constexpr float kNear = 1.25F, kFar = 4;

struct NearestSample {
  float cost = kInfinity;
  std::uint32_t index = 0;
  float cosine = 0;
};

/// Whether the signs of normals are known.
enum class Signs { open, known };

/// The sample with the lowest cost within a radius. Thin walls have another sheet just behind.
template <Signs kSigns>
NearestSample nearest_sample(const kernels::VoxelHash& grid, NormalsView sample_normals,
                             const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                             float radius) {
  NearestSample best;
  grid.visit_within(point, radius, [&](std::uint32_t s, float squared) {
    if (squared > best.cost) return;
    const float cosine = sample_normals[s].dot(normal);
    const float alike = kSigns == Signs::open ? std::abs(cosine) : cosine;
    const float cost = squared * (alike > 0.5F ? 1 : kOtherSheet);
    if (cost < best.cost || (cost == best.cost && s < best.index)) best = {cost, s, cosine};
  });
  return best;
}

template <Signs kSigns>
void ask_samples(PointsView samples, NormalsView sample_normals, std::span<const ViewMask> views,
                 float spacing, PointsView points, NormalsSpan normals) {
  const kernels::VoxelHash grid(samples, kNear * spacing);
  for_chunks(points.size(), 1024, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const Eigen::Vector3f point = points[i], normal = PointsView(normals)[i];
      const float near = kNear * spacing;
      NearestSample best = nearest_sample<kSigns>(grid, sample_normals, point, normal, near);
      if (best.cost > near * near)
        best = nearest_sample<kSigns>(grid, sample_normals, point, normal, kFar * spacing);
      if (!(best.cost < kInfinity) || (!views.empty() && views[best.index] == ViewMask{})) {
        normals.set(i, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
      } else if (kSigns == Signs::open && best.cosine < 0) {
        normals.set(i, -normal);
      }
    }
  });
}

}  // namespace

void orient_by_samples(PointsView samples, NormalsView sample_normals,
                       std::span<const ViewMask> views, float spacing, PointsView points,
                       NormalsSpan normals) {
  ask_samples<Signs::open>(samples, sample_normals, views, spacing, points, normals);
}

void hide_by_samples(PointsView samples, NormalsView sample_normals,
                     std::span<const ViewMask> views, float spacing, PointsView points,
                     NormalsSpan normals) {
  ask_samples<Signs::known>(samples, sample_normals, views, spacing, points, normals);
}

}  // namespace trivet::engine
