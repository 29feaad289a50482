/// From a scan or a cloud to a mesh.
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

/// Where the triangles come from.
enum class SurfaceMethod {
  faces,   ///< the file has them
  grid,    ///< pixels side by side in an organized scan
  greedy,  ///< points near one another, with normals
};

/// A method in words.
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

/// How triangles are laid through points.
struct SurfaceOptions {
  /// Absent: the first one that the cloud has what it takes for.
  std::optional<SurfaceMethod> method{};
  /// Where the sensor stood, in the file's frame; absent: where the file says, else its origin.
  std::optional<Eigen::Vector3d> viewpoint{};
  kernels::GridTriangulationOptions grid{};
  kernels::GreedyOptions greedy{};
  bool operator==(const SurfaceOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const SurfaceOptions& options);

/// A cloud with triangles, and how they came about.
struct Surface {
  Cloud mesh;  ///< the points, and normals if there were any, in their order, with triangles
  SurfaceMethod method = SurfaceMethod::faces;
  std::size_t num_used = 0;  ///< points that are in a triangle
  double open_share = 0;     ///< of the edges that are in one triangle only
  std::string warning;       ///< as a person should read it; mostly empty
};

/// Lay a surface through the points of a cloud.
///
/// cloud  as read; where it has no normals, the greedy method fits planes to 20 neighbors, facing
///        the viewpoint: whole objects, which no viewpoint sees all of, need normals of their own
/// name   what messages call the cloud: its file
/// Triangles of `grid` and `greedy` are counter-clockwise seen from the viewpoint, or from where
/// the cloud's own normals point; those of `faces` stay as they are. Same bytes for any number of
/// threads.
/// Errors: usage (an option out of range; a method that the cloud has not what it takes for),
/// bad_data (fewer than 3 points; no triangle), no_memory.
Result<Surface> surface_from_points(Cloud cloud, const std::string& name,
                                    const SurfaceOptions& options = {});

}  // namespace trivet
