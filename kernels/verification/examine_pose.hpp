/// Comparison of a posed model with the scan, ray by ray: the full test of a hypothesis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/correlated_noise.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/ray_crop.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Statistics of the rays that hit a posed model, over all images. Counts are in pixels: if fewer
/// rays are cast than there are pixels, each represents its square of them.
struct Examination {
  float covered = 0;       ///< projection of the model inside the images
  float outside = 0;       ///< projection beyond their borders
  float consistent = 0;    ///< measured depth agrees with the model
  float violation = 0;     ///< the sensor saw through the model, or it cuts into a background plane
  float occluded = 0;      ///< something nearer hides the model
  float overlaid = 0;      ///< occluded by something wider than outlines are blurred: its squares
  float seen_through = 0;  ///< seen through far and wider than outlines are blurred: its squares
  float sunk = 0;     ///< occluded by so little that the occluder may be mistaken for the model
  float unknown = 0;  ///< no measurement
  float gaps = 0;  ///< of these, what lies between agreeing rays of one row or column: the sensor
                   ///< measured the surface on both sides, and missed it there
  float background = 0;  ///< agrees only with a background plane

  /// Ends of the model inside the images that nothing else hides, but for those of open surfaces
  /// beyond which the scene may go on.
  float outline = 0;
  float outline_free = 0;      ///< outline beyond which the scene falls back or is not measured
  float outline_touching = 0;  ///< outline with something else in contact beyond it: the scene has
                               ///< a crease
  float outline_crossed = 0;   ///< outline over which the scene continues smoothly at the model's
                               ///< depth
  /// Edge between visible and hidden parts over which the scene continues smoothly: nothing lies on
  /// the model, it is buried in the visible surface.
  float buried = 0;

  /// Largest residual that agrees: as many standard deviations of the pose's own residuals.
  float tolerance = 0;
  float mean_square = 0;  ///< mean of (r / tolerance)^2 over the consistent pixels, 0..1
  // For the consistent pixels, minus the effect of the scan's correlated noise; 0 without any.
  float residual = 0;  ///< mean_square minus the effect of correlated noise
  float smooth = 0;    ///< mean square of residuals averaged over their window
  /// What the residuals of a window share beyond the scan's correlated noise, root mean square: how
  /// far the object, as measured, is off its model [scene unit].
  float deviation = 0;
  float slope = 0;   ///< mean angle between both surfaces over that window [rad]
  float area = 0;    ///< visible area of the model's surface [squared diameters]
  float relief = 0;  ///< standard deviation of that surface from a plane [tolerances]
  /// Root mean square of what smoothing moves the model's surface by at the consistent pixels, across
  /// it [scene unit].
  float smoothing_shift = 0;
  /// How well the visible surface determines the pose: the smallest eigenvalue of the mean of J J^T
  /// over the surface, J = (arm x n, n), arms in half diameters, plus a quarter of the same over
  /// the outline, where n points across the outline, perpendicular to the ray. The outline counts
  /// only where the model was visible up to it and something farther beyond it. Rotation about a
  /// symmetry axis is excluded.
  float stability = 0;
};

struct ExamineOptions {
  VerifyOptions verify{};  ///< with the largest tolerance
  /// What the pose's own residuals lower the tolerance to at most [scene unit]. 0: it stays.
  float least_tolerance = 0;
  float window = 2;                    ///< half-width of the averaging window of residuals [pixel]
  CorrelatedNoise correlated_noise{};  ///< correlated noise of the scan, which lowers no score
  float correlation = 0;  ///< correlation of the scan's errors from pixel to pixel, 0..1
  int edge_pixels = 0;    ///< possible shift of outlines in the scan
  float smoothing = 0;    ///< length over which the sensor smooths depth [pixel]; 0: none
  /// Standard deviation of a measurement across surfaces, > 0 for equations [scene unit].
  float error = 0;
};

/// Working memory of examine_pose.
struct ExamineScratch {
  Points directions;
  std::vector<RayHits> hits;            ///< of each image
  std::vector<Column<float>> expected;  ///< smoothed depths of each image
  Column<float> residual, distances, scene;
  std::vector<std::uint8_t> state;
  std::vector<std::array<double, 9>> sums;
};

/// The pixels that an examination found consistent, each the center of a square.
struct ExplainedPixels {
  std::vector<std::uint32_t> pixels;  ///< indices, offset by the pixels of previous images
  std::uint32_t square = 1;  ///< side of the squares [pixel]; that of the last image with any
};

/// Measurement along a ray that hits a posed model, for display.
enum class RayVerdict : std::uint8_t {
  agrees,          ///< depth of the model
  looked_through,  ///< something farther, or a background plane that the model would penetrate
  runs_on,         ///< the model ends here, but the measured surface continues
  background,      ///< depth of the model, but on a background plane
  hidden,          ///< something nearer, or the plane that the model bears on
  unmeasured,      ///< no measurement
};
struct JudgedRay {
  Eigen::Vector3f place;  ///< intersection with the model, in the scene's frame
  RayVerdict verdict;
};

/// Normal equations of a small motion x that brings a posed model and the scan together: x =
/// information^-1 gradient, a rotation about the image of the model's center in half diameters
/// (left-multiplied), then a translation, both in the scene's frame and unit.
///
/// Rows are the distances of pixels along the normal, within the largest tolerance and weighted
/// robustly, and where the model ends, the distance across the outline to where the measured
/// surface ends: a flat face is free to slide but for its ends. Each is divided by its standard
/// deviation. Sources: Chen and Medioni, 1992 (point to plane); Censi, ICRA 2007 (covariance of a
/// registration).
struct PoseEquations {
  /// The information of consistent pixels and edges alone, whose inverse is the pose's covariance:
  /// what does not agree holds no pose.
  Eigen::Matrix<double, 6, 6> held = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
};

/// Optional lists of an examination; each is overwritten.
struct ExamineLists {
  ExplainedPixels* explained = nullptr;    ///< the consistent pixels
  std::vector<JudgedRay>* rays = nullptr;  ///< verdicts of single rays; a ray at an end of the
                                           ///< model may occur twice
  PoseEquations* equations = nullptr;      ///< require ExamineOptions::error
};

/// Cast rays at the model through the pixels that it may cover, at most some 2,500 per image, and
/// compare the hits with the measured depth.
///
/// free_axis  if given, the visible surface need not determine the rotation about it
/// Along each ray: r = (measured - model's depth, smoothed as the sensor does) times the cosine of
/// incidence. |r| <= tolerance is agreement, r > tolerance a violation, r < -tolerance occlusion, as
/// in verify_pose. Background planes, and the neighbors tested if the pixel itself does not agree,
/// are also treated as there.
/// For a right pose, r is noise: averaged over windows it vanishes and has no slope. For a wrong
/// one, r depends on shape.
/// Sources: Papazov and Burschka, ACCV 2010 (acceptance by visibility and penalty); Gelfand et al.,
/// 3DIM 2003 (stability of a registration by the eigenvalues of its covariance).
Examination examine_pose(std::span<const RangeImage> images, const PosedModel& model,
                         const std::optional<Symmetry::Axis>& free_axis,
                         const ExamineOptions& options, ExamineScratch& scratch,
                         const ExamineLists& lists = {});

}  // namespace trivet::kernels
