#include "descriptors/descriptors.hpp"

#include <algorithm>
#include <cmath>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"

namespace trivet::bench {
namespace {

constexpr std::size_t kGrain = 64;

/// Every keypoint gets a frame, however uncertain, so that all descriptors have the same keypoints.
constexpr kernels::FrameLimits kNoLimits{.min_points = 0, .min_hold = 0, .min_second_ratio = 1};

/// Calls body(grid, keypoint, its features, scratch) for each keypoint.
template <class Body>
void for_each_keypoint(const KeypointSurface& surface, std::span<float> features, Body&& body) {
  const kernels::VoxelHash grid(surface.points, 0.5F * surface.radius);
  const std::size_t n = surface.keypoints.size();
  if (n == 0) return;
  const std::size_t size = features.size() / n;
  engine::PerThread<kernels::TriSpinScratch> scratch;
  engine::for_chunks(n, kGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k)
      body(grid, k, features.subspan(k * size, size), scratch.local());
  });
}

void describe_trisi(const KeypointSurface& surface, std::span<float> features) {
  for_each_keypoint(
      surface, features, [&](const auto& grid, std::size_t k, auto out, auto& scratch) {
        kernels::describe_keypoint(
            {grid, surface.areas}, {surface.keypoints[k], surface.keypoint_normals[k]},
            surface.radius, kNoLimits, out.template first<kernels::kTriSpinSize>(), scratch);
      });
}

/// One spin image about the normal; finish(image) normalizes it so that distances are comparable.
template <class Finish>
void describe_spin(const KeypointSurface& surface, std::span<float> features, Finish&& finish) {
  for_each_keypoint(
      surface, features, [&](const auto& grid, std::size_t k, auto out, auto& scratch) {
        const Eigen::Vector3f normal = surface.keypoint_normals[k];
        if (!normal.allFinite()) return;
        const auto image = out.template first<kernels::kSpinImageSize>();
        kernels::gather_support(grid, surface.areas, surface.keypoints[k], surface.radius,
                                scratch.support);
        kernels::spin_image(scratch.support, normal, surface.radius, image, scratch.spin);
        finish(image);
      });
}

/// Correlated images are close: |a - b|^2 = 2 - 2 correlation(a, b).
void standardize(std::span<float, kernels::kSpinImageSize> image) {
  double mean = 0, squared = 0;
  for (const float value : image) mean += static_cast<double>(value) / kernels::kSpinImageSize;
  for (const float value : image) squared += std::pow(static_cast<double>(value) - mean, 2);
  if (!(squared > 0)) return;
  for (float& value : image)
    value = static_cast<float>((static_cast<double>(value) - mean) / std::sqrt(squared));
}

void describe_spin_by_correlation(const KeypointSurface& surface, std::span<float> features) {
  describe_spin(surface, features, standardize);
}

void describe_spin_by_roots(const KeypointSurface& surface, std::span<float> features) {
  describe_spin(surface, features, kernels::normalize_spin_image);
}

}  // namespace

const std::vector<Descriptor>& descriptors() {
  static const std::vector<Descriptor> all{
      {"TriSI", kernels::kTriSpinSize, describe_trisi},
      {"TriSI, 60 components", kernels::kTriSpinSize, describe_trisi, 60},
      {"spin image, correlation", kernels::kSpinImageSize, describe_spin_by_correlation},
      {"spin image, square roots", kernels::kSpinImageSize, describe_spin_by_roots},
#ifdef TRIVET_BENCH_PCL
      {"RoPS (PCL)", kRopsSize, describe_rops},
#endif
  };
  return all;
}

Column<float> describe(const Descriptor& descriptor, const KeypointSurface& surface) {
  Column<float> features(surface.keypoints.size() * descriptor.size, 0.0F);
  descriptor.describe(surface, features);
  return features;
}

}  // namespace trivet::bench
