#include "kernels/scans/render_depth.hpp"

#include <limits>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {

void render_depth(const RayScene& scene, const Camera& camera, std::uint32_t width,
                  std::uint32_t first_row, const RenderedRows& out) {
  const auto& [depth, instances, normals] = out;
  TRIVET_REQUIRE(width > 0 && depth.size() % width == 0, "whole rows");
  TRIVET_REQUIRE(instances.size() == depth.size(), "one instance per depth");
  TRIVET_REQUIRE(normals.size() == 0 || normals.size() == depth.size(), "one normal per depth");
  const Eigen::Vector3f nowhere =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const auto u = static_cast<double>(i % width);
    const auto v = static_cast<double>(first_row + i / width);
    // If the ray's z is 1, the distance along the ray is z.
    const Eigen::Vector3f direction(static_cast<float>((u - camera.cx) / camera.fx),
                                    static_cast<float>((v - camera.cy) / camera.fy), 1);
    const Hit hit = scene.intersect(Eigen::Vector3f::Zero(), direction, 0,
                                    std::numeric_limits<float>::infinity());
    depth[i] = hit ? hit.distance : 0;
    instances[i] = hit.instance;
    if (normals.size() == 0) continue;
    normals.set(i, !hit ? nowhere : hit.normal.dot(direction) > 0 ? -hit.normal : hit.normal);
  }
}

}  // namespace trivet::kernels
