#include "support/rendered_scene.hpp"

#include <stdexcept>

namespace trivet::test {

Cloud render_scan(const std::vector<Placed>& placed) {
  constexpr std::uint32_t kWidth = 640, kHeight = 480;
  std::vector<kernels::RayScene> scenes;
  std::vector<kernels::RayScene::Instance> instances;
  scenes.reserve(placed.size());
  for (const Placed& one : placed) {
    auto scene = kernels::RayScene::from_mesh(one.shape->vertices, one.shape->triangles);
    if (!scene) throw std::runtime_error(scene.error().message);
    scenes.push_back(std::move(*scene));
    instances.push_back({&scenes.back(), one.T_camera_shape});
  }
  auto world = kernels::RayScene::from_instances(instances);
  if (!world) throw std::runtime_error(world.error().message);

  Cloud cloud;
  cloud.camera = Camera{570, 570, 319.5, 239.5, 1};
  cloud.viewpoint = Eigen::Vector3f::Zero();
  std::vector<float> depth(std::size_t{kWidth} * kHeight);
  std::vector<std::uint32_t> hits(depth.size());
  kernels::render_depth(*world, *cloud.camera, kWidth, 0, {depth, hits});
  cloud.grid = PixelGrid{kWidth, kHeight, {}};
  cloud.grid->point_index.assign(depth.size(), PixelGrid::kNone);
  for (std::size_t pixel = 0; pixel < depth.size(); ++pixel) {
    const float z = depth[pixel];
    if (!(z > 0)) continue;
    cloud.grid->point_index[pixel] = static_cast<std::int32_t>(cloud.points.size());
    cloud.points.push_back({(static_cast<float>(pixel % kWidth) - 319.5F) * z / 570,
                            (static_cast<float>(pixel / kWidth) - 239.5F) * z / 570, z});
  }
  return cloud;
}

}  // namespace trivet::test
