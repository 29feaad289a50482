#include "engine/scene/thin_by_pixels.hpp"

#include <numeric>
#include <vector>

namespace trivet::engine {

std::size_t thin_by_pixels(const PreparedScene& scene, const Points& points, std::size_t limit,
                           std::span<std::uint32_t> indices) {
  if (indices.size() <= limit) return indices.size();
  if (limit == 0) return 0;
  std::vector<double> pixels(indices.size(), 1);  // up to each point, in proportion
  if (scene.view.kind != SceneKind::surface) {
    const Pose& T_camera_scene = scene.images.front().geometry.T_camera_scene;
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const auto range = static_cast<double>((T_camera_scene * points[indices[k]]).z());
      pixels[k] = 1 / (range * range);
    }
  }
  std::inclusive_scan(pixels.begin(), pixels.end(), pixels.begin());
  std::size_t num_kept = 0, at = 0;
  for (std::size_t k = 0; k < limit && at < indices.size(); ++k) {
    const double before = static_cast<double>(k) * pixels.back() / static_cast<double>(limit);
    while (at + 1 < indices.size() && pixels[at] <= before) ++at;
    indices[num_kept++] = indices[at++];
  }
  return num_kept;
}

}  // namespace trivet::engine
