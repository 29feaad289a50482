#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <set>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/options/recognize_arguments.hpp"
#include "apps/report/evaluation_report.hpp"
#include "apps/results/bop_csv.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/evaluation_csv.hpp"
#include "apps/results/evaluation_json.hpp"
#include "apps/results/failed_scenes.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/results/write_json.hpp"
#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

struct EvaluateArguments {
  std::string library, manifest, detections, json, csv, report;
  bool explain_missed = false;
  OpenOptions opening;
  RecognizeArguments recognize;
};

/// The results to evaluate: recognized now, or stored by any program.
struct Judged {
  std::vector<std::optional<SceneResult>> results;
  ScoreThreshold threshold;         ///< which results count as reported
  std::string source;               ///< library or file of the results
  std::vector<std::string> lacked;  ///< counted models that were not searched for
  // Of results that are recognized now:
  std::optional<Recognizer> recognizer{};
  RecognizeOptions options{};
  std::vector<Error> failures{};  ///< scenes without a result
};

std::string source_of(const std::string& library, const std::string& calibration) {
  return calibration.empty() ? library : fmt::format("{}, calibrated by {}", library, calibration);
}

/// The counted models that are not searched for: their instances cannot be found. Prints a warning.
/// Errors: usage (no model is searched for).
Result<std::vector<std::string>> lacked_models(const Manifest& manifest, const Library& library,
                                               const std::vector<std::string>& chosen,
                                               const EvaluateArguments& arguments,
                                               const Console& console) {
  std::vector<std::string> known = chosen;
  if (known.empty())
    for (const ModelInfo& model : library.models) known.push_back(model.name);
  const std::vector<std::string> scored = scored_models(manifest);
  std::vector<std::string> lacked = scored;
  std::erase_if(lacked, [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  });
  if (lacked.empty()) return lacked;
  if (lacked.size() == scored.size()) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: expected models of {}, found none of {}: {}; {} are looked for, "
                             "as '{}'; train the models of the manifest",
                             arguments.library, arguments.manifest, scored.size(),
                             fmt::join(lacked, ", "), known.size(), known.front())};
  }
  console.warning(
      fmt::format("{}: {} of {} models of {} are not looked for, and their instances "
                  "count as not found: {}",
                  arguments.library, lacked.size(), scored.size(), arguments.manifest,
                  fmt::join(lacked, ", ")));
  return lacked;
}

Result<Judged> recognize_scenes(const Manifest& manifest, const EvaluateArguments& arguments,
                                const Context& context) {
  Result<Recognizer> opened = open_recognizer(arguments.library, arguments.opening);
  if (!opened) return opened.error();
  const Recognizer& recognizer = *opened;
  Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  Result<std::vector<std::string>> lacked =
      lacked_models(manifest, recognizer.library(), options->models, arguments, context.console);
  if (!lacked) return lacked.error();
  options->doubtful_score = std::min(kLowestKeptScore, options->min_score);
  Judged judged{{},
                {options->min_score, options->require_pose, options->require_identity,
                 options->doubtful_score},
                source_of(arguments.library, arguments.opening.calibration),
                std::move(*lacked)};
  judged.results.resize(manifest.scenes.size());
  const Result<void> done = recognize_all(
      recognizer, scenes_of(manifest, recognizer.library().header.unit), *options,
      context.console.progress("recognized", context.stop),
      [&](std::size_t index, const SceneResult& result) { judged.results[index] = result; },
      [&](std::size_t, const Error& error) { judged.failures.push_back(error); });
  if (!done) return done.error();
  judged.recognizer.emplace(*std::move(opened));
  judged.options = *std::move(options);
  return judged;
}

/// All stored detections count as reported, unless a threshold is given.
Result<Judged> stored_results(const Manifest& manifest, const EvaluateArguments& arguments,
                              const Context& context) {
  const bool is_bop = std::filesystem::path(arguments.detections).extension() == ".csv";
  if (const auto warning = bop_name_warning(arguments.detections); is_bop && warning)
    context.console.warning(*warning);
  Result<std::vector<std::optional<SceneResult>>> results =
      is_bop ? read_bop_detections(arguments.detections, manifest)
             : read_detections(arguments.detections, manifest);
  if (!results) return results.error();
  std::set<std::string> unlisted;
  for (const std::optional<SceneResult>& result : *results) {
    if (!result) continue;
    for (const Detection& detection : result->detections) unlisted.insert(detection.model);
  }
  const std::size_t num_models = unlisted.size();
  for (const ManifestModel& model : manifest.models) unlisted.erase(model.name);
  if (!unlisted.empty() && unlisted.size() == num_models) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected detections of the models of {}, found those of {} others "
                    "alone, as '{}'",
                    arguments.detections, arguments.manifest, num_models, *unlisted.begin())};
  }
  if (!unlisted.empty()) {
    context.console.warning(
        fmt::format("{}: detections of {} that the manifest does not list, as '{}', are not "
                    "counted",
                    arguments.detections, counted(unlisted.size(), "model"), *unlisted.begin()));
  }
  const Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  ScoreThreshold threshold{{}, options->require_pose, options->require_identity, {}};
  if (arguments.recognize.given.at("min-score").is_given())
    threshold.min_score = options->min_score;
  return Judged{std::move(*results), threshold, arguments.detections, {}};
}

