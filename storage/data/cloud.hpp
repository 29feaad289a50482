/// Contents of a geometry file: a mesh, a point cloud, an organized scan or a depth image.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// The largest coordinate that is read, in any unit: the Earth in millimeters.
inline constexpr double kMaxCoordinate = 1e10;

/// Lens distortion of a pinhole camera: the model of Brown and Conrady, with the coefficients in
/// the order of OpenCV, ROS (plumb_bob, rational_polynomial) and RealSense (brown_conrady).
struct LensDistortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  ///< radial and tangential coefficients
  double k4 = 0, k5 = 0, k6 = 0;                  ///< coefficients of the radial denominator

  bool operator==(const LensDistortion&) const = default;
  bool none() const noexcept { return *this == LensDistortion{}; }
};

/// Meaning of the values of a depth image.
enum class DepthKind : std::uint8_t {
  z,    ///< distance along the camera's z axis
  ray,  ///< distance from the camera to the point, along the ray
};

/// Pinhole camera with OpenCV axes (x right, y down, z forward): u = fx x / z + cx, v = fy y / z +
/// cy [pixel]. Also describes how its depth images deviate from that model.
struct Camera {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double depth_scale = 1;  ///< length in the scene's unit per raw depth value
  DepthKind depth = DepthKind::z;
  LensDistortion distortion{};  ///< distortion of the recorded image; undone when it is read
  std::uint32_t width = 0, height = 0;  ///< image size; 0: unknown
  bool operator==(const Camera&) const = default;
};

/// Read-only view of triangles as three columns of vertex indices; valid while the owner lives.
struct TrianglesView {
  std::span<const std::uint32_t> a, b, c;  // equal lengths

  std::size_t size() const noexcept { return a.size(); }
  bool empty() const noexcept { return a.empty(); }
};

/// Owning storage of triangles.
struct Triangles {
  Column<std::uint32_t> a, b, c;  // equal lengths

  Triangles() = default;
  explicit Triangles(TrianglesView from)
      : a(from.a.begin(), from.a.end()),
        b(from.b.begin(), from.b.end()),
        c(from.c.begin(), from.c.end()) {}

  std::size_t size() const noexcept { return a.size(); }
  bool empty() const noexcept { return a.empty(); }
  operator TrianglesView() const noexcept { return {a, b, c}; }  // NOLINT: as of Points
  void push_back(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    a.push_back(i);
    b.push_back(j);
    c.push_back(k);
  }
};

/// Mapping from the pixels of an organized scan to point indices.
struct PixelGrid {
  static constexpr std::int32_t kNone = -1;
  std::uint32_t width = 0, height = 0;
  Column<std::int32_t> point_index;  ///< width * height, row-major; kNone without a measurement
};

/// Points with their optional attributes. All values are finite; lengths are in the file's unit.
struct Cloud {
  Points points;
  /// Vector subtracted from the file's coordinates because floats are too coarse far from zero;
  /// mostly zero. A point of the file is points[i] + offset. The same holds for every other
  /// position here.
  Eigen::Vector3d offset{0, 0, 0};
  Normals normals;  ///< as in the file, lengths not checked; empty or one per point; zero: none
  /// Read on request only; empty or one per point. Intensity from the file, or the brightness of
  /// colors (ITU-R BT.601); NaN: none.
  Column<float> intensity;
  Triangles triangles;  ///< empty for a plain cloud; every index < points.size()
  std::optional<PixelGrid> grid;
  /// Set for depth images only. Distortion and rays are undone, so the points follow from fx, fy,
  /// cx and cy alone. Camera frame = scene frame.
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3f> viewpoint;  ///< position of the sensor, if the file states it
  std::size_t num_invalid = 0;               ///< points dropped because a coordinate was not finite
  /// Counts for models: dropped vertices that no face with nonzero area uses, and the dropped faces
  /// that use them.
  std::size_t num_unused = 0, num_without_area = 0;
};

}  // namespace trivet
