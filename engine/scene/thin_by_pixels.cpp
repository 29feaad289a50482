#include "engine/scene/thin_by_pixels.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace trivet::engine {
namespace {

// One of so many points may stray next to the sensor, where it would count for thousands of others:
// nothing counts as nearer than half of the range beyond these.
constexpr std::size_t kStray = 100;

}  // namespace

std::size_t thin_by_pixels(const PreparedScene& scene, const Points& points, std::size_t limit,
                           std::span<std::uint32_t> indices) {
  if (indices.size() <= limit) return indices.size();
  if (limit == 0) return 0;
  std::vector<double> pixels(indices.size(), 1);  // up to each point, in proportion
  if (scene.view.kind != SceneKind::surface) {
    const Pose& T_camera_scene = scene.images.front().geometry.T_camera_scene;
    std::vector<double> ranges;
    for (const std::uint32_t i : indices)
      ranges.push_back(static_cast<double>((T_camera_scene * points[i]).z()));
    std::vector<double> order = ranges;
    const auto near = order.begin() + static_cast<std::ptrdiff_t>(order.size() / kStray);
    std::nth_element(order.begin(), near, order.end());
    for (std::size_t k = 0; k < ranges.size() && *near > 0; ++k) {
      const double range = std::max(ranges[k], *near / 2);
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
