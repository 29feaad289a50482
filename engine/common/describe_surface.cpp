#include "engine/common/describe_surface.hpp"

#include <algorithm>

#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kSampleGrain = 64;

}  // namespace

std::vector<std::uint32_t> describe_surface(PointsView points, NormalsView normals,
                                            std::span<const std::uint32_t> keypoints, float radius,
                                            const kernels::FrameLimits& limits, Descriptions& out) {
  const kernels::VoxelHash grid(points, kCell * radius), fine(points, kShare * radius);
  std::vector<float> areas(points.size());
  for_chunks(points.size(), 1024, [&](std::size_t first, std::size_t count) {
    kernels::share_areas(fine, points.slice(first, count), kShare * radius,
                         std::span(areas).subspan(first, count));
  });
  const std::size_t n = keypoints.size(), first_image = out.images.size();
  std::vector<Eigen::Matrix3f> frames(n);
  out.images.resize(first_image + n * kernels::kTriSpinSize);
  const auto image = [&](std::size_t k) {
    return std::span(out.images)
        .subspan(first_image + k * kernels::kTriSpinSize)
        .first<kernels::kTriSpinSize>();
  };
  PerThread<kernels::TriSpinScratch> scratch;
  for_chunks(n, kSampleGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const std::uint32_t i = keypoints[k];
      frames[k] = kernels::describe_keypoint({grid, areas}, {points[i], normals[i]}, radius, limits,
                                             image(k), scratch.local())
                      .axes;
    }
  });

  std::vector<std::uint32_t> kept;  // keypoints with a frame
  for (std::size_t k = 0; k < n; ++k) {
    if (frames[k].isZero()) continue;
    if (kept.size() < k) std::ranges::copy(image(k), image(kept.size()).begin());
    out.keypoints.push_back(points[keypoints[k]]);
    out.frames.push_back(frames[k]);
    kept.push_back(static_cast<std::uint32_t>(k));
  }
  out.images.resize(first_image + kept.size() * kernels::kTriSpinSize);
  return kept;
}

}  // namespace trivet::engine
