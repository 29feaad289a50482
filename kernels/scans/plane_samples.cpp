#include "kernels/scans/plane_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr double kSamples = 6000;
constexpr float kLeastCosine = 0.2F;  // a surface at grazing incidence counts as at most five
                                      // pixels

}  // namespace

PlaneSamples sample_for_planes(const RangeImage& image) {
  const ImageGeometry& geometry = image.geometry;
  const auto measured = std::ranges::count_if(image.depth, [](float depth) { return depth > 0; });
  const std::size_t stride =
      clamped_integer(std::sqrt(static_cast<double>(measured) / kSamples), std::size_t{1},
                      std::size_t{geometry.width} + geometry.height);
  PlaneSamples samples;
  for (std::size_t v = stride / 2; v < geometry.height; v += stride) {
    for (std::size_t u = stride / 2; u < geometry.width; u += stride) {
      const std::size_t pixel = v * geometry.width + u;
      const float depth = image.depth[pixel];
      const Eigen::Vector3f n = image.normals[pixel];
      if (!(depth > 0) || !std::isfinite(n.x())) continue;
      const Eigen::Vector3f p = geometry.back_project(pixel, depth);
      const float facing = std::max(kLeastCosine, -n.dot(p.normalized()));
      samples.points.push_back(p);
      samples.normals.push_back(n);
      samples.areas.push_back(depth * depth / (geometry.fx * geometry.fy) / facing *
                              static_cast<float>(stride * stride));
      samples.total_area += samples.areas.back();
    }
  }
  return samples;
}

}  // namespace trivet::kernels
