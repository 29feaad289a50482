/// What a file of geometry holds: a mesh, a cloud, an organized scan or a depth image.
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

/// How a lens bends the image of a pinhole: the model of Brown and Conrady, as OpenCV, ROS
/// (plumb_bob, rational_polynomial) and RealSense (brown_conrady) have it, in their order.
struct LensDistortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  ///< radial and tangential
  double k4 = 0, k5 = 0, k6 = 0;                  ///< of the radial denominator

  bool operator==(const LensDistortion&) const = default;
  bool none() const noexcept { return *this == LensDistortion{}; }
};

/// What the values of a depth image measure.
enum class DepthKind : std::uint8_t {
  z,    ///< along the camera's z axis
  ray,  ///< from the camera to the point, along the ray
};

/// Pinhole camera, OpenCV axes (x right, y down, z forward): u = fx x / z + cx, v = fy y / z + cy
/// [pixel]; and how its depth images differ from that.
struct Camera {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double depth_scale = 1;  ///< raw depth value times depth_scale is a length in the scene's unit
  DepthKind depth = DepthKind::z;
  LensDistortion distortion{};          ///< of the image as it was taken; undone when it is read
  std::uint32_t width = 0, height = 0;  ///< of its images; 0: not told
  bool operator==(const Camera&) const = default;
};

/// Triangles to read, as three columns of vertex indices; valid while the owner lives.
struct TrianglesView {
  std::span<const std::uint32_t> a, b, c;  // equal lengths

  std::size_t size() const noexcept { return a.size(); }
  bool empty() const noexcept { return a.empty(); }
};

/// The owner of triangles.
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

/// Which point each pixel of an organized scan holds.
struct PixelGrid {
  static constexpr std::int32_t kNone = -1;
  std::uint32_t width = 0, height = 0;
  Column<std::int32_t> point_index;  ///< width * height, row-major; kNone without a measurement
};

/// Points with whatever else came along. All values are finite; lengths are in the file's unit.
struct Cloud {
  Points points;
  /// What was subtracted from the file's coordinates, as floats are too coarse far from zero; mostly
  /// zero. A point of the file is points[i] + offset; whatever else has a place, has it as the
  /// points have.
  Eigen::Vector3d offset{0, 0, 0};
  Normals normals;  ///< as in the file, not checked for length; empty or one a point; zero: none
  /// Empty or one a point, if it was asked for: as in the file, or the brightness of colors (ITU-R
  /// BT.601); NaN: none.
  Column<float> intensity;
  Triangles triangles;  ///< empty for a plain cloud; every index < points.size()
  std::optional<PixelGrid> grid;
  /// Only from depth images, whose distortion and rays are undone: the points lie as fx, fy, cx and
  /// cy say. Camera frame = scene frame.
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3f> viewpoint;  ///< where the sensor stood, if the file says
  std::size_t num_invalid = 0;               ///< points dropped because a coordinate was not finite
  /// Of a model, dropped: vertices that no face with an area uses, and the faces that use them.
  std::size_t num_unused = 0, num_without_area = 0;
};

}  // namespace trivet
