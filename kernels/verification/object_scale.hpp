/// What a posed object tells of the scales of the camera that saw it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/ray_crop.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Logarithms of what the focal lengths and the depths of a camera are to be multiplied by.
struct LogScales {
  double focal = 0, depth = 0;
};

struct ScaleOptions {
  float sigma = 0;      ///< of a residual across the surface [scene unit], > 0
  float gate = 0;       ///< residuals beyond it have no weight [scene unit], > 0
  int edge_pixels = 2;  ///< what is as near to an edge does not count, >= 0
};

/// Normal equations of a point-to-plane fit, weights being one over the squared sigma. The unknowns
/// in their order: rotation vector [rad] and translation [scene unit] of the object in the camera's
/// frame, about the image of its center, log focal scale, log depth scale.
struct ObjectEquations {
  using Vector8 = Eigen::Matrix<double, 8, 1>;

  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  Vector8 pull = Vector8::Zero();  ///< information times the step to the solution
  std::vector<Vector8> blocks;     ///< the pull, by squares of pixels that err alike
  std::size_t num_rays = 0;        ///< that were shot
  std::size_t num_used = 0;        ///< that count
};

/// A model before a camera. All are referred to.
struct ObjectInView {
  const RayScene& surface;  ///< of the model, in its own frame
  const ModelSamples& samples;
  const Pose& T_camera_model;  ///< once the camera's scales are applied
};

/// Working memory of gather_object.
struct ScaleScratch {
  Points directions;
  RayHits hits;
  Column<float> residuals;
};

/// Hold the surface of a posed object against the measured depth, along at most some 2,500 rays.
///
/// image   of a pinhole camera, as it was said to be
/// scales  at which the equations are set up
/// Along a ray r = n . (q - h): h where it meets the model, n the model's normal there, q the
/// measured point; Tukey's weights. Derivatives are taken at h: at q they would share the noise of
/// r, which makes all noisy objects look too large. Steep surfaces and what lies near the ends of
/// the model, or of where the scene agrees, stay out: there pixels blend, lean and belong to
/// others. Source of the residual: Chen and Medioni, Image and Vision Computing 10(3), 1992.
void gather_object(const RangeImage& image, const ObjectInView& object, const LogScales& scales,
                   const ScaleOptions& options, ScaleScratch& scratch, ObjectEquations& out);

}  // namespace trivet::kernels
