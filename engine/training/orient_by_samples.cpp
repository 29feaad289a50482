#include "engine/training/orient_by_samples.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/common/parallel.hpp"
#include "kernels/common/voxel_hash.hpp"

namespace trivet::engine {

void orient_by_samples(PointsView samples, NormalsView sample_normals,
                       std::span<const ViewMask> views, float spacing, PointsView points,
                       NormalsSpan normals) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const kernels::VoxelHash grid(samples, 2 * spacing);
  for_chunks(points.size(), 1024, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const Eigen::Vector3f normal = PointsView(normals)[i];
      // Thin walls have another sheet just behind.
      float best = kInfinity;
      std::uint32_t nearest = 0;
      float cosine = 0;
      grid.visit_within(points[i], 4 * spacing, [&](std::uint32_t s, float squared) {
        const float c = sample_normals[s].dot(normal);
        const float cost = squared * (std::abs(c) > 0.5F ? 1.0F : 16.0F);
        if (cost < best || (cost == best && s < nearest)) {
          best = cost;
          nearest = s;
          cosine = c;
        }
      });
      if (!(best < kInfinity) || (!views.empty() && views[nearest] == ViewMask{})) {
        normals.set(i, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
      } else if (cosine < 0) {
        normals.set(i, -normal);
      }
    }
  });
}

}  // namespace trivet::engine
