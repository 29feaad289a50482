#include "engine/scene/find_view.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/scene/find_viewpoint.hpp"
#include "kernels/meshing/boundary_share.hpp"
#include "kernels/scans/fit_camera.hpp"
#include "kernels/scans/fit_ray_lattice.hpp"
#include "kernels/surfaces/solid_angles.hpp"
#include "storage/data/bounding_box.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using kernels::SolidAngles;

// A sensor sees no face from behind, but noise and triangles across depth discontinuities turn a
// few away. On a whole surface, half of the faces are turned away.
constexpr double kTurnedAway = 0.1;
// Scanned models have a few holes; most single scans have a long border.
constexpr double kMostlyClosed = 0.02;
constexpr std::size_t kGrain = 8192;  // triangles per partial sum

SolidAngles solid_angles(const Cloud& cloud, const Vector3d& eye) {
  const std::size_t n = cloud.triangles.size();
  std::vector<SolidAngles> parts((n + kGrain - 1) / kGrain);
  for_each_index(parts.size(), [&](std::size_t k) {
    parts[k] = kernels::sum_solid_angles(cloud.points, cloud.triangles, eye, k * kGrain,
                                         std::min(kGrain, n - k * kGrain));
  });
  SolidAngles sum;
  for (const SolidAngles& part : parts) {
    sum.front += part.front;
    sum.back += part.back;
  }
  return sum;
}

Eigen::AlignedBox3d box_of(const Cloud& cloud) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) box.extend(cloud.points[i].cast<double>());
  return box;
}

/// Whether the surface was seen from the origin, for either winding of the triangles. The origin
/// must not lie among the points, since no sensor sees more than half of all directions.
bool is_viewed_from_origin(const Cloud& cloud, const Eigen::AlignedBox3d& box) {
  if (box.contains(Vector3d::Zero().eval())) return false;
  const SolidAngles angles = solid_angles(cloud, Vector3d::Zero());
  const double all = angles.front + angles.back;
  return all > 0 && all < 2 * std::numbers::pi &&
         std::min(angles.front, angles.back) <= kTurnedAway * all;
}

/// A far point in the mean direction of the triangles' normals, if the triangles face it.
std::optional<Vector3d> find_far_viewpoint(const Cloud& cloud, const Eigen::AlignedBox3d& box) {
  Vector3d area = Vector3d::Zero();
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    const Vector3d a = cloud.points[cloud.triangles.a[t]].cast<double>(),
                   b = cloud.points[cloud.triangles.b[t]].cast<double>(),
                   c = cloud.points[cloud.triangles.c[t]].cast<double>();
    area += (b - a).cross(c - a);
  }
  if (!(area.norm() > 0)) return std::nullopt;
  const Vector3d eye = box.center() + 10 * box.diagonal().norm() * area.normalized();
  const SolidAngles angles = solid_angles(cloud, eye);
  if (angles.back > kTurnedAway * (angles.front + angles.back)) return std::nullopt;
  return eye;
}

/// Absent if the faces do not determine the view.
std::optional<SceneView> view_of_faces(const Cloud& cloud) {
  const Eigen::AlignedBox3d box = box_of(cloud);
  // A cloud with an offset is far from its origin and was seen from elsewhere.
  if (cloud.offset.isZero(0) && is_viewed_from_origin(cloud, box))
    return SceneView{SceneKind::points, ViewSource::faces, Vector3d::Zero().eval()};
  if (const std::optional<Vector3d> eye = find_far_viewpoint(cloud, box))
    return SceneView{SceneKind::points, ViewSource::faces, *eye + cloud.offset};
  if (!cloud.grid && kernels::boundary_share(cloud.triangles) < kMostlyClosed)
    return SceneView{SceneKind::surface, ViewSource::faces};
  return std::nullopt;
}

