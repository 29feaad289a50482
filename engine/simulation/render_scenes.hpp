/// Virtual depth sensor above piles of known objects, for scenes with exact ground truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/common/progress.hpp"
#include "engine/simulation/measure_scene.hpp"
#include "engine/training/train.hpp"
#include "storage/common/result.hpp"
#include "storage/data/mesh.hpp"
#include "storage/data/model.hpp"
#include "storage/datasets/bop.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/library/library.hpp"

namespace trivet {

struct ScanOptions {
  std::uint32_t num_scenes = 8;
  std::uint32_t num_instances = 8;  ///< number of objects per scene
  std::uint32_t of_a_kind = 1;      ///< consecutive instances per model
  /// Number of other parts in the pile, not part of the ground truth.
  std::uint32_t num_clutter = 0;
  std::uint64_t seed = 1;  ///< other seeds give other scenes
  bool bin = false;        ///< whether the pile is in an open box instead of on a table
  bool walls = false;      ///< whether two walls form a corner behind the pile
  /// Root mean square of the smooth deviations of objects from their models [diameters].
  double deviation = 0;
  SensorOptions sensor{};
  double resolution = 1;  ///< image size relative to kScanWidth and kScanHeight
  /// Randomize for each scene the flaws of its sensor (engine::draw_flaws), its focal length, its
  /// distance, as 1 to 2.5 times the one that frames the pile, and the surroundings. Also randomize
  /// the width of the images for the whole set.
  bool randomize = false;
  bool operator==(const ScanOptions&) const = default;
};

template <>
std::span<const Option<ScanOptions>> options_of<ScanOptions>();

/// Check the options. Errors: usage (names the option, its range and its value).
Result<void> validate(const ScanOptions& options);

/// An object for scenes. All lengths are in meters.
struct ScanModel {
  std::string name;
  Points vertices;      ///< all used by triangles
  Triangles triangles;  ///< at least one
  Symmetry symmetry;
  bool metal = false;  ///< whether it mirrors the sensor's light
  /// The object opened and emptied, used in half of the randomized sets; empty: none.
  Mesh hollow{};
};

struct ScanModelOptions {
  float diameter = 0;  ///< diameter that every model is scaled to [library unit]; 0: no scaling
  bool metal = false;
};

/// Read models and find the symmetries that are not declared.
///
/// unit  library unit of the sources' scales and symmetries
/// Errors: those of reading, bad_data (points without faces).
Result<std::vector<ScanModel>> read_scan_models(std::span<const ModelSource> sources,
                                                LengthUnit unit, const ScanModelOptions& options);

/// The first n machine parts of a seed, from all families or from these
/// (engine/simulation/make_parts.hpp).
std::vector<ScanModel> make_scan_models(std::size_t n, std::uint64_t seed,
                                        std::span<const std::string> families = {});

/// The objects that represent the models in the scenes of render_scenes: the models themselves, or
/// deviating copies (ScanOptions::deviation, randomize).
std::vector<ScanModel> scanned_objects(std::span<const ScanModel> models,
                                       const ScanOptions& options);

inline constexpr std::uint32_t kScanWidth = 640, kScanHeight = 480;

/// One depth image and its ground truth.
struct RenderedScene {
  std::uint32_t width = kScanWidth, height = kScanHeight;
  Camera camera;                      ///< camera as written; depth_scale: to the requested unit
  Camera true_camera;                 ///< camera of the exact image; the same unless randomized
  engine::SensorFlaws flaws;          ///< none unless randomized
  std::vector<std::uint16_t> depths;  ///< width * height; 0: no measurement
  /// Of the same size; instances: those of the ground truth first, then the others.
  engine::ExactImage exact{0, 0};
  /// One per instance; lengths in the requested unit. If the written camera differs from the true
  /// one, the poses are those that fit the written image best (engine::written_pose).
  std::vector<TruthInstance> truth;
  /// Ids and poses of the same instances for BOP; object ids start at 1 and are indices of models.
  /// The other values follow from the measurements (engine::BopTruth).
  BopImage bop;
};

/// Scanner of scenes, sequentially or in parallel.
class VirtualScanner {
 public:
  /// models  at least one; they must outlive the scanner
  /// unit    unit of the ground truth
  /// Errors: usage (an option), bad_data (no model, one without extent), internal (ray tracing).
  static Result<VirtualScanner> create(std::span<const ScanModel> models, LengthUnit unit,
                                       const ScanOptions& options);
  VirtualScanner(VirtualScanner&&) noexcept;
  VirtualScanner& operator=(VirtualScanner&&) noexcept;
  ~VirtualScanner();

  /// Scan models at rest in a pile, on the ground or in a bin (engine::pile_up), with a camera that
  /// looks down on them from a random side.
  ///
  /// index  index of the scene; scenes are independent of one another
  /// The visible fraction is exact and relative to the silhouette's pixels, including those beyond
  /// the image's border. Occlusion and clutter are Drost's, by area: a measured pixel of a surface
  /// less than 80 degrees steep represents the patch z^2 / (fx fy |normal . ray|) that it sees.
  /// Instances with less than 15 % or 300 pixels visible are to be ignored. Thread-safe.
  /// Errors: usage (a pile beyond the sensor's range), internal (ray tracing).
  Result<RenderedScene> scan(std::uint32_t index) const;

 private:
  struct State;
  explicit VirtualScanner(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

/// Render scenes and write them into a folder as a BOP data set (storage/datasets/bop.hpp, split
/// "test", scene 1, one image per scene, with the masks of every instance), and as manifest.json
/// with the models' names for the same files. models_eval/ contains the meshes of models/. Same
/// input, same bytes for any number of threads. Errors: those of rendering, usage (no model),
/// cannot_create, io; resumable when stopped.
Result<Manifest> render_scenes(std::span<const ScanModel> models, LengthUnit unit,
                               const ScanOptions& options, const std::filesystem::path& folder,
                               const Progress& progress);

}  // namespace trivet
