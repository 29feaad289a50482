/// Outputs of a command that recognizes scenes.
#pragma once

#include <cstddef>

#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps {

/// A scene of the command and the result for it.
struct RecognizedScene {
  std::size_t index;  ///< index in SceneInputs
  const SceneInput& input;
  const SceneResult& reported;  ///< detections that reach min-score
  const SceneResult& all;       ///< detections down to the score limit of BOP's files
};

/// One kind of output, such as a file. Scenes are added in the order of the command, one at a time.
class Output {
 public:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  virtual ~Output() = default;

  virtual Result<void> add(const RecognizedScene& scene) = 0;
  /// Adds a scene that could not be read or recognized. Outputs that cannot represent it ignore it.
  virtual void add_failed(const SceneInput&, const Error&) {}
  /// Writes what depends on all scenes, once all are added.
  virtual Result<void> finish() = 0;
};

}  // namespace trivet::apps
