/// How a scene was understood: what saw it, and from where.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

namespace trivet {

/// What kind of scan the scene was taken for.
enum class SceneKind : std::uint8_t {
  image,    ///< the pixels of a depth camera or of an organized scan
  points,   ///< scattered points, or the corners of triangles, seen from one place
  surface,  ///< a whole surface that no one place sees, looked at from six sides
};

/// What says where the sensor stood, or that there was none.
enum class ViewSource : std::uint8_t {
  given,    ///< the caller: a camera, a viewpoint, or a surface without a sensor
  file,     ///< the scene's file
  faces,    ///< its triangles: all seen from there, or from nowhere
  assumed,  ///< nothing does
};

/// From where the scene was looked at, and what says so.
struct SceneView {
  SceneKind kind = SceneKind::points;
  ViewSource source = ViewSource::assumed;
  std::optional<Eigen::Vector3d> viewpoint{};  ///< in the scene file's frame and unit; no surface's
};

/// As results name it.
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

/// As results name it.
constexpr std::string_view name_of(ViewSource source) noexcept {
  switch (source) {
    case ViewSource::given:
      return "given";
    case ViewSource::file:
      return "file";
    case ViewSource::faces:
      return "faces";
    case ViewSource::assumed:
      return "assumed";
  }
  return "";
}

}  // namespace trivet
