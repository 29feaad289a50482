#include "kernels/verification/edge_equations.hpp"

#include <cmath>
#include <optional>

namespace trivet::kernels {
namespace {

// The distance of an outline from an edge of the scan errs by half a pixel, alike for the next two
// pixels along it. What a whole side errs by, since sensors shift edges and cameras are calibrated
// to about a pixel, no number of pixels reduces.
constexpr double kEdgeError = 0.5, kEdgeRun = 2, kSharedEdgeError = 0.5, kSides = 4;
// Where a pixel sees both sides of an edge, sensors measure either, or nothing: all edges shift by up
// to a pixel. Those that match windows shift them by half the possible displacement besides.
constexpr double kCommonShift = 1, kShareOfWindow = 0.5;
// Where such pixels are not measured, surfaces end before their edges: by 0.9 to 1 pixels on average
// in made scans, by 0.3 to 1.5 in real ones, but for one that lets objects grow by 1. Their other
// edges are 0.4 within to 0.8 beyond [pixel]. Where both sides differ in depth by no more than the
// most oblique surface does over a pixel (kMinRayCosine), sensors measure such pixels, too.
constexpr double kShiftAtGaps = -0.6;
// Edges much farther away than those shifts may be those of another surface: their weights fall as
// Cauchy's, so that they still draw a pose that slid far [pixel].
constexpr double kNearEdge = 3;
constexpr int kEdgeReach = 12;       // pixels from the model's end to that of the surface
constexpr int kLost = 3;             // pixels before an end that sensors may not measure
constexpr float kFlatCosine = 0.3F;  // of incidence: a surface that is continued in its plane
constexpr float kLeastAlong = 0.3F;  // cosine between a step and the direction across an outline
constexpr float kFolds = 0.866F;     // cosine of 30 degrees, between the normals of two faces

/// The plane of the face that a ray hits, in the camera's frame.
struct FacePlane {
  FacePlane(const ExaminedRays& rays, const RayHit& hit)
      : normal(hit.normal),
        offset(hit.normal.dot(hit.place)),
        step(rays.step / (hit.length * hit.facing)) {}

  /// How far a depth along a ray lies behind the plane.
  float behind(const Eigen::Vector3f& ray, float depth) const noexcept {
    return depth - offset / normal.dot(ray);
  }

