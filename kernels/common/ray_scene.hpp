/// Surfaces for ray casting: the only interface to Embree.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// First intersection of a ray with a surface.
struct Hit {
  static constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
  float distance = std::numeric_limits<float>::infinity();  ///< distance in lengths of the ray's
                                                            ///< direction
  std::uint32_t primitive = kNone;  ///< index of the triangle or sphere in its scene
  std::uint32_t instance = kNone;   ///< index in `from_instances`; kNone in other scenes
  /// Unit normal in the ray's frame: by winding, or outward for a sphere.
  Eigen::Vector3f normal{0, 0, 0};

  explicit operator bool() const noexcept { return primitive != kNone; }
};

/// A surface with its ray-tracing tree. Queries are thread-safe.
///
/// Rays are watertight at shared edges (Embree's robust mode). Both sides of a triangle stop a ray.
/// Distances do not depend on the number of threads. If a ray meets two surfaces at exactly the
/// same distance, as on a shared edge, the reported one may.
class RayScene {
 public:
  struct Instance {
    const RayScene* scene;  ///< a mesh or spheres, not instances; kept alive by Embree
    Pose T_world_scene;
  };

  /// Pre: every index < vertices.size(). Errors: bad_data (no triangles), internal (Embree's
  /// message).
  static Result<RayScene> from_mesh(PointsView vertices, TrianglesView triangles);
  /// Spheres of one radius > 0, in the unit of the centers. Errors: bad_data (no centers),
  /// internal.
  static Result<RayScene> from_spheres(PointsView centers, float radius);
  /// Discs of one radius > 0 perpendicular to their unit normals: the surface of oriented points.
  /// Rays from behind pass through them: the discs leave gaps, and a ray that came in through a gap
  /// must not hit the opposite surface. Errors: bad_data (no points), internal.
  static Result<RayScene> from_discs(PointsView points, NormalsView normals, float radius);
  /// Surfaces placed in one world frame. Without instances no ray hits anything. Errors: internal.
  static Result<RayScene> from_instances(std::span<const Instance> instances);

  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  /// Approximate memory use.
  std::size_t memory_bytes() const noexcept;
  /// Approximate memory use of a scene of so many triangles, spheres or discs.
  static std::size_t memory_bytes(std::size_t num_primitives) noexcept;

  /// Whether the ray origin + t direction hits anything for t_near <= t <= t_far (may be infinite).
  bool occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
                float t_far) const noexcept;

  /// Number of rays traced together: takes half the time of single rays if directions are similar.
  static constexpr std::size_t kPacket = 8;
  /// Bit k: whether the ray origin + t directions[k] hits anything for t >= 0. At most kPacket.
  std::uint32_t occluded(const Eigen::Vector3f& origin, PointsView directions) const noexcept;
  /// The first hit for t_near <= t <= t_far. The direction need not have length 1.
  Hit intersect(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
                float t_far) const noexcept;
  /// The first hits of many rays from one origin, several at a time. Not for instances.
  ///
  /// directions  n, of any length > 0
  /// distances   n, in lengths of the direction; infinity without a hit
  /// normals     n, as Hit::normal; not written without a hit
  void intersect_many(const Eigen::Vector3f& origin, PointsView directions,
                      std::span<float> distances, NormalsSpan normals) const noexcept;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet::kernels
