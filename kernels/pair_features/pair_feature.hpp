/// The point pair feature of Drost et al., CVPR 2010, its quantized key, and the rotation angle of
/// a pair.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <span>

#include "kernels/common/fast_angle.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::kernels {

/// The frame with the reference point as origin and its normal as +x: rows normal, u, v of a
/// rotation.
struct ReferenceFrame {
  Eigen::Vector3f point, normal, u, v;
};

/// Choose u and v from the normal alone (Duff et al., JCGT 2017), so that frames need not be
/// stored.
ReferenceFrame reference_frame(const Eigen::Vector3f& point,
                               const Eigen::Vector3f& unit_normal) noexcept;

/// T of eq. (2) of the paper: maps the point to the origin and its normal to +x.
Pose frame_pose(const ReferenceFrame& frame) noexcept;

/// Columns of the features of n pairs that share the reference point.
struct PairFeaturesSpan {
  std::span<float> distance;     ///< |p2 - p1|
  std::span<float> angle_n1_d;   ///< [0, pi]
  std::span<float> angle_n2_d;   ///< [0, pi]
  std::span<float> angle_n1_n2;  ///< [0, pi]
  std::span<float> rotation;  ///< rotation about +x that moves the second point into the half plane
                              ///< y >= 0, z = 0 of the reference frame; [-pi, pi]
};

/// Compute F = (|d|, ang(n1,d), ang(n2,d), ang(n1,n2)) with d = p2 - p1 (eq. (1)), and the rotation
/// angle.
///
/// points, normals   n second points of the pairs and their unit normals
/// out               five columns of n values
/// Angles use atan2(|a x b|, a . b) because acos of a dot product loses precision near 0 and pi.
/// A pair of coincident points gives distance 0 and angles 0. No allocation; pairs are independent.
void compute_pair_features(const ReferenceFrame& reference, PointsView points, NormalsView normals,
                           const PairFeaturesSpan& out);

/// Angles as fractions of a full turn: differences wrap around in 16-bit arithmetic.
inline std::uint16_t quantize_rotation(float angle_rad) noexcept {
  // Two extra turns keep the number positive, so that truncation rounds to nearest.
  constexpr float kPerRadian = 65536.0F / (2 * std::numbers::pi_v<float>);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(angle_rad * kPerRadian + 131072.5F));
}

inline constexpr std::uint32_t kNoCell = 0xFFFFFFFFU;

/// Write the cell of each pair: ((bin_d * A + bin_1) * A + bin_2) * A + bin_3. The distance is most
/// significant, so tables of equal step and different size share keys. kNoCell for coincident
/// points and for pairs beyond the last distance bin.
void quantize_pair_features(const PpfQuantization& quantization, const PairFeaturesSpan& features,
                            std::span<std::uint32_t> cells, std::span<std::uint16_t> rotations);

}  // namespace trivet::kernels