/// The origin of the viewpoint, apart from triangles.
ViewSource source_of(const Cloud& cloud, const SceneInput& input) {
  if (input.viewpoint || cloud.camera) return ViewSource::given;
  return cloud.viewpoint ? ViewSource::file : ViewSource::assumed;
}

/// The camera of an organized scan for which none is stated. Empty if it is not a pinhole image.
std::optional<kernels::PosedCamera> recover_camera(const Cloud& cloud) {
  if (!cloud.grid || cloud.camera) return std::nullopt;
  if (cloud.offset.isZero(0)) {
    // Most scans are in their camera's frame.
    if (const std::optional<Camera> camera = kernels::fit_camera(*cloud.grid, cloud.points))
      return kernels::PosedCamera{.geometry = kernels::geometry_of(*camera, *cloud.grid)};
  }
  return kernels::fit_posed_camera(*cloud.grid, cloud.points);
}

/// Whether a camera stands where the sensor is said to.
bool is_at(const kernels::PosedCamera& camera, const Vector3d& viewpoint, PointsView points) {
  constexpr double kMostApart = 0.01;  // of the distance to the points
  const double distance = (camera.center - bounding_box(points).center().cast<double>()).norm();
  return (camera.center - viewpoint).norm() < kMostApart * distance;
}

/// An image is seen from its camera, at the origin of its frame.
Result<void> check_viewpoint(const Cloud& cloud, const SceneInput& input) {
  if (!cloud.camera || !cloud.grid || !input.viewpoint || input.viewpoint->isZero()) return {};
  const Vector3d& v = *input.viewpoint;
  return Error{
      ErrorCode::usage,
      fmt::format("{}: expected no viewpoint, or 0, 0, 0: an image is seen from its camera; "
                  "found ({:.6g}, {:.6g}, {:.6g}); leave it out",
                  input.file.string(), v.x(), v.y(), v.z())};
}

Result<SceneView> find_view(const Cloud& cloud, const SceneInput& input,
                            const std::optional<kernels::PosedCamera>& camera) {
  TRIVET_TRY(check_viewpoint(cloud, input));
  const ViewSource source = source_of(cloud, input);
  const bool is_open =
      source == ViewSource::assumed || (source == ViewSource::file && cloud.viewpoint->isZero());
  if (is_open && camera && !camera->center.isZero())
    return SceneView{SceneKind::image, ViewSource::grid, camera->center + cloud.offset,
                     camera->residual};
  if (source == ViewSource::assumed && !cloud.triangles.empty()) {
    if (input.closed_surface && !cloud.grid)
      return SceneView{SceneKind::surface, ViewSource::given};
    if (const std::optional<SceneView> view = view_of_faces(cloud)) return *view;
  }
  TRIVET_TRY_ASSIGN(const Eigen::Vector3f place,
                    find_viewpoint(cloud, input.viewpoint, input.file.string()));
  return SceneView{SceneKind::points, source, place.cast<double>() + cloud.offset};
}

}  // namespace

Result<FoundView> find_view(const Cloud& cloud, const SceneInput& input) {
  const std::optional<kernels::PosedCamera> camera = recover_camera(cloud);
  TRIVET_TRY_ASSIGN(const SceneView view, find_view(cloud, input, camera));
  FoundView found{view};
  if (camera && view.viewpoint && is_at(*camera, *view.viewpoint - cloud.offset, cloud.points))
    found.geometry = camera->geometry;
  if (cloud.grid || cloud.camera || !view.viewpoint) return found;
  const Eigen::Vector3f viewpoint = (*view.viewpoint - cloud.offset).cast<float>();
  if (const std::optional<kernels::PosedCamera> pixels =
          kernels::fit_ray_lattice(cloud.points, viewpoint)) {
    found.geometry = pixels->geometry;
    if (view.source == ViewSource::assumed) {
      found.view.source = ViewSource::grid;
      found.view.residual = pixels->residual;
    }
  }
  return found;
}

}  // namespace trivet::engine
