/// Hold a posed model against what the sensor saw, ray by ray: the full test of a hypothesis.
#pragma once

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

/// What the rays that meet a posed model tell, over all images. Counts are of pixels: where fewer
/// rays are shot than there are pixels, each stands for its square of them.
struct Examination {
  float covered = 0;     ///< the model projects here, inside the images
  float outside = 0;     ///< ... beyond their borders
  float consistent = 0;  ///< measured where the model says
  float violation = 0;  ///< the sensor looked through the model, or it cuts into a background plane
  float occluded = 0;   ///< something nearer hides the model
  float sunk = 0;       ///< ... by so little that it may be what the model is taken for
  float unknown = 0;    ///< no measurement
  float background = 0;  ///< agrees only with a background plane

  float outline = 0;           ///< where the model ends, inside the images
  float outline_free = 0;      ///< outline beyond which the scene falls back or is not measured
  float outline_touching = 0;  ///< ... beyond which something else touches: the scene has a crease
  float outline_crossed = 0;   ///< ... beyond which the scene runs on smoothly at the model's depth
  /// Edge between seen and hidden parts over which the scene runs on smoothly: nothing lies on the
  /// model, it is buried in what is seen.
  float buried = 0;

  float mean_square = 0;  ///< of the consistent pixels: mean of (r / tolerance)^2, 0..1
  // Of the consistent pixels, less what the correlated noise of the scan makes of them; 0 without
  // any.
  float residual = 0;  ///< mean_square
  float smooth = 0;    ///< the same of residuals that were averaged over their window
  float slope = 0;     ///< mean angle between both surfaces over that window [rad]
  float area = 0;      ///< of the model's surface that is seen [squared diameters]
  float relief = 0;    ///< standard deviation of that surface from a plane [tolerances]
  /// How well what is seen holds the pose: the smallest eigenvalue of the mean of J J^T over the
  /// surface, J = (arm x n, n), arms in half diameters, and a quarter of the same over the outline,
  /// whose n points across it, square to the ray. There only places count up to which the model was
  /// seen and beyond which something farther was. A turn about the symmetry axis is not asked for.
  float stability = 0;
};

struct ExamineOptions {
  VerifyOptions verify{};
  float window = 2;  ///< half-width of the window that residuals are averaged over [pixel]
  CorrelatedNoise correlated_noise{};  ///< of the scan, which counts against no pose
  float correlation = 0;               ///< of the scan's errors from pixel to pixel, 0..1
  int edge_pixels = 0;                 ///< by which the scan may show an outline beside its place
};

/// Working memory of examine_pose.
struct ExamineScratch {
  Points directions;
  RayHits hits;
  Column<float> residual;
  std::vector<std::uint8_t> state;
  std::vector<std::array<double, 9>> sums;
};

/// The pixels that an examination found consistent: each is the middle of a square.
struct ExplainedPixels {
  std::vector<std::uint32_t> pixels;  ///< offset by the images before
  std::uint32_t square = 1;           ///< side of the squares [pixel]; of the last image with any
};

/// What is measured along a ray that meets a posed model, for who wants to see it.
enum class RayVerdict : std::uint8_t {
  agrees,          ///< where the model says
  looked_through,  ///< something farther, or a background plane that the model would reach through
  runs_on,         ///< the model ends here, and what is measured does not
  background,      ///< agrees, but only with a background plane
  hidden,          ///< something nearer
  unmeasured,      ///< nothing
};
struct JudgedRay {
  Eigen::Vector3f place;  ///< where it meets the model, in the scene's frame
  RayVerdict verdict;
};

/// What an examination lists where it is asked to: each list is replaced.
struct ExamineLists {
  ExplainedPixels* explained = nullptr;    ///< the consistent pixels
  std::vector<JudgedRay>* rays = nullptr;  ///< what single rays say, one at an end of the model
                                           ///< perhaps twice
};

/// Shoot rays at the model through the pixels that it may cover, at most some 2,500 an image, and
/// compare what they meet with the measured depth.
///
/// free_axis  if any, turns about it need not be held by what is seen
/// Along each ray: r = (measured - model's depth) times the cosine of incidence. |r| <= tolerance
/// is agreement, r > tolerance a violation, r < -tolerance occlusion, as in verify_pose; so are
/// background planes, and the neighbors that are looked at where the pixel itself does not agree.
/// A right pose leaves noise in r: averaged over windows it vanishes and has no slope. A wrong one
/// leaves shape.
/// Sources: Papazov and Burschka, ACCV 2010 (acceptance by visibility and penalty); Gelfand et al.,
/// 3DIM 2003 (stability of a registration by the eigenvalues of its covariance).
Examination examine_pose(std::span<const RangeImage> images, const PosedModel& model,
                         const std::optional<Symmetry::Axis>& free_axis,
                         const ExamineOptions& options, ExamineScratch& scratch,
                         const ExamineLists& lists = {});

}  // namespace trivet::kernels
