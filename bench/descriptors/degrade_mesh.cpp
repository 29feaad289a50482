#include "descriptors/degrade_mesh.hpp"

#include <Eigen/Geometry>
#include <limits>

#include "kernels/common/counter_random.hpp"
#include "kernels/meshing/decimate_mesh.hpp"
#include "kernels/simulation/add_noise.hpp"

namespace trivet::bench {

std::span<const Degradation> degradations() {
  static constexpr Degradation kAll[] = {
      {.name = "noise 0.1 mr", .noise = 0.1F},
      {.name = "noise 0.2 mr", .noise = 0.2F},
      {.name = "noise 0.3 mr", .noise = 0.3F},
      {.name = "noise 0.4 mr", .noise = 0.4F},
      {.name = "noise 0.5 mr", .noise = 0.5F},
      {.name = "1/2 of the vertices", .divisor = 2},
      {.name = "1/4 of the vertices", .divisor = 4},
      {.name = "1/8 of the vertices", .divisor = 8},
      {.name = "1/2, noise 0.1 mr", .noise = 0.1F, .divisor = 2},
  };
  return kAll;
}

Pose random_pose(std::uint64_t seed, float reach) {
  kernels::CounterRandom random(seed, 0, 0);
  const auto normal = [&] { return static_cast<float>(random.normal()); };
  Eigen::Vector4f q, t;
  for (int i = 0; i < 4; ++i) q[i] = normal();
  for (int i = 0; i < 4; ++i) t[i] = reach * normal();
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaternionf(q).normalized().toRotationMatrix();
  pose.translation() = t.head<3>();
  return pose;
}

Mesh degrade_mesh(const Mesh& model, const Degradation& how, float resolution,
                  const Pose& T_scene_model, std::uint64_t seed) {
  Mesh scene = model;
  for (std::size_t i = 0; i < model.vertices.size(); ++i)
    scene.vertices.set(i, T_scene_model * model.vertices[i]);
  // A surface has about two triangles per vertex, before and after.
  if (how.divisor > 1)
    scene = kernels::decimate_mesh(scene.vertices, scene.triangles,
                                   scene.triangles.size() / how.divisor,
                                   std::numeric_limits<float>::infinity());
  if (how.noise > 0)
    kernels::add_gaussian_noise(scene.vertices, how.noise * resolution, seed, 0, scene.vertices);
  return scene;
}

}  // namespace trivet::bench
