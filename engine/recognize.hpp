/// Recognize the models of a library in a scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/progress.hpp"
#include "engine/recognize_options.hpp"
#include "engine/recognize_result.hpp"
#include "engine/recognizer.hpp"
#include "storage/cloud.hpp"
#include "storage/length_unit.hpp"
#include "storage/result.hpp"

namespace trivet {

/// What the sensor was.
struct SceneInput {
  std::filesystem::path file{};
  std::optional<Camera> camera{};              ///< of a depth image
  std::optional<Eigen::Vector3d> viewpoint{};  ///< position of the sensor in the file's frame
  /// No sensor: a whole surface, normals by its faces. Found by itself for a mesh whose faces no one
  /// place sees; a scene whose file holds a pixel grid or a viewpoint is a scan all the same.
  bool closed_surface = false;
  double scale = 1;  ///< multiplies the file's coordinates, giving the library's unit
  /// What came over standard input; `file` is then a name only.
  std::shared_ptr<const std::vector<std::byte>> bytes{};
  std::string format{};              ///< one of cloud_extensions(); empty: by the name
  std::optional<LengthUnit> unit{};  ///< of the coordinates; files that say another are converted
};

/// Read the cloud or depth image of a scene. Errors: those of read_cloud.
Result<Cloud> read_scene(const SceneInput& input);

/// Find the models in one scene that is already in memory. Same input, same bytes for any number of
/// threads. With fewer than 50 measurements nothing is found. Of a scene that is too large for the
/// models by a hundredth of its points at most, these are left out (SceneStats::num_stray).
/// Errors: bad_data (sizes that cannot match the library's unit), usage (unknown model name), internal
/// (no memory for ray tracing), changed (others changed the library in place: see Library::unchanged).
Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& scene,
                              const SceneInput& input, const RecognizeOptions& options,
                              std::stop_token stop = {});

/// Read and recognize many scenes, a few in flight at a time. `emit` gets each result once, in the
/// order of the inputs, from one thread at a time; `fail`, in the same order, what kept a scene from
/// being read or recognized, and the others go on. Without it they do not.
/// Errors: the first one met, in the order of the inputs, that `fail` does not take; usage and
/// changed, which would meet all scenes; resumable when stopped.
Result<void> recognize_all(const Recognizer& recognizer, std::span<const SceneInput> scenes,
                           const RecognizeOptions& options, const Progress& progress,
                           const std::function<void(std::size_t index, const SceneResult&)>& emit,
                           const std::function<void(std::size_t index, const Error&)>& fail = {});

}  // namespace trivet
