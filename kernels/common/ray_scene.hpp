/// Surfaces that rays can be shot at: the only interface to Embree.
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

/// Where a ray meets a surface first.
struct Hit {
  static constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
  float distance = std::numeric_limits<float>::infinity();  ///< in lengths of the ray's direction
  std::uint32_t primitive = kNone;  ///< index of the triangle or sphere in its scene
  std::uint32_t instance = kNone;   ///< index in `from_instances`; kNone in other scenes
  /// Unit, by winding or outward of the sphere, in the ray's frame.
  Eigen::Vector3f normal{0, 0, 0};

  explicit operator bool() const noexcept { return primitive != kNone; }
};

/// A surface with its ray-tracing tree. Queries may run at the same time on any number of threads.
///
/// Rays are watertight at shared edges (Embree's robust mode). Both sides of a triangle stop a ray.
/// Distances do not depend on the number of threads; which of two surfaces is named when a ray
/// meets both at exactly one distance, as on a shared edge, may.
class RayScene {
 public:
  struct Instance {
    const RayScene* scene;  ///< a mesh or spheres; not itself of instances; kept alive by Embree
    Pose T_world_scene;
  };

  /// Pre: every index < vertices.size(). Errors: bad_data (no triangles), internal (Embree's
  /// message).
  static Result<RayScene> from_mesh(PointsView vertices, TrianglesView triangles);
  /// Spheres of one radius > 0, in the unit of the centers. Errors: bad_data (no centers),
  /// internal.
  static Result<RayScene> from_spheres(PointsView centers, float radius);
  /// Discs of one radius > 0 across their unit normals: the surface that oriented points stand for.
  /// Rays pass through them from behind: the discs leave gaps, and a ray that came through one does
  /// not meet the surface beyond. Errors: bad_data (no points), internal.
  static Result<RayScene> from_discs(PointsView points, NormalsView normals, float radius);
  /// Surfaces placed in one world frame. No instances give a scene that no ray meets. Errors:
  /// internal.
  static Result<RayScene> from_instances(std::span<const Instance> instances);

  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  /// About how much memory it takes.
  std::size_t memory_bytes() const noexcept;

  /// Whether anything lies on origin + t direction for t_near <= t <= t_far (may be infinite).
  bool occluded(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
                float t_far) const noexcept;

  /// Rays that are traced at a time: in half the time of one by one where directions are alike.
  static constexpr std::size_t kPacket = 8;
  /// Bit k: whether anything lies on origin + t directions[k] for t >= 0. At most kPacket.
  std::uint32_t occluded(const Eigen::Vector3f& origin, PointsView directions) const noexcept;
  /// The nearest surface on the same stretch. The direction need not have length 1.
  Hit intersect(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_near,
                float t_far) const noexcept;
  /// The nearest surfaces on many rays from one origin, several at a time. Not for instances.
  ///
  /// directions  n, of any length > 0
  /// distances   n, in lengths of the direction; infinity where nothing is met
  /// normals     n, as Hit::normal; not written where nothing is met
  void intersect_many(const Eigen::Vector3f& origin, PointsView directions,
                      std::span<float> distances, NormalsSpan normals) const noexcept;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet::kernels
