#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/recognition/outputs.hpp"
#include "apps/recognition/recognize_request.hpp"
#include "apps/results/failed_scenes.hpp"
#include "apps/words/reported_part.hpp"
#include "engine/recognition/estimate_camera.hpp"

namespace trivet::apps {
namespace {

/// Recognizes the scenes one after the other. Passes results to `emit` and failures to `fail`, with
/// the estimated cameras if requested.
Result<void> recognize_scenes(RecognitionRequest& request, bool estimate_camera,
                              const Progress& progress,
                              const std::function<void(std::size_t, const SceneResult&)>& emit,
                              const std::function<void(std::size_t, const Error&)>& fail) {
  std::vector<SceneInput>& scenes = request.scenes.sources;
  if (!estimate_camera)
    return recognize_all(request.recognizer, scenes, request.kept, progress, emit, fail);
  const Result<std::vector<Result<SceneResult>>> results =
      recognize_estimating_camera(request.recognizer, scenes, request.kept, progress);
  if (!results) return results.error();
  for (std::size_t s = 0; s < results->size(); ++s) {
    const Result<SceneResult>& result = (*results)[s];
    result ? emit(s, *result) : fail(s, result.error());
  }
  return {};
}

Result<void> recognize(const SceneCommand& arguments, const Context& context) {
  Result<RecognitionRequest> request = make_request(arguments, context.console);
  if (!request) return request.error();
  Result<OutputList> outputs =
      make_outputs(arguments.outputs, arguments.library, *request, context);
  if (!outputs) return outputs.error();
  std::span<SceneInput> scenes = request->scenes.sources;
  std::vector<Error> failures;
  TRIVET_TRY(recognize_scenes(
      *request, arguments.estimate_camera, context.console.progress("recognized", context.stop),
      [&](std::size_t index, const SceneResult& all) {
        outputs->add({index, scenes[index], reported_part(all, request->kept), all});
      },
      [&](std::size_t index, const Error& error) {
        failures.push_back(error);
        outputs->add_failed(scenes[index], error);
      }));
  TRIVET_TRY(outputs->finish());
  return failed_scenes(failures, scenes.size());
}

}  // namespace

void add_recognize(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<SceneCommand>();
  CLI::App* command = app.add_subcommand("recognize", "Find the models of a library in scenes");
  add_scene_command(*command, *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return recognize(*arguments, context); };
  });
}

}  // namespace trivet::apps
