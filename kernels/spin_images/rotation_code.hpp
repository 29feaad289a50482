/// Compression of rotations to eight bytes.
#pragma once

#include <Eigen/Core>

#include "storage/data/feature_index.hpp"

namespace trivet::kernels {

/// Encode and decode a rotation; the decoded rotation differs by less than 1e-4 rad. Of the two
/// quaternions of a rotation, the one with w > 0 is encoded.
///
/// turn  a rotation matrix
RotationCode encode_rotation(const Eigen::Matrix3f& turn) noexcept;
Eigen::Matrix3f decode_rotation(const RotationCode& code) noexcept;

}  // namespace trivet::kernels
