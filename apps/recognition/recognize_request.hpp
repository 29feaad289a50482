/// Converts the command line to a recognition request, for all programs that recognize scenes of
/// files.
#pragma once

#include <string>

#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/options/recognize_arguments.hpp"
#include "apps/program/console.hpp"
#include "apps/recognition/outputs.hpp"
#include "storage/common/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

struct SceneCommand {
  std::string library, unit;
  OpenOptions opening;
  SceneArguments scenes;
  OutputArguments outputs;
  RecognizeArguments recognize;
  bool estimate_camera = false;
};

/// `arguments` must live as long as the command.
void add_scene_command(CLI::App& command, SceneCommand& arguments);

/// Everything needed before the first scene.
struct RecognitionRequest {
  Recognizer recognizer;
  SceneInputs scenes;
  RecognizeOptions options;  ///< options as given
  RecognizeOptions kept;     ///< options extended for the outputs
};

/// Errors: of opening the library and of collecting the scenes; usage.
Result<RecognitionRequest> make_request(const SceneCommand& arguments, const Console& console);

}  // namespace trivet::apps
