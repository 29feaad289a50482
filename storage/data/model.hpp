/// A trained model: everything that recognition needs to know about one object.
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

/// A rigid motion, kept unaligned so that it may stand in plain vectors and structs.
using Pose = Eigen::Transform<float, 3, Eigen::Isometry, Eigen::DontAlign>;

/// Motions that map the model onto itself. The identity is not listed.
struct Symmetry {
  /// A line in the frame of the model.
  struct Axis {
    Eigen::Matrix<float, 3, 1, Eigen::DontAlign> direction{0, 0, 1};  ///< unit vector
    /// A point on the axis [library unit].
    Eigen::Matrix<float, 3, 1, Eigen::DontAlign> point{0, 0, 0};
  };
  /// Discrete symmetries; beside an axis: those that are no turn about it.
  std::vector<Pose> poses;
  std::optional<Axis> axis;  ///< any turn about it is a symmetry
  bool declared = false;     ///< given by the user, not found by the program

  bool trivial() const noexcept { return poses.empty() && !axis; }
};

/// For each surface sample, the directions from which it can be seen, as one bit a direction.
/// Bit d of word w stands for view_direction(64 w + d) of kernels/surfaces/visibility.hpp.
inline constexpr std::size_t kViewWords = 4;
/// A bit for each of the 256 directions.
using ViewMask = std::array<std::uint64_t, kViewWords>;

/// How many near symmetries a model has at most.
inline constexpr std::size_t kMaxNearSymmetries = 16;

/// What of a model is checked together, when it is first used.
enum class ModelPart : std::uint8_t { surface, samples, pairs, features };
/// All of them.
inline constexpr std::array kModelParts{ModelPart::surface, ModelPart::samples, ModelPart::pairs,
                                        ModelPart::features};

/// An object that can be recognized.
struct Model {
  std::string name;         ///< [A-Za-z0-9][A-Za-z0-9._-]{0,127}
  std::string source;       ///< name of the file it was trained from, without folders
  std::string source_xxh3;  ///< XXH3-128 of that file's bytes, 32 hexadecimal digits
  /// XXH3-128 of all that the model was trained from, 32 hexadecimal digits: models of one
  /// fingerprint are equal but for their names. Empty in files of before 1.5.
  std::string fingerprint;
  float diameter = 0;  ///< largest distance between two surface points [library unit]
  /// Area centroid, which every symmetry keeps in place [library unit].
  Eigen::Vector3f center{0, 0, 0};
  Symmetry symmetry;
  /// Motions that map much of the surface onto itself but not all of it, best first: where
  /// T_scene_model fits a scan, T_scene_model * near_symmetries[i] may look alike. The inverse of
  /// each is one, too; none is the same placement as another or as the identity.
  std::vector<Pose> near_symmetries;
  /// Any turn about it looks alike: of a mug, a flange, a gear. Absent where it is a symmetry.
  std::optional<Symmetry::Axis> near_axis;

  Shared<PointsView> vertices;      ///< the surface as given, scaled to the library's unit
  Shared<TrianglesView> triangles;  ///< empty if trained from a cloud without a surface

  /// About uniform over the visible surface, for refinement and verification.
  Shared<PointsView> samples;
  Shared<NormalsView> sample_normals;  ///< outward
  Shared<std::span<const ViewMask>> sample_views;
  float sample_spacing = 0;  ///< mean distance between neighboring samples [library unit]

  Shared<PointsView> ppf_points;  ///< what the table's references index; at most 65,536
  Shared<NormalsView> ppf_normals;
  Shared<PpfTableView> ppf;

  /// By scale, the finest first; none if trained without.
  std::array<TriSpinFeatures, kFeatureScales.size()> features;

  /// Whether it was trained with point pairs.
  bool has_pairs() const noexcept { return ppf.quantization.num_distance_bins > 0; }
};

}  // namespace trivet
