/// A virtual depth sensor above heaps of known objects: scenes of which the truth is known exactly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/progress.hpp"
#include "engine/train.hpp"
#include "storage/library.hpp"
#include "storage/manifest.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"

namespace trivet {

struct ScanOptions {
  std::uint32_t num_scenes = 8;     ///< 1..10000
  std::uint32_t num_instances = 8;  ///< objects of a scene, 1..200
  std::uint64_t seed = 1;           ///< other seeds give other scenes
  float noise = 1;                  ///< in those of a household depth camera, 0..10; 0: none
  float diameter = 0;  ///< scale every model to this diameter [output unit]; 0: as it is
  bool operator==(const ScanOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const ScanOptions& options);

inline constexpr std::uint32_t kScanWidth = 640, kScanHeight = 480;

/// One depth image and what is in it.
struct RenderedScene {
  Camera camera;
  std::vector<std::uint16_t>
      depths;  ///< kScanWidth * kScanHeight; 0: no measurement; in camera.depth_scale
  std::vector<TruthInstance>
      truth;  ///< occlusion: share of the object's own pixels that others cover
};

/// Render one scene: models on a heap on the ground, a camera that looks down at them from a random
/// side.
///
/// models  at least one, trained from a mesh; lengths in `unit`
/// index   of the scene; every scene is the same whichever others are rendered
/// Depth is measured in steps of 0.1 mm with noise along the axis of 1.2 mm + 1.9 mm (z / m -
/// 0.4)^2 (Nguyen, Izadi, Lovell, 3DIMPVT 2012); surfaces steeper than 80 degrees to the sensor,
/// depth edges with them, give no measurement. Instances with less than 15 % or 300 pixels to be
/// seen are marked to be ignored. Errors: usage (too far away for 16-bit depths), internal (ray
/// tracing).
Result<RenderedScene> render_scene(std::span<const Model> models, LengthUnit unit,
                                   const ScanOptions& options, std::uint32_t index);

/// Render scenes and write them into a folder: the models as PLY, depth images, and manifest.json
/// over all of it. Same input, same bytes for any number of threads. A model's symmetries are those
/// declared, or found. Errors: of reading and rendering, bad_data (a model without faces),
/// cannot_create, io; resumable when stopped.
Result<Manifest> render_scenes(std::span<const ModelSource> sources, LengthUnit unit,
                               const ScanOptions& options, const std::filesystem::path& folder,
                               const Progress& progress);

}  // namespace trivet
