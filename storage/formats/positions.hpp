/// Coordinates between a file, in its own precision, and a cloud of floats.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "storage/common/columns.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Three columns of equal length with the file's coordinates; may be non-finite.
struct Positions {
  Column<double> x, y, z;

  std::size_t size() const noexcept { return x.size(); }
  void resize(std::size_t n) {
    x.resize(n);
    y.resize(n);
    z.resize(n);
  }
  void push_back(const Eigen::Vector3d& p) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
};

/// Largest distance from the origin without an offset, in multiples of the extent of the points.
/// The rounding error of a float is then at most 2^-17 of the extent, well below the spacing of a
/// million points.
inline constexpr double kMostDistance = 128;

/// Round the positions to the cloud's points. Along axes where they lie so far from the origin that
/// floats would lose significant digits (more than kMostDistance times their extent), an offset is
/// subtracted first and stored in cloud.offset; ReadOptions::keep_origin forbids it. The offset is
/// a multiple of a power of two no smaller than the extent, so subtracting and adding it are exact.
/// The memory of the positions is freed column by column.
void place(Positions positions, const Input& input, Cloud& cloud);

/// Round vectors that are not positions, such as normals, to floats.
Points round_to_floats(Positions vectors);

/// Set the sensor position, given in the file's frame, after the points are placed.
void place_viewpoint(const Eigen::Vector3d& viewpoint, Cloud& cloud);

}  // namespace trivet::formats
