/// Rotations in eight bytes.
#pragma once

#include <Eigen/Core>

#include "storage/data/feature_index.hpp"

namespace trivet::kernels {

/// The code of a rotation, and the rotation of a code: it differs from the one encoded by less than
/// 1e-4 rad. Of the codes of a rotation and its negative quaternion that with w > 0 is given.
///
/// turn  a rotation matrix
RotationCode encode_rotation(const Eigen::Matrix3f& turn) noexcept;
Eigen::Matrix3f decode_rotation(const RotationCode& code) noexcept;

}  // namespace trivet::kernels