  Eigen::Vector3f normal;
  float offset;
  float step;  ///< a depth that differs by more is that of another surface
};

/// Where a face of the model ends, between the last ray that hits it and the next one.
struct FaceEnd {
  int pixels;     ///< beyond the ray, to the last pixel on the face
  bool is_sharp;  ///< whether the model ends, falls back or folds there; it may also bend slowly
};

/// Find the end of a face by bisection. It is found by depths and rounded to a pixel, as that of the
/// measured surface is: a right pose has distances of 0. Beyond it the side of a plate may follow.
FaceEnd end_of_face(const ExaminedRays& rays, const RayEnd& end, const FacePlane& plane) noexcept {
  struct Beyond {
    bool is_on_face, is_sharp;
  };
  const auto beyond_at = [&](int pixels) -> Beyond {
    const Eigen::Vector3f ray = ray_through(rays.geometry, rays.crop.u(end.i) + pixels * end.di,
                                            rays.crop.v(end.j) + pixels * end.dj);
    const Hit hit = rays.first_hit(ray);
    if (!hit) return {false, true};
    const float behind = plane.behind(ray, hit.distance);
    const Eigen::Vector3f normal = rays.T_camera_model.linear() * hit.normal;
    return {std::abs(behind) <= plane.step,
            behind > 2 * plane.step || std::abs(normal.dot(plane.normal)) < kFolds};
  };
  FaceEnd face{0, true};  // the next ray misses the model
  int off_face = rays.crop.stride;
  while (off_face - face.pixels > 1) {
    const int middle = (face.pixels + off_face) / 2;
    const Beyond beyond = beyond_at(middle);
    if (beyond.is_on_face) {
      face.pixels = middle;
    } else {
      off_face = middle;
      face.is_sharp = beyond.is_sharp;
    }
  }
  return face;
}

/// What a pixel near an end of a face measures.
enum class Place : std::uint8_t {
  surface,  // the face, continued in its plane
  behind,   // something farther
  unmeasured,
  elsewhere,  // something nearer, or another surface in contact
};

/// The end of the measured surface.
struct MeasuredEnd {
  float pixels;    ///< from the model's end to it; negative: within the model
  bool is_at_gap;  ///< whether pixels that see both sides of the edge are not measured
};

/// Where the surface ends that was measured before an end of the model. Empty if it does not end
/// nearby before something farther, with or without unmeasured pixels between; or if it is oblique,
/// since sensors do not measure it up to its end.
std::optional<MeasuredEnd> measured_end(const ExaminedRays& rays, const RayEnd& end) noexcept {
  const RayHit hit = rays.hit_at(end.i, end.j);
  if (!(hit.facing > kFlatCosine)) return std::nullopt;
  const FacePlane plane(rays, hit);
  const FaceEnd face = end_of_face(rays, end, plane);
  if (!face.is_sharp) return std::nullopt;
  const int u = rays.crop.u(end.i) + face.pixels * end.di;
  const int v = rays.crop.v(end.j) + face.pixels * end.dj;
  // Normals beside a step are fitted to both of its sides. Only where sensors match windows or filter
  // they tell more than depths: a face ends where it begins to be rounded off.
  const bool is_rounded = rays.options.edge_pixels > 0 || rays.options.smoothing > 0;
  const auto behind_at = [&](int x, int y) {
    return plane.behind(ray_through(rays.geometry, x, y), rays.image.depth[rays.pixel_at(x, y)]);
  };
  const auto place_at = [&](int step) {
    const int x = u + step * end.di, y = v + step * end.dj;
    if (!rays.inside(x, y)) return Place::elsewhere;
    const std::size_t pixel = rays.pixel_at(x, y);
    if (!(rays.image.depth[pixel] > 0)) return Place::unmeasured;
    const float behind = behind_at(x, y);
    if (std::abs(behind) > plane.step) return behind > 0 ? Place::behind : Place::elsewhere;
    const bool folds = is_rounded && rays.image.normals[pixel].dot(plane.normal) < kFolds;
    return folds ? Place::elsewhere : Place::surface;
  };
  int outside = 0;  // the first pixel from the model's end that does not measure the surface
  while (outside <= kEdgeReach && place_at(outside) == Place::surface) ++outside;
  int measured = outside;
  while (measured <= kEdgeReach && place_at(measured) == Place::unmeasured) ++measured;
  // The surface may go on where nothing is measured.
  if (measured > kEdgeReach || place_at(measured) != Place::behind) return std::nullopt;
  const float jump = behind_at(u + measured * end.di, v + measured * end.dj);
  const bool loses_pixels = kMinRayCosine * jump > rays.depth_at(end.i, end.j) / rays.geometry.fx;
  if (outside > 0)
    return MeasuredEnd{static_cast<float>(outside - 1), loses_pixels && measured > outside};
  const Place own = place_at(0);
  const int last = own == Place::unmeasured ? kLost : kEdgeReach;
  bool is_at_gap = own == Place::unmeasured;
  for (int step = -1; step >= -last; --step) {
    const Place place = place_at(step);
    if (place == Place::surface)
      return MeasuredEnd{static_cast<float>(step), loses_pixels && is_at_gap};
    if (place != own && place != Place::unmeasured) return std::nullopt;
    is_at_gap = is_at_gap || place == Place::unmeasured;
  }
  return std::nullopt;
}

/// The direction in the image perpendicular to the outline, away from the model; a unit vector or
/// zero.
Eigen::Vector2f direction_away(const ExaminedRays& rays, const RayEnd& end) {
  Eigen::Vector2f missed(0, 0);
  rays.each_missed_around(end.i, end.j, [&](int di, int dj) {
    missed += Eigen::Vector2f(static_cast<float>(di), static_cast<float>(dj));
  });
  return missed.norm() > 0 ? missed.normalized() : Eigen::Vector2f::Zero();
}

}  // namespace

void EdgeEquations::add(const ExaminedRays& rays, const RayEnd& end) {
  const std::optional<MeasuredEnd> measured = measured_end(rays, end);
  if (!measured || rays.is_open_at(end)) return;
  const Eigen::Vector2f across = direction_away(rays, end);
  const float along =
      across.x() * static_cast<float>(end.di) + across.y() * static_cast<float>(end.dj);
  if (!(along > kLeastAlong)) return;
  const float z = rays.depth_at(end.i, end.j);
  const float pixel = z / rays.geometry.fx;
  // Steps in both directions meet a slanted outline more often than a straight one.
  const auto share = static_cast<double>(along * static_cast<float>(rays.crop.stride));
  const double deviation = static_cast<double>(pixel) *
                           (kEdgeError + static_cast<double>(rays.options.edge_pixels)) *
                           std::sqrt(kEdgeRun / share);
  const auto width = static_cast<double>(pixel),
             distance = static_cast<double>(measured->pixels * along);
  const double far = distance / (kNearEdge + static_cast<double>(rays.options.edge_pixels));
  const double weight = 1 / (deviation * deviation * (1 + far * far));
  const Vector6 J = rays.edge_constraint(end.i, end.j, across);
  sums_.information.noalias() += weight * J * J.transpose();
  sums_.gradient.noalias() += weight * distance * width * J;
  SharedShift& shift = measured->is_at_gap ? of_gaps_ : of_steps_;
  shift.cross += weight * width * J;
  shift.information += weight * width * width;
  shift.gradient += weight * width * width * distance;
  shift_deviation_ = kCommonShift + kShareOfWindow * static_cast<double>(rays.options.edge_pixels);
  count_ += 1;
}

void EdgeEquations::add_to(PoseEquations& equations) const {
  if (count_ == 0) return;
  const double weight = 1 / (1 + kSharedEdgeError * kSharedEdgeError * count_ /
                                     (kSides * kEdgeError * kEdgeError * kEdgeRun));
  Matrix6 information = sums_.information;
  Vector6 gradient = sums_.gradient;
  const double prior = 1 / (weight * shift_deviation_ * shift_deviation_);
  // A shift is solved for beside the pose, and eliminated by its Schur complement.
  const auto eliminate = [&](const SharedShift& shift, double expected) {
    const double own = shift.information + prior;
    information -= shift.cross * shift.cross.transpose() / own;
    gradient -= shift.cross * ((shift.gradient + expected * prior) / own);
  };
  eliminate(of_steps_, 0);
  eliminate(of_gaps_, kShiftAtGaps);
  equations.held += weight * information;
  equations.information += weight * information;
  equations.gradient += weight * gradient;
}

}  // namespace trivet::kernels
