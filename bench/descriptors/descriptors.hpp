/// The compared descriptors.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "descriptors/keypoint_surface.hpp"
#include "storage/common/columns.hpp"

namespace trivet::bench {

struct Descriptor {
  std::string name;
  std::size_t size = 0;  // /< numbers per keypoint
  /// Writes `size` numbers per keypoint of the surface; zeros for one that cannot be described.
  void (*describe)(const KeypointSurface& surface, std::span<float> features) = nullptr;
  std::size_t num_components = 0;  // /< principal components kept; 0: features unchanged

  std::size_t kept_size() const { return num_components > 0 ? num_components : size; }
};

/// TriSI, full and projected, the spin image in two forms and, where PCL was found, its RoPS.
const std::vector<Descriptor>& descriptors();

/// The features of a surface's keypoints, one after the other.
Column<float> describe(const Descriptor& descriptor, const KeypointSurface& surface);

/// PCL's RoPS (pcl_rops.cpp): Guo et al., IJCV 2013; 3 rotations, 5 bins.
inline constexpr std::size_t kRopsSize = 135;
void describe_rops(const KeypointSurface& surface, std::span<float> features);

}  // namespace trivet::bench
