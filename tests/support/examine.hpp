/// Full tests of poses, with the tolerance and background that tests share.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "kernels/verification/examine_pose.hpp"
#include "support/rendered_bodies.hpp"

namespace trivet::test {

inline constexpr float kTolerance = 0.003F;

/// Examines with the tolerance and background of all tests.
inline kernels::Examination examine(const kernels::RangeImage& image, const Body& body,
                                    const Pose& pose,
                                    const std::optional<Symmetry::Axis>& free_axis = {},
                                    kernels::ExplainedPixels* explained = nullptr,
                                    kernels::ExamineOptions options = {},
                                    std::vector<kernels::JudgedRay>* rays = nullptr) {
  options.verify.tolerance = kTolerance;
  static const std::array<std::uint8_t, 1> kBackground{1};
  options.verify.plane_is_background = kBackground;
  kernels::ExamineScratch scratch;
  return kernels::examine_pose({&image, 1}, {body.surface, body.samples, pose}, free_axis, options,
                               scratch, {explained, rays});
}

/// Examines with a tolerance that the pose's own residuals may lower to a tenth.
inline kernels::Examination examine_lowered(const kernels::RangeImage& image, const Body& body,
                                            const Pose& pose) {
  kernels::ExamineOptions options;
  options.least_tolerance = 0.1F * kTolerance;
  return examine(image, body, pose, {}, nullptr, options);
}

}  // namespace trivet::test
