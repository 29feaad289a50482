#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/inputs/marked_detections.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/options/recognize_arguments.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/words/commission_text.hpp"
#include "engine/loaded_library/default_score.hpp"
#include "engine/loaded_library/score_calibration.hpp"

namespace trivet::apps {
namespace {

constexpr float kLowestLeast = 0.5F;  // below it, the reported detections affect what is found

struct CalibrateArguments {
  std::string library, output;
  std::vector<std::string> manifests, marked;
  RecognizeArguments recognize;
};

Result<void> check(const CalibrateArguments& arguments, float least) {
  if (arguments.library.empty() != arguments.manifests.empty() ||
      (arguments.manifests.empty() && arguments.marked.empty())) {
    return Error{ErrorCode::usage,
                 "expected LIBRARY and MANIFEST, or --marked, which needs no library; see `trivet "
                 "calibrate --help`"};
  }
  if (!(least >= kLowestLeast && least < 1)) {
    return Error{ErrorCode::usage,
                 fmt::format("--min-score: expected {} to below 1, found {}", kLowestLeast, least)};
  }
  return {};
}

Result<void> recognize_scans(const CalibrateArguments& arguments, const RecognizeOptions& options,
                             const Context& context, Outcomes& outcomes) {
  if (arguments.manifests.empty()) return {};
  const Result<Recognizer> recognizer = open_recognizer(arguments.library, {});
  if (!recognizer) return recognizer.error();
  for (const std::string& file : arguments.manifests) {
    const Result<Manifest> manifest = read_listing(file);
    if (!manifest) return manifest.error();
    const Result<void> added =
        add_outcomes(*recognizer, *manifest, options,
                     context.console.progress("recognized", context.stop), outcomes);
    if (!added) return added;
  }
  return {};
}

Result<void> calibrate(const CalibrateArguments& arguments, const Context& context) {
  const Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  const float least = options->min_score;
  TRIVET_TRY(check(arguments, least));
  Outcomes outcomes;
  TRIVET_TRY(recognize_scans(arguments, *options, context, outcomes));
  for (const std::string& file : arguments.marked) {
    TRIVET_TRY(add_marked(file, outcomes));
  }
  const std::string doubtful = doubtful_marks(default_score(), outcomes);
  TRIVET_TRY(write_output(doubtful));
  const Result<Commissioning> found = commission_score(default_score(), outcomes, least);
  if (!found) return found.error();
  const ScoreCalibration calibration{
      found->adaptation, static_cast<std::uint32_t>(outcomes.scans.size()),
      static_cast<std::uint32_t>(found->num_right), static_cast<std::uint32_t>(found->num_wrong)};
  TRIVET_TRY(write_calibration(arguments.output, calibration));
  return write_output(fmt::format("{}{}: calibration {}\n",
                                  commission_text(*found, outcomes, least), arguments.output,
                                  score_name(calibrated_score(calibration))));
}

}  // namespace

void add_calibrate(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Adapt the score to the scans of one cell, from a few of them\n\n"
      "Either recognizes scans of known truth, or takes results in which detections are marked\n"
      "right or wrong: `trivet recognize LIBRARY SCANS --min-score 0.02 --json FOUND.json`, then\n"
      "\"right\": true or false in each detection. Five scans are a start. Says what it changes,\n"
      "judged on scans left out in turn; writes a file for --calibration of recognize, evaluate\n"
      "and serve. No pose's odds grow more than tenfold by it, whatever was marked.");
  command->add_option("LIBRARY", arguments->library, "Library file, made by `trivet train`");
  command->add_option("MANIFEST", arguments->manifests,
                      "Manifests of scans with their complete truth, or BOP data sets");
  command->add_option("--marked", arguments->marked,
                      "Results of `trivet recognize --json` with marks; they need no library");
  command->add_option("-o,--output", arguments->output, "File to write")->required();
  add_recognize_options(*command, arguments->recognize);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return calibrate(*arguments, context); };
  });
}

}  // namespace trivet::apps
