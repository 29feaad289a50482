/// Surface reconstruction from a scan or a point cloud.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "kernels/meshing/triangulate_greedy.hpp"
#include "kernels/meshing/triangulate_grid.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet {

/// Origin of the triangles.
enum class SurfaceMethod {
  faces,   ///< faces of the file
  grid,    ///< adjacent pixels of an organized scan
  greedy,  ///< nearby points with normals
};

/// Name and description of a method.
struct SurfaceMethodName {
  SurfaceMethod method;
  std::string_view name;
  std::string_view sentence;
};
/// In the order of the enumeration.
inline constexpr std::array<SurfaceMethodName, 3> kSurfaceMethods{
    {{SurfaceMethod::faces, "faces", "as the file has them"},
     {SurfaceMethod::grid, "grid", "between neighboring pixels of an organized scan"},
     {SurfaceMethod::greedy, "greedy", "greedy projection, for points in any order"}}};

/// Options of surface reconstruction.
struct SurfaceOptions {
  /// Absent: the first method whose requirements the cloud meets.
  std::optional<SurfaceMethod> method{};
  /// Viewpoint in the file's frame; absent: the file's viewpoint, or else its origin.
  std::optional<Eigen::Vector3d> viewpoint{};
  kernels::GridTriangulationOptions grid{};
  kernels::GreedyOptions greedy{};
  bool operator==(const SurfaceOptions&) const = default;
};

/// Check the options. Errors: usage (names the option, its range and its value).
Result<void> validate(const SurfaceOptions& options);

/// A cloud with triangles, and how they were made.
struct Surface {
  Cloud mesh;  ///< the points in their order, any normals, and the triangles
  SurfaceMethod method = SurfaceMethod::faces;
  std::size_t num_used = 0;  ///< number of points in triangles
  double open_share = 0;     ///< share of the edges with only one triangle
  std::string warning;       ///< message for the user; usually empty
};

/// Reconstruct a surface from the points of a cloud.
///
/// cloud  as read. If it has no normals, the greedy method fits planes to 20 neighbors and orients
///        the normals toward the viewpoint. Whole objects are not visible from one viewpoint and
///        need their own normals
/// name   name of the cloud in messages: its file
/// Triangles of `grid` and `greedy` are counter-clockwise as seen from the viewpoint, or from the
/// side to which the cloud's normals point; those of `faces` do not change. Same bytes for any
/// number of threads.
/// Errors: usage (an option out of range; a method whose requirements the cloud does not meet),
/// bad_data (fewer than 3 points; no triangle), no_memory.
Result<Surface> surface_from_points(Cloud cloud, const std::string& name,
                                    const SurfaceOptions& options = {});

}  // namespace trivet
