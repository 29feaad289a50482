#include "storage/formats/arrange_points.hpp"

#include <limits>
#include <numeric>
#include <utility>

namespace trivet::formats {

Cloud arrange_points(Positions positions, Positions normals, std::uint32_t width,
                     std::uint32_t height, const Input& input) {
  const std::size_t count = positions.size();
  const bool organized = width > 1 && height > 1;
  // Pixels without a measurement are often set to the camera's position.
  for (std::size_t i = 0; organized && i < count; ++i) {
    if (positions.x[i] == 0 && positions.y[i] == 0 && positions.z[i] == 0)
      positions.x[i] = std::numeric_limits<double>::quiet_NaN();
  }
  Cloud cloud;
  place(std::move(positions), input, cloud);
  cloud.normals = round_to_floats(std::move(normals));
  if (!organized) return cloud;
  cloud.grid = PixelGrid{width, height, Column<std::int32_t>(count)};
  std::iota(cloud.grid->point_index.begin(), cloud.grid->point_index.end(), 0);
  place_viewpoint(Eigen::Vector3d::Zero(), cloud);
  return cloud;
}

}  // namespace trivet::formats
