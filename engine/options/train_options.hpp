/// Options of training. options_of<TrainOptions>() defines their ranges, defaults and meanings for
/// users.
#pragma once

#include <cstdint>
#include <span>

#include "engine/options/option.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// Number of principal components in the built-in basis.
inline constexpr std::uint32_t kMostComponents = 96;

/// Angle above which normals keep points of one voxel apart. It is the same for models and scenes,
/// so that both have the same pairs across an edge: Vidal et al., Sensors 2018.
inline constexpr float kNormalClusterDeg = 30;

/// All options of training.
struct TrainOptions {
  /// tau_d: sampling step / diameter; a smaller step finds more but is slower.
  float relative_step = 0.04F;
  /// Spacing of the model points at which pairs start, in steps; 0: every point. A larger value is
  /// faster and finds slightly less.
  float reference_spacing = 1.2F;
  std::uint32_t num_angle_bins = 15;  ///< bins over 180 degrees, for the angles of a pair
  /// Points of a voxel whose normals differ by more are kept apart.
  float normal_cluster_angle_deg = kNormalClusterDeg;
  std::uint32_t num_samples = 2048;   ///< number of surface samples for refinement and verification
  bool point_pairs = true;            ///< whether to train for Method::ppf
  bool tri_spin_images = true;        ///< whether to train for Method::trisi
  std::uint32_t num_components = 60;  ///< maximum number of components of Tri-Spin-Images
  float component_energy = 1;         ///< share of variance at which fewer components suffice
  bool operator==(const TrainOptions&) const = default;
};

/// All options of training.
template <>
std::span<const Option<TrainOptions>> options_of<TrainOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const TrainOptions& options);

}  // namespace trivet
