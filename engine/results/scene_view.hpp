/// How a scene was interpreted: kind of scan and viewpoint.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

namespace trivet {

/// Kind of scan that the scene was interpreted as.
enum class SceneKind : std::uint8_t {
  image,    ///< pixels of a depth camera or of a point cloud, organized or not
  points,   ///< scattered points, or the vertices of triangles, seen from one viewpoint
  surface,  ///< whole surface that no single viewpoint sees, rendered from six sides
};

/// Origin of the viewpoint, or of the information that there was no sensor.
enum class ViewSource : std::uint8_t {
  given,    ///< caller: a camera, a viewpoint, or a surface without a sensor
  file,     ///< the scene's file
  grid,     ///< the rows and columns of a scan, organized or not: rays through one point
  faces,    ///< the scene's triangles: all visible from the viewpoint, or from none
  assumed,  ///< default, without any information
};

/// Viewpoint of a scene and the origin of this information.
struct SceneView {
  SceneKind kind = SceneKind::points;
  ViewSource source = ViewSource::assumed;
  /// In the scene file's frame and unit; absent for a surface.
  std::optional<Eigen::Vector3d> viewpoint{};
  /// For ViewSource::grid: RMS distance of the points from their pixels [pixel].
  std::optional<double> residual{};
};

/// Name in results.
constexpr std::string_view name_of(SceneKind kind) noexcept {
  switch (kind) {
    case SceneKind::image:
      return "image";
    case SceneKind::points:
      return "points";
    case SceneKind::surface:
      return "surface";
  }
  return "";
}

/// Name in results.
constexpr std::string_view name_of(ViewSource source) noexcept {
  switch (source) {
    case ViewSource::given:
      return "given";
    case ViewSource::file:
      return "file";
    case ViewSource::grid:
      return "grid";
    case ViewSource::faces:
      return "faces";
    case ViewSource::assumed:
      return "assumed";
  }
  return "";
}

}  // namespace trivet
