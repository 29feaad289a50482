/// What training can be told. Ranges, defaults and meanings as a user sees them are those of
/// options_of<TrainOptions>().
#pragma once

#include <cstdint>
#include <span>

#include "engine/options/option.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// Principal components that the program knows.
inline constexpr std::uint32_t kMostComponents = 96;

/// Points of a voxel whose normals differ by more stay apart, of models and of scenes alike, so that
/// both have the same pairs across an edge: Vidal et al., Sensors 2018.
inline constexpr float kNormalClusterDeg = 30;

/// All that training can be told.
struct TrainOptions {
  float relative_step = 0.04F;  ///< tau_d: sampling step / diameter; smaller finds more, slower
  /// Distance between the model's points that pairs start at, in steps; 0: every point. Larger is
  /// faster and finds a little less.
  float reference_spacing = 1.2F;
  std::uint32_t num_angle_bins = 15;  ///< over 180 degrees, for the angles of a pair
  /// Points of a voxel whose normals differ more stay apart.
  float normal_cluster_angle_deg = kNormalClusterDeg;
  std::uint32_t num_samples = 2048;   ///< of the surface, for refinement and verification
  bool point_pairs = true;            ///< train for Method::ppf
  bool tri_spin_images = true;        ///< train for Method::trisi
  std::uint32_t num_components = 60;  ///< of Tri-Spin-Images that are kept at most
  float component_energy = 1;         ///< fewer are kept where they have this share of variance
  bool operator==(const TrainOptions&) const = default;
};

/// Every option of training.
template <>
std::span<const Option<TrainOptions>> options_of<TrainOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const TrainOptions& options);

}  // namespace trivet
