#include "kernels/verification/posed_samples.hpp"

#include <algorithm>
#include <cassert>

#include "kernels/surfaces/visibility.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

TRIVET_SIMD_CLONES
void move_columns(const Eigen::Matrix3f& R, const Eigen::Vector3f& t, std::size_t n,
                  const float* __restrict x, const float* __restrict y, const float* __restrict z,
                  float* __restrict out_x, float* __restrict out_y,
                  float* __restrict out_z) noexcept {
  const float xx = R(0, 0), xy = R(0, 1), xz = R(0, 2), tx = t.x();
  const float yx = R(1, 0), yy = R(1, 1), yz = R(1, 2), ty = t.y();
  const float zx = R(2, 0), zy = R(2, 1), zz = R(2, 2), tz = t.z();
  for (std::size_t i = 0; i < n; ++i) {
    out_x[i] = xx * x[i] + xy * y[i] + xz * z[i] + tx;
    out_y[i] = yx * x[i] + yy * y[i] + yz * z[i] + ty;
    out_z[i] = zx * x[i] + zy * y[i] + zz * z[i] + tz;
  }
}

TRIVET_SIMD_CLONES
void turn_columns(const Eigen::Matrix3f& R, std::size_t n, const float* __restrict x,
                  const float* __restrict y, const float* __restrict z, float* __restrict out_x,
                  float* __restrict out_y, float* __restrict out_z) noexcept {
  const float xx = R(0, 0), xy = R(0, 1), xz = R(0, 2);
  const float yx = R(1, 0), yy = R(1, 1), yz = R(1, 2);
  const float zx = R(2, 0), zy = R(2, 1), zz = R(2, 2);
  for (std::size_t i = 0; i < n; ++i) {
    out_x[i] = xx * x[i] + (xy * y[i] + xz * z[i]);
    out_y[i] = yx * x[i] + (yy * y[i] + yz * z[i]);
    out_z[i] = zx * x[i] + (zy * y[i] + zz * z[i]);
  }
}

TRIVET_SIMD_CLONES
void find_pixels(const ImageGeometry& geometry, std::size_t n, const float* __restrict x,
                 const float* __restrict y, const float* __restrict z,
                 std::int32_t* __restrict column, std::int32_t* __restrict row) noexcept {
  const float fx = geometry.fx, fy = geometry.fy, cx = geometry.cx, cy = geometry.cy;
  const auto width = static_cast<float>(geometry.width);
  const auto height = static_cast<float>(geometry.height);
  for (std::size_t i = 0; i < n; ++i) {
    const float u = fx * x[i] / z[i] + cx + 0.5F, v = fy * y[i] / z[i] + cy + 0.5F;
    const bool inside = (z[i] > 0) & (u >= 0) & (v >= 0) & (u < width) & (v < height);
    column[i] = static_cast<std::int32_t>(inside ? u : -1.0F);
    row[i] = static_cast<std::int32_t>(inside ? v : -1.0F);
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
  const std::size_t n = block.count;
  move_points(T_camera_model_, samples_.points.slice(first, n), block.x.data(), block.y.data(),
              block.z.data());
  const NormalsView normals = samples_.normals.slice(first, n);
  turn_columns(T_camera_model_.linear(), n, normals.x.data(), normals.y.data(), normals.z.data(),
               block.normal_x.data(), block.normal_y.data(), block.normal_z.data());
  find_pixels(geometry_, n, block.x.data(), block.y.data(), block.z.data(), block.column.data(),
              block.row.data());
}

void move_points(const Pose& pose, PointsView points, float* x, float* y, float* z) noexcept {
  move_columns(pose.linear(), pose.translation(), points.size(), points.x.data(), points.y.data(),
               points.z.data(), x, y, z);
}

}  // namespace trivet::kernels
