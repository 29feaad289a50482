/// Scene data for recognition, prepared once for all models.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/results/scene_view.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/read_scene.hpp"
#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/scans/sensor_model.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// A scan as depth images with normals, and as an oriented point cloud. Lengths in the library's
/// unit.
struct PreparedScene {
  SceneView view;  ///< kind and viewpoint of the scan
  /// One image of a sensor, or six around a closed surface.
  std::vector<kernels::RangeImage> images;
  Points points;
  Normals normals;                     ///< toward the sensor or outward; NaN if unknown
  Points edges;                        ///< places where faces end above what is behind them
  Normals edge_directions;             ///< out of these faces, in their planes
  std::vector<kernels::Plane> planes;  ///< large planes, for models of any size
  std::vector<float> patches;          ///< area of the largest connected patch of each
  std::vector<std::uint8_t> ground;    ///< of each: 1 if nothing is measured behind it
  kernels::SensorModel sensor;         ///< error model of the sensor
  float spacing = 0;                   ///< typical distance between neighboring measurements
  float window = 2;                    ///< half-width of the windows for fitting normals [spacing]
  double scale = 1;                    ///< factor from the file's lengths to the library's unit
  Eigen::Vector3d offset{0, 0, 0};     ///< offset of the cloud (Cloud::offset) [file's unit]
};

inline constexpr float kPlaneAngleRad = 0.35F;
/// Points whose normals differ by more are not thinned together.
inline constexpr float kNormalClusterRad = 0.5236F;
inline constexpr std::size_t kFewestPoints =
    50;  ///< a scan with fewer measurements counts as empty

struct PrepareOptions {
  /// Radius of the windows for fitting normals [spacing]; absent: chosen by the noise.
  std::optional<float> normal_window{};
  bool correlated_noise = true;  ///< whether to measure the error shared by neighboring pixels
  bool operator==(const PrepareOptions&) const = default;
};

/// Errors: bad_data (too few points, no surface).
Result<PreparedScene> prepare_scene(const Cloud& cloud, const SceneInput& input, StageTimes& times,
                                    const PrepareOptions& options = {});

/// Whether each plane is too large to be part of a model of this diameter, by plane number.
std::vector<std::uint8_t> background_planes(const PreparedScene& scene, float diameter);

}  // namespace trivet::engine
