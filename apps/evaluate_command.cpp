#include <fmt/format.h>

#include <memory>

#include "apps/commands.hpp"
#include "apps/detections_json.hpp"
#include "apps/evaluation_json.hpp"
#include "apps/json_output.hpp"
#include "apps/recognise_arguments.hpp"
#include "apps/report.hpp"
#include "engine/manifest_inputs.hpp"

namespace trivet::apps {
namespace {

struct EvaluateArguments {
  std::string library, manifest, detections, json, report;
  RecogniseArguments recognise;
};

using SceneResults = std::vector<std::optional<SceneResult>>;

Result<SceneResults> recognise_scenes(const Library& library, const Manifest& manifest,
                                      const EvaluateArguments& arguments, const Context& context) {
  SceneResults results(manifest.scenes.size());
  const Result<void> done = recognise_all(
      library, scenes_of(manifest, library.header.unit), options_of(arguments.recognise),
      context.console.progress("recognised", context.stop),
      [&](std::size_t index, const SceneResult& result) { results[index] = result; });
  if (!done) return done.error();
  return results;
}

Result<SceneResults> stored_results(const Manifest& manifest, const EvaluateArguments& arguments) {
  Result<SceneResults> results = read_detections(arguments.detections, manifest);
  if (!results || !arguments.recognise.min_score) return results;
  for (std::optional<SceneResult>& result : *results) {
    if (!result) continue;
    std::erase_if(result->detections, [&](const Detection& detection) {
      return detection.score < *arguments.recognise.min_score;
    });
  }
  return results;
}

Result<void> evaluate_manifest(const EvaluateArguments& arguments, const Context& context) {
  const Result<Manifest> manifest = read_manifest(arguments.manifest);
  if (!manifest) return manifest.error();
  if (manifest->scenes.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected scenes with their truth, found none", arguments.manifest)};
  }
  const Result<Library> library = open_library(arguments.library);
  if (!library) return library.error();
  const Result<SceneResults> results =
      arguments.detections.empty() ? recognise_scenes(*library, *manifest, arguments, context)
                                   : stored_results(*manifest, arguments);
  if (!results) return results.error();
  const Result<Evaluation> evaluation = evaluate(*manifest, *library, *results);
  if (!evaluation) return evaluation.error();

  if (arguments.json != "-") fmt::print("{}", evaluation_table(*evaluation));
  if (!arguments.json.empty()) {
    const Result<void> written =
        write_json(arguments.json, evaluation_json(*manifest, *evaluation, *results));
    if (!written) return written;
  }
  if (arguments.report.empty()) return {};
  return write_report(arguments.report, *library, *manifest, *evaluation, *results,
                      context.console.progress("drawn", context.stop));
}

}  // namespace

void add_evaluate(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Recognise scenes whose truth is known, and score the result");
  command->add_option("LIBRARY", arguments->library, "Library file, made by `trivet train`")
      ->required();
  command->add_option("MANIFEST", arguments->manifest, "Manifest of scenes with their truth")
      ->required();
  command->add_option(
      "--detections", arguments->detections,
      "Score what `trivet recognize --json` wrote to this file instead of recognising");
  add_recognise_options(*command, arguments->recognise);
  command->add_option("--json", arguments->json,
                      "Write the scores as JSON to this file, - for standard output");
  command->add_option("--report", arguments->report,
                      "Write index.html with tables and pictures of every scene into this folder");
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return evaluate_manifest(*arguments, context); };
  });
}

}  // namespace trivet::apps
