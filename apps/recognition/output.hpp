/// What a command writes of the scenes that it recognizes.
#pragma once

#include <cstddef>

#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps {

/// A scene of the command, and what was found in it.
struct RecognizedScene {
  std::size_t index;  ///< in SceneInputs
  const SceneInput& input;
  const SceneResult& reported;  ///< detections that reach min-score
  const SceneResult& all;       ///< detections down to the score that BOP's files take
};

/// One kind of output, such as a file. Scenes are added in the order of the command, one at a time.
class Output {
 public:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  virtual ~Output() = default;

  virtual Result<void> add(const RecognizedScene& scene) = 0;
  /// Add a scene that could not be read or recognized. An output that has no place for it leaves it
  /// out.
  virtual void add_failed(const SceneInput&, const Error&) {}
  /// Write what the scenes added up to, once all are added.
  virtual Result<void> finish() = 0;
};

}  // namespace trivet::apps
