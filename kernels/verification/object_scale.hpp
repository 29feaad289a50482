/// Information of a posed object on the scales of its camera.
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

/// Logarithms of the correction factors of a camera's focal lengths and depths.
struct LogScales {
  double focal = 0, depth = 0;
};

struct ScaleOptions {
  float sigma = 0;      ///< standard deviation of a residual across the surface [scene unit], > 0
  float gate = 0;       ///< residuals beyond it have no weight [scene unit], > 0
  int edge_pixels = 2;  ///< pixels this near to an edge are ignored, >= 0
};

/// Normal equations of a point-to-plane fit, weighted by one over the squared sigma. The unknowns
/// in order: rotation vector [rad] and translation [scene unit] of the object in the camera's
/// frame, about the image of its center, log focal scale, log depth scale.
struct ObjectEquations {
  using Vector8 = Eigen::Matrix<double, 8, 1>;

  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  Vector8 pull = Vector8::Zero();  ///< information times the step to the solution
  std::vector<Vector8> blocks;     ///< the pull, by squares of pixels with shared errors
  std::size_t num_rays = 0;        ///< number of rays cast
  std::size_t num_used = 0;        ///< number of rays with weight
};

/// A model before a camera. All members are references.
struct ObjectInView {
  const RayScene& surface;  ///< surface of the model, in its own frame
  const ModelSamples& samples;
  const Pose& T_camera_model;  ///< pose after the camera's scales are applied
};

/// Working memory of gather_object.
struct ScaleScratch {
  Points directions;
  RayHits hits;
  Column<float> residuals;
};

/// Compare the surface of a posed object with the measured depth, along at most some 2,500 rays.
///
/// image   image of a pinhole camera with the stated parameters
/// scales  point of linearization of the equations
/// The residual along a ray is r = n . (q - h): h is the intersection with the model, n the model's
/// normal there, q the measured point; Tukey's weights. Derivatives are evaluated at h: at q they
/// would share the noise of r, which makes all noisy objects appear too large. Steep surfaces, and
/// rays near the ends of the model or of the region of agreement, are excluded: pixels there blend,
/// lean and belong to other objects. Source of the residual: Chen and Medioni, Image and Vision
/// Computing 10(3), 1992.
void gather_object(const RangeImage& image, const ObjectInView& object, const LogScales& scales,
                   const ScaleOptions& options, ScaleScratch& scratch, ObjectEquations& out);

}  // namespace trivet::kernels
