#include "kernels/symmetry/measure_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trivet::kernels {
namespace {

constexpr float kMinFacing = 0.5F;  // cosine: 60 degrees
constexpr float kNothing = std::numeric_limits<float>::max();

}  // namespace

void measure_deviation(PointsView samples, NormalsView normals, float spacing, const Pose& motion,
                       std::span<float> out) noexcept {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3f q = motion * samples[i], m = motion.linear() * normals[i];
    float facing = kNothing, any = kNothing;  // least squared distances
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const float dx = q.x() - samples.x[k], dy = q.y() - samples.y[k], dz = q.z() - samples.z[k];
      const float nx = normals.x[k], ny = normals.y[k], nz = normals.z[k];
      const float cosine = nx * m.x() + ny * m.y() + nz * m.z();
      const float squared = dx * dx + dy * dy + dz * dz;
      // Along the mean of both normals, two points of one circle have the same height.
      const float sum = dx * (nx + m.x()) + dy * (ny + m.y()) + dz * (nz + m.z());
      const float height = sum * sum / std::max(2 + 2 * cosine, 1e-6F);
      const float along = std::max(std::sqrt(std::max(squared - height, 0.0F)) - spacing, 0.0F);
      const float distance = height + along * along;
      facing = std::min(facing, cosine > kMinFacing ? distance : kNothing);
      any = std::min(any, squared);
    }
    out[i] = std::sqrt(facing < kNothing ? facing : any);
  }
}

}  // namespace trivet::kernels
