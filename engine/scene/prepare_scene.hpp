/// The scene's side of recognition: prepared once for all models, then once more per size of
/// models.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/results/scene_view.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/read_scene.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/scans/sensor_model.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// A scan as images with normals, and as oriented points. Lengths in the library's unit.
struct PreparedScene {
  SceneView view;                           ///< what saw it
  std::vector<kernels::RangeImage> images;  ///< one of a sensor; six around a closed surface
  Points points;
  Normals normals;                     ///< towards the sensor or outward; NaN where unknown
  std::vector<kernels::Plane> planes;  ///< the large ones, of any size of model
  kernels::SensorModel sensor;         ///< how it errs
  float spacing = 0;                   ///< typical distance between neighboring measurements
  float window = 2;  ///< half-width of the windows that normals were fitted to [spacing]
  float plane_tolerance = 0;
  double scale = 1;                 ///< the file's lengths were multiplied by it
  Eigen::Vector3d offset{0, 0, 0};  ///< of the cloud (Cloud::offset) [file's unit]
};

inline constexpr float kPlaneAngleRad = 0.35F;
inline constexpr std::size_t kFewestPoints =
    50;  ///< a scan of fewer measurements is as good as empty

struct PrepareOptions {
  /// Radius of the windows that normals are fitted to [spacing]; absent: as wide as the noise asks
  /// for.
  std::optional<float> normal_window{};
  bool correlated_noise = true;  ///< measure what neighboring pixels err by together, else none
  bool operator==(const PrepareOptions&) const = default;
};

/// Errors: bad_data (too few points, no surface).
Result<PreparedScene> prepare_scene(const Cloud& cloud, const SceneInput& input, StageTimes& times,
                                    const PrepareOptions& options = {});

/// The scene sampled for models of one step; the same in all rounds of voting.
struct SceneSample {
  float step = 0;
  float largest_diameter = 0;  ///< of the models
  Points points;
  Normals normals;
};

/// What becomes of points on planes that are larger than the largest model.
enum class LargePlanes : std::uint8_t { left_out, kept };

/// Sample a scene at `step`.
SceneSample sample_scene(const PreparedScene& scene, float step, float largest_diameter,
                         LargePlanes large_planes = LargePlanes::left_out);

/// Whether a scene point lies on a marked pixel of some image, within `tolerance` of what that
/// pixel measured.
///
/// explained  nonzero for marked pixels, of all images one after the other
bool is_explained(const PreparedScene& scene, std::span<const std::uint8_t> explained,
                  const Eigen::Vector3f& point, float tolerance);

/// What votes for models of one step in one round.
struct SceneLevel {
  float step = 0;
  Points points;
  Normals normals;
  std::vector<std::uint32_t> references;  ///< indices of the points that vote, rising
  kernels::VoxelHash grid;
};

/// Choose the points that vote and the references among them. Points within a step of what a
/// marked pixel measured stay out.
///
/// explained  nonzero for marked pixels, of all images one after the other; empty: none
SceneLevel choose_voters(const PreparedScene& scene, const SceneSample& sample,
                         const VoteOptions& options, std::span<const std::uint8_t> explained = {});

/// By plane number: whether it is too large to be part of a model of this diameter.
std::vector<std::uint8_t> background_planes(const PreparedScene& scene, float diameter);

}  // namespace trivet::engine
