/// A trained model: all data for recognizing one object.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/common/shared.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"
#include "storage/data/ppf_table.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet {

/// A rigid transform, unaligned so that it may be stored in plain vectors and structs.
using Pose = Eigen::Transform<float, 3, Eigen::Isometry, Eigen::DontAlign>;

/// Rigid transforms that map the model onto itself. The identity is not listed.
struct Symmetry {
  /// A line in the model's frame.
  struct Axis {
    Eigen::Matrix<float, 3, 1, Eigen::DontAlign> direction{0, 0, 1};  ///< unit vector
    /// A point on the axis [library unit].
    Eigen::Matrix<float, 3, 1, Eigen::DontAlign> point{0, 0, 0};
  };
  /// Discrete symmetries. If there is an axis, only those that are not rotations about it.
  std::vector<Pose> poses;
  std::optional<Axis> axis;  ///< axis of a continuous rotational symmetry
  bool declared = false;     ///< given by the user, not found by the program

  bool trivial() const noexcept { return poses.empty() && !axis; }
};

/// For each surface sample, a bitmask of the directions from which it is visible. Bit d of word w
/// stands for view_direction(64 w + d) of kernels/surfaces/visibility.hpp.
inline constexpr std::size_t kViewWords = 4;
/// One bit for each of the 256 directions.
using ViewMask = std::array<std::uint64_t, kViewWords>;

/// Largest number of near symmetries of a model.
inline constexpr std::size_t kMaxNearSymmetries = 16;

/// Parts of a model, each checked as a whole when it is first used.
enum class ModelPart : std::uint8_t { surface, samples, pairs, features };
/// All parts.
inline constexpr std::array kModelParts{ModelPart::surface, ModelPart::samples, ModelPart::pairs,
                                        ModelPart::features};

/// A recognizable object.
struct Model {
  std::string name;         ///< [A-Za-z0-9][A-Za-z0-9._-]{0,127}
  std::string source;       ///< name of the training file, without folders
  std::string source_xxh3;  ///< XXH3-128 checksum of that file, 32 hexadecimal digits
  /// XXH3-128 checksum of all training input, 32 hexadecimal digits. Models with the same
  /// fingerprint are equal except for their names. Empty in files older than version 1.5.
  std::string fingerprint;
  float diameter = 0;  ///< largest distance between two surface points [library unit]
  /// Area-weighted centroid, which every symmetry keeps in place [library unit].
  Eigen::Vector3f center{0, 0, 0};
  Symmetry symmetry;
  /// Rigid transforms that map much of the surface onto itself but not all of it, best first. Where
  /// T_scene_model fits a scan, T_scene_model * near_symmetries[i] may look alike. The inverse of
  /// each is also a near symmetry. No two are the same placement, and none is the identity.
  std::vector<Pose> near_symmetries;
  /// Axis about which every rotation looks alike, as for a mug, a flange or a gear. Absent if it is
  /// an axis of symmetry.
  std::optional<Symmetry::Axis> near_axis;

  Shared<PointsView> vertices;      ///< original surface, scaled to the library's unit
  Shared<TrianglesView> triangles;  ///< empty if trained from a cloud without a surface

  /// Approximately uniform samples of the visible surface, for refinement and verification.
  Shared<PointsView> samples;
  Shared<NormalsView> sample_normals;  ///< outward normals
  Shared<std::span<const ViewMask>> sample_views;
  float sample_spacing = 0;  ///< mean distance between neighboring samples [library unit]

  Shared<PointsView> ppf_points;  ///< points that the table's entries refer to; at most 65,536
  Shared<NormalsView> ppf_normals;
  Shared<PpfTableView> ppf;

  /// Features by scale, finest first; empty if trained without features.
  std::array<TriSpinFeatures, kFeatureScales.size()> features;

  /// Whether the model was trained with point pairs.
  bool has_pairs() const noexcept { return ppf.quantization.num_distance_bins > 0; }
};

}  // namespace trivet
