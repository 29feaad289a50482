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

/// Parts of a model, each checked as a whole when it is first read.
enum class ModelPart : std::uint8_t { surface, samples, pairs, features };
/// All parts.
inline constexpr std::array kModelParts{ModelPart::surface, ModelPart::samples, ModelPart::pairs,
                                        ModelPart::features};

/// Metadata of a model.
struct ModelInfo {
  std::string name;         ///< [A-Za-z0-9][A-Za-z0-9._-]{0,127}
  std::string source;       ///< name of the training file, without folders
  std::string source_xxh3;  ///< XXH3-128 checksum of that file, 32 hexadecimal digits
  /// XXH3-128 checksum of all training input, 32 hexadecimal digits. Models with the same
  /// fingerprint are equal except for their names. Empty in files older than version 1.5.
  std::string fingerprint;
  float diameter = 0;  ///< largest distance between two surface points [library unit]
  /// Area-weighted centroid, which every symmetry keeps in place [library unit].
  Eigen::Vector3f center{0, 0, 0};
  float sample_spacing = 0;  ///< mean distance between neighboring samples [library unit]
  Symmetry symmetry;
  /// Rigid transforms that map much of the surface onto itself but not all of it, best first. Where
  /// T_scene_model fits a scan, T_scene_model * near_symmetries[i] may look alike. The inverse of
  /// each is also a near symmetry. No two are the same placement, and none is the identity.
  std::vector<Pose> near_symmetries;
  /// Axis about which every rotation looks alike, as for a mug, a flange or a gear. Absent if it is
  /// an axis of symmetry.
  std::optional<Symmetry::Axis> near_axis;
};

/// Original surface, scaled to the library's unit.
struct ModelSurface {
  Shared<PointsView> vertices;
  Shared<TrianglesView> triangles;  ///< empty if trained from a cloud without a surface
};

/// Approximately uniform samples of the visible surface, for refinement and verification.
struct ModelSamples {
  Shared<PointsView> samples;
  Shared<NormalsView> sample_normals;  ///< outward normals
  Shared<std::span<const ViewMask>> sample_views;
};

/// Point pairs, for voting.
struct ModelPairs {
  Shared<PointsView> ppf_points;  ///< points that the table's entries refer to; at most 65,536
  Shared<NormalsView> ppf_normals;
  Shared<PpfTableView> ppf;
};

/// Tri-Spin-Images, for matching.
struct ModelFeatures {
  /// Features by scale, finest first; empty if trained without features.
  std::array<TriSpinFeatures, kFeatureScales.size()> features;
};

/// All columns of a model, part by part.
struct ModelColumns : ModelSurface, ModelSamples, ModelPairs, ModelFeatures {};

/// A recognizable object, with all its data.
struct Model : ModelInfo, ModelColumns {};

/// Extents of a model's columns.
struct ModelShape {
  /// Extents of the features at one scale.
  struct Features {
    std::size_t size = 0;
    float resolution = 0;  ///< sampling distance of scenes for comparison [library unit]
    std::size_t code_bytes = 0;
  };

  std::size_t num_vertices = 0, num_triangles = 0, num_samples = 0;
  std::size_t num_ppf_points = 0, num_ppf_entries = 0;
  std::uint32_t num_references = 0;  ///< see PpfTableView
  PpfQuantization quantization;
  std::array<Features, kFeatureScales.size()> features;  ///< by scale, finest first
  std::uint64_t bytes = 0;                               ///< size of all columns

  /// Whether the model was trained with point pairs.
  bool has_pairs() const noexcept { return quantization.num_distance_bins > 0; }
  std::size_t num_features() const noexcept {
    std::size_t all = 0;
    for (const Features& at_scale : features) all += at_scale.size;
    return all;
  }
};

/// The extents of columns, which need not have been checked: no element is read.
inline ModelShape shape_of(const ModelColumns& columns) noexcept {
  constexpr std::uint64_t kPoint = 3 * sizeof(float);
  const PpfTableView& table = columns.ppf;
  ModelShape shape{columns.vertices.size(),
                   columns.triangles.size(),
                   columns.samples.size(),
                   columns.ppf_points.size(),
                   table.entries.size(),
                   table.num_references,
                   table.quantization,
                   {},
                   0};
  shape.bytes = kPoint * (shape.num_vertices + shape.num_triangles + 2 * shape.num_samples +
                          2 * shape.num_ppf_points) +
                std::span(columns.sample_views).size_bytes() + table.offsets.size_bytes() +
                table.entries.size_bytes();
  for (std::size_t k = 0; k < shape.features.size(); ++k) {
    const TriSpinFeatures& features = columns.features[k];
    shape.features[k] = {features.size(), features.resolution, features.codes.size()};
    shape.bytes +=
        kPoint * features.size() + std::span(features.frames).size_bytes() + features.codes.size();
  }
  return shape;
}

}  // namespace trivet