/// Writes the evaluation in each requested form.
Result<void> write_evaluation(const ReportInput& input, const Judged& judged,
                              const EvaluateArguments& arguments, const Context& context) {
  const Evaluation& evaluation = input.evaluation;
  if (arguments.json != "-") {
    TRIVET_TRY(write_output(evaluation_table(evaluation, input.bop) +
                            threshold_words(judged.threshold, judged.source)));
  }
  if (!arguments.json.empty()) {
    nlohmann::ordered_json document =
        evaluation_json(input.manifest, evaluation, judged.threshold, input.bop, input.results);
    document["models_missing"] = judged.lacked;
    add_whys(evaluation, input.whys, document);
    TRIVET_TRY(write_json(arguments.json, document));
  }
  if (!arguments.csv.empty()) {
    TRIVET_TRY(
        write_evaluation_csv(arguments.csv, input.manifest, evaluation, input.bop, input.results));
  }
  if (arguments.report.empty()) return {};
  TRIVET_TRY(
      write_report(arguments.report, input, context.console.progress("drawn", context.stop)));
  context.console.wrote_report(arguments.report);
  return {};
}

Result<void> evaluate_manifest(const EvaluateArguments& arguments, const Context& context) {
  const Result<Manifest> manifest = read_listing(arguments.manifest);
  if (!manifest) return manifest.error();
  if (manifest->scenes.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected scenes with their truth, found none", arguments.manifest)};
  }
  const Result<std::vector<EvaluationMesh>> meshes = read_evaluation_meshes(*manifest);
  if (!meshes) return meshes.error();
  const Result<Judged> judged = arguments.detections.empty()
                                    ? recognize_scenes(*manifest, arguments, context)
                                    : stored_results(*manifest, arguments, context);
  if (!judged) return judged.error();
  const ScoreThreshold& threshold = judged->threshold;
  const Result<Evaluation> evaluation =
      evaluate(*manifest, *meshes, judged->results,
               threshold.min_score.value_or(-std::numeric_limits<float>::infinity()),
               threshold.require_pose, threshold.require_identity);
  if (!evaluation) {
    return Error{evaluation.error().code,
                 fmt::format("{}: {}", arguments.manifest, evaluation.error().message)};
  }
  Result<MissedWhys> whys = MissedWhys{};
  if (arguments.explain_missed) {
    whys = explain_missed(*judged->recognizer, *manifest, *meshes, *evaluation, judged->options,
                          context.console.progress("asked", context.stop));
    if (!whys) return whys.error();
  }
  const Result<BopScores> bop = bop_scores(*manifest, *meshes, judged->results);
  if (!bop) return bop.error();
  TRIVET_TRY(write_evaluation(
      {*manifest, *meshes, *evaluation, *bop, judged->results, judged->source, *std::move(whys)},
      *judged, arguments, context));
  return failed_scenes(judged->failures, manifest->scenes.size());
}

}  // namespace

void add_evaluate(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Recognize scenes whose truth is known, and score the result");
  command
      ->add_option("LIBRARY", arguments->library,
                   "Library file, made by `trivet train`; leave it out with --detections")
      ->required();
  command->add_option("MANIFEST", arguments->manifest,
                      "Manifest of scenes with their truth, or the folder of a BOP data set");
  command->add_option(
      "--detections", arguments->detections,
      "Score the detections in this file, as `trivet recognize --json` or another program wrote "
      "them, or a file of BOP results (.csv), instead of recognizing");
  add_recognize_options(*command, arguments->recognize);
  add_open_options(*command, arguments->opening);
  command
      ->add_flag("--explain-missed", arguments->explain_missed,
                 "State in JSON and report why each missed instance is not found; its scene is "
                 "recognized once more")
      ->excludes("--detections");
  command->add_option("--json", arguments->json,
                      "Write the scores as JSON to this file, - for standard output");
  command->add_option("--csv", arguments->csv,
                      "Write instances.csv, detections.csv and summary.csv into this folder");
  command->add_option("--report", arguments->report,
                      "Write index.html with tables, curves and pictures into this folder");
  command->callback([arguments, &context] {
    // The manifest is the last argument.
    if (arguments->manifest.empty()) arguments->library.swap(arguments->manifest);
    if (arguments->library.empty() && arguments->detections.empty()) {
      throw CLI::RequiredError("LIBRARY and MANIFEST, or a MANIFEST with --detections,");
    }
    context.run = [arguments, &context] { return evaluate_manifest(*arguments, context); };
  });
}

}  // namespace trivet::apps
