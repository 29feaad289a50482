#include "engine/scene/thin_by_pixels.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace trivet::engine {
namespace {

// One of so many points may stray next to the sensor, where it would count for thousands of others:
// nothing counts as nearer than half of the range beyond these.
constexpr std::size_t kStray = 100;

/// How many pixels the surface at each point takes, in proportion; alike on a closed surface.
std::vector<double> pixel_areas(const PreparedScene& scene, const Points& points,
                                std::span<const std::uint32_t> indices) {
  std::vector<double> areas(indices.size(), 1);
  if (scene.view.kind == SceneKind::surface) return areas;
  const Pose& T_camera_scene = scene.images.front().geometry.T_camera_scene;
  std::vector<float> ranges;
  ranges.reserve(indices.size());
  for (const std::uint32_t i : indices) ranges.push_back((T_camera_scene * points[i]).z());
  std::vector<float> order = ranges;
  const auto nearest = order.begin() + static_cast<std::ptrdiff_t>(order.size() / kStray);
  std::nth_element(order.begin(), nearest, order.end());
  const float least = *nearest / 2;
  if (!(least > 0)) return areas;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const auto range = static_cast<double>(std::max(ranges[k], least));
    areas[k] = 1 / (range * range);
  }
  return areas;
}

}  // namespace

std::size_t thin_by_pixels(const PreparedScene& scene, const Points& points, std::size_t limit,
                           std::span<std::uint32_t> indices) {
  if (indices.size() <= limit) return indices.size();
  if (limit == 0) return 0;
  std::vector<double> pixels = pixel_areas(scene, points, indices);  // then, up to each point
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
