/// How far a posed model reaches behind a plane of the scan, and how it bears on that plane.
#pragma once

#include <Eigen/Core>

#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// The part of a posed model behind a plane.
struct PlaneReach {
  float depth = 0;  ///< of the deepest sample behind the plane; negative: all are before it
  Eigen::Vector3f deepest{0, 0, 0};  ///< that sample, in the model's frame
  /// Areas that face away from the plane's normal, projected onto the plane: of what is behind it,
  /// as large as the hole that it needs, and of what bears on it [squared spacings].
  float entering = 0, bearing = 0;
};

/// Measure how the samples of a posed model lie at a plane.
///
/// plane      in the scene's frame, its normal toward the sensor
/// tolerance  samples within this distance of the plane lie on it [scene unit]
PlaneReach reach_behind(const ModelSamples& samples, const Pose& T_scene_model, const Plane& plane,
                        float tolerance) noexcept;

/// Count those of the first `num_samples` samples of a posed model on whose pixels the image shows
/// something more than `distance` behind a plane.
///
/// plane  in the scene's frame, its normal toward the sensor
std::size_t count_seen_behind(const RangeImage& image, const ModelSamples& samples,
                              std::size_t num_samples, const Pose& T_scene_model,
                              const Plane& plane, float distance) noexcept;

/// Whether an image shows a plane on all sides of a place on it: on either side along the rows, the
/// columns and both diagonals, however much is hidden between.
///
/// plane  its number in the image, from 1
/// place  in the camera's frame
bool is_surrounded(const RangeImage& image, std::uint8_t plane,
                   const Eigen::Vector3f& place) noexcept;

}  // namespace trivet::kernels
