#include "kernels/pair_features/pair_feature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/common/fast_angle.hpp"
#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {

ReferenceFrame reference_frame(const Eigen::Vector3f& point, const Eigen::Vector3f& n) noexcept {
  const float sign = std::copysign(1.0F, n.z());
  const float a = -1.0F / (sign + n.z());
  const float b = n.x() * n.y() * a;
  return {point, n, Eigen::Vector3f(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Eigen::Vector3f(b, sign + n.y() * n.y() * a, -n.y())};
}

Pose frame_pose(const ReferenceFrame& frame) noexcept {
  Pose T;
  T.linear().row(0) = frame.normal.transpose();
  T.linear().row(1) = frame.u.transpose();
  T.linear().row(2) = frame.v.transpose();
  T.translation() = -(T.linear() * frame.point);
  return T;
}

namespace {

TRIVET_SIMD_CLONES
void compute_columns(const ReferenceFrame& reference, const OrientedView& seconds,
                     const PairFeaturesSpan& out) noexcept {
  const std::size_t n = seconds.points.size();
  const auto [x, y, z] = seconds.points;
  const auto [mx, my, mz] = seconds.normals;
  const auto [distance, angle1, angle2, angle3, rotation] = out;
  const float px = reference.point.x(), py = reference.point.y(), pz = reference.point.z();
  const float nx = reference.normal.x(), ny = reference.normal.y(), nz = reference.normal.z();
  const float ux = reference.u.x(), uy = reference.u.y(), uz = reference.u.z();
  const float vx = reference.v.x(), vy = reference.v.y(), vz = reference.v.z();
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    distance[i] = std::sqrt(dx * dx + dy * dy + dz * dz);

    // In the reference frame the normal is +x, so |n1 x d| is the distance from the x axis.
    const float along = nx * dx + ny * dy + nz * dz;
    const float across_u = ux * dx + uy * dy + uz * dz;
    const float across_v = vx * dx + vy * dy + vz * dz;
    angle1[i] = fast_atan2(std::sqrt(across_u * across_u + across_v * across_v), along);
    rotation[i] = -fast_atan2(across_v, across_u);

    const float cx = my[i] * dz - mz[i] * dy, cy = mz[i] * dx - mx[i] * dz,
                cz = mx[i] * dy - my[i] * dx;
    angle2[i] =
        fast_atan2(std::sqrt(cx * cx + cy * cy + cz * cz), mx[i] * dx + my[i] * dy + mz[i] * dz);

    const float ex = ny * mz[i] - nz * my[i], ey = nz * mx[i] - nx * mz[i],
                ez = nx * my[i] - ny * mx[i];
    angle3[i] =
        fast_atan2(std::sqrt(ex * ex + ey * ey + ez * ez), nx * mx[i] + ny * my[i] + nz * mz[i]);
  }
}

}  // namespace

void compute_pair_features(const ReferenceFrame& reference, PointsView points, NormalsView normals,
                           const PairFeaturesSpan& out) {
  TRIVET_REQUIRE(normals.size() == points.size() && out.distance.size() == points.size(),
                 "one normal and one feature per point");
  compute_columns(reference, {points, normals}, out);
}

TRIVET_SIMD_CLONES
void quantize_pair_features(const PpfQuantization& quantization, const PairFeaturesSpan& features,
                            std::span<std::uint32_t> cells, std::span<std::uint16_t> rotations) {
  const std::size_t n = features.distance.size();
  TRIVET_REQUIRE(cells.size() == n && rotations.size() == n, "one cell and one rotation per pair");
  const float per_distance = 1.0F / quantization.distance_step;
  const std::int32_t num_angles = static_cast<std::int32_t>(quantization.num_angle_bins);
  const float per_angle = static_cast<float>(num_angles) / std::numbers::pi_v<float>;
  const std::int32_t num_distances = static_cast<std::int32_t>(quantization.num_distance_bins);
  const float* __restrict distance = features.distance.data();
  const float* __restrict angle1 = features.angle_n1_d.data();
  const float* __restrict angle2 = features.angle_n2_d.data();
  const float* __restrict angle3 = features.angle_n1_n2.data();
  const float* __restrict rotation = features.rotation.data();
  std::uint32_t* __restrict cell = cells.data();
  std::uint16_t* __restrict turn = rotations.data();
  const float far = static_cast<float>(num_distances) + 1;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t bin_d = static_cast<std::int32_t>(std::min(distance[i] * per_distance, far));
    const std::int32_t bin_1 =
        std::min(static_cast<std::int32_t>(angle1[i] * per_angle), num_angles - 1);
    const std::int32_t bin_2 =
        std::min(static_cast<std::int32_t>(angle2[i] * per_angle), num_angles - 1);
    const std::int32_t bin_3 =
        std::min(static_cast<std::int32_t>(angle3[i] * per_angle), num_angles - 1);
    const std::uint32_t key = static_cast<std::uint32_t>(
        ((bin_d * num_angles + bin_1) * num_angles + bin_2) * num_angles + bin_3);
    const bool inside = bin_d < num_distances && distance[i] > 0;
    cell[i] = inside ? key : kNoCell;
    turn[i] = quantize_rotation(rotation[i]);
  }
}

}  // namespace trivet::kernels
