#include "kernels/verification/posed_samples.hpp"

#include <algorithm>
#include <cassert>

#include "kernels/surfaces/visibility.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

TRIVET_SIMD_CLONES
void turn_normals(const Eigen::Matrix3f& R, const NormalsView& normals,
                  const NormalsSpan& out) noexcept {
  const auto [x, y, z] = normals;
  const auto [out_x, out_y, out_z] = out;
  const std::size_t n = normals.size();
  const float xx = R(0, 0), xy = R(0, 1), xz = R(0, 2);
  const float yx = R(1, 0), yy = R(1, 1), yz = R(1, 2);
  const float zx = R(2, 0), zy = R(2, 1), zz = R(2, 2);
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    out_x[i] = xx * x[i] + (xy * y[i] + xz * z[i]);
    out_y[i] = yx * x[i] + (yy * y[i] + yz * z[i]);
    out_z[i] = zx * x[i] + (zy * y[i] + zz * z[i]);
  }
}

TRIVET_SIMD_CLONES
void find_pixels(const ImageGeometry& geometry, SampleBlock& block) noexcept {
  const float fx = geometry.fx, fy = geometry.fy, cx = geometry.cx, cy = geometry.cy;
  const auto width = static_cast<float>(geometry.width);
  const auto height = static_cast<float>(geometry.height);
  const std::size_t n = block.count;
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    const float z = block.z[i];
    const float u = fx * block.x[i] / z + cx + 0.5F, v = fy * block.y[i] / z + cy + 0.5F;
    const bool inside = (z > 0) & (u >= 0) & (v >= 0) & (u < width) & (v < height);
    block.column[i] = static_cast<std::int32_t>(inside ? u : -1.0F);
    block.row[i] = static_cast<std::int32_t>(inside ? v : -1.0F);
  }
}

}  // namespace

PosedSamples::PosedSamples(const ImageGeometry& geometry, const ModelSamples& samples,
                           const Pose& T_scene_model) noexcept
    : geometry_(geometry),
      samples_(samples),
      T_camera_model_(geometry.T_camera_scene * T_scene_model) {
  const Eigen::Vector3f camera_in_model = T_camera_model_.inverse().translation();
  const std::size_t view = nearest_view((camera_in_model - samples.center).normalized());
  view_word_ = view / 64;
  view_bit_ = view % 64;
}

void PosedSamples::place(std::size_t first, std::size_t end, SampleBlock& block) const noexcept {
  block.first = first;
  block.count = std::min(end - first, kSampleBlock);
  move_points(T_camera_model_, samples_.points.slice(first, block.count), block.points());
  turn_normals(T_camera_model_.linear(), samples_.normals.slice(first, block.count),
               block.normals());
  find_pixels(geometry_, block);
}

TRIVET_SIMD_CLONES
void move_points(const Pose& pose, const PointsView& points, const PointsSpan& out) noexcept {
  const Eigen::Matrix3f R = pose.linear();
  const Eigen::Vector3f t = pose.translation();
  const auto [x, y, z] = points;
  const auto [out_x, out_y, out_z] = out;
  const float xx = R(0, 0), xy = R(0, 1), xz = R(0, 2), tx = t.x();
  const float yx = R(1, 0), yy = R(1, 1), yz = R(1, 2), ty = t.y();
  const float zx = R(2, 0), zy = R(2, 1), zz = R(2, 2), tz = t.z();
  const std::size_t n = points.size();
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    out_x[i] = xx * x[i] + xy * y[i] + xz * z[i] + tx;
    out_y[i] = yx * x[i] + yy * y[i] + yz * z[i] + ty;
    out_z[i] = zx * x[i] + zy * y[i] + zz * z[i] + tz;
  }
}

}  // namespace trivet::kernels
