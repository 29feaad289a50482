/// A virtual depth sensor above piles of known objects: scenes of which the truth is known exactly.
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
  std::uint32_t num_instances = 8;  ///< objects of a scene
  std::uint32_t of_a_kind = 1;      ///< so many of a model before the next model comes
  std::uint32_t num_clutter = 0;    ///< other parts among them, in no truth
  std::uint64_t seed = 1;           ///< other seeds give other scenes
  bool bin = false;                 ///< in an open box instead of on a table
  bool walls = false;               ///< a corner of two walls behind the pile
  /// The objects differ from their models by smooth deviations, root mean square of so many
  /// diameters.
  double deviation = 0;
  SensorOptions sensor{};
  double resolution = 1;  ///< pixels along a side of the image, in those of kScanWidth, kScanHeight
  /// Draw for each scene how its sensor falls short of the ideal one (engine::draw_flaws), its
  /// focal length, 1 to 2.5 times the distance that frames the pile, and what stands around; for
  /// the set the width of the image.
  bool randomize = false;
  bool operator==(const ScanOptions&) const = default;
};

template <>
std::span<const Option<ScanOptions>> options_of<ScanOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const ScanOptions& options);

/// An object to lay into scenes. All lengths are meters.
struct ScanModel {
  std::string name;
  Points vertices;      ///< every one used by a triangle
  Triangles triangles;  ///< at least one
  Symmetry symmetry;
  bool metal = false;  ///< mirrors the sensor's light
  /// Open and empty, what lies in half of the randomized sets; empty: there is none.
  Mesh hollow{};
};

struct ScanModelOptions {
  float diameter = 0;  ///< scale every model to this diameter [library unit]; 0: as it is
  bool metal = false;
};

/// Read models and find the symmetries that are not declared.
///
/// unit  library unit of the sources' scales and symmetries
/// Errors: of reading, bad_data (points without faces).
Result<std::vector<ScanModel>> read_scan_models(std::span<const ModelSource> sources,
                                                LengthUnit unit, const ScanModelOptions& options);

/// The first n machine parts of a seed, of all families or of these
/// (engine/simulation/make_parts.hpp).
std::vector<ScanModel> make_scan_models(std::size_t n, std::uint64_t seed,
                                        std::span<const std::string> families = {});

/// What lies in the scenes of render_scenes in the models' place: the same, or what deviates from
/// them (ScanOptions::deviation, randomize).
std::vector<ScanModel> scanned_objects(std::span<const ScanModel> models,
                                       const ScanOptions& options);

inline constexpr std::uint32_t kScanWidth = 640, kScanHeight = 480;

/// One depth image and what is in it.
struct RenderedScene {
  std::uint32_t width = kScanWidth, height = kScanHeight;
  Camera camera;                      ///< as it is written; depth_scale: to the asked unit
  Camera true_camera;                 ///< what the exact image is of; the same unless randomized
  engine::SensorFlaws flaws;          ///< none unless randomized
  std::vector<std::uint16_t> depths;  ///< width * height; 0: no measurement
  engine::ExactImage exact{0, 0};     ///< of the same size; instances: the truth, then the rest
  /// One an instance; lengths in the asked unit. Where the camera that is written is not the true
  /// one, the poses are those that fit what is written best (engine::written_pose).
  std::vector<TruthInstance> truth;
  /// Ids and poses of the same for BOP; object ids count models from 1. The rest is told by what
  /// was measured (engine::BopTruth).
  BopImage bop;
};

/// Scans one scene after the other, or side by side.
class VirtualScanner {
 public:
  /// models   at least one; they outlive the scanner
  /// unit     of the truth
  /// Errors: usage (an option), bad_data (no model, one without extent), internal (ray tracing).
  static Result<VirtualScanner> create(std::span<const ScanModel> models, LengthUnit unit,
                                       const ScanOptions& options);
  VirtualScanner(VirtualScanner&&) noexcept;
  VirtualScanner& operator=(VirtualScanner&&) noexcept;
  ~VirtualScanner();

  /// Scan models at rest in a pile, on the ground or in a bin (engine::pile_up), with a camera that
  /// looks down on them from a random side.
  ///
  /// index  of the scene; every scene is the same whichever others are scanned
  /// Visible fraction: exact, of the silhouette's pixels, those beyond the image's border included.
  /// Occlusion and clutter: Drost's, of areas; a pixel that is measured, of a surface less than 80
  /// degrees steep, stands for the patch z^2 / (fx fy |normal . ray|) that it sees. Instances with
  /// less than 15 % or 300 pixels visible are to be ignored. Any number of threads may scan at the
  /// same time.
  /// Errors: usage (a pile beyond the sensor's range), internal (ray tracing).
  Result<RenderedScene> scan(std::uint32_t index) const;

 private:
  struct State;
  explicit VirtualScanner(std::unique_ptr<const State> state);
  std::unique_ptr<const State> state_;
};

/// Render scenes and write them into a folder, as a BOP data set (storage/datasets/bop.hpp, split
/// "test", scene 1, an image a scene, with the masks of every instance) and as manifest.json, which
/// has the models' names, over the same files. models_eval/ has the meshes of models/. Same input, same bytes for any number of threads. Errors: of rendering, usage (no
/// model), cannot_create, io; resumable when stopped.
Result<Manifest> render_scenes(std::span<const ScanModel> models, LengthUnit unit,
                               const ScanOptions& options, const std::filesystem::path& folder,
                               const Progress& progress);

}  // namespace trivet
