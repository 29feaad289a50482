#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/commands/commands.hpp"
#include "engine/calibration/calibrate_score.hpp"
#include "engine/loaded_library/default_score.hpp"
#include "engine/loaded_library/score_file.hpp"
#include "kernels/scoring/fit_score.hpp"
#include "storage/common/counted.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/files/file.hpp"
#include "storage/files/text.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {
namespace {

constexpr double kRidge = 1;
constexpr std::uint64_t kMaxOutcomesBytes = 1ULL << 30;
/// The calibration scenes contain more than two unknown objects per object of the library. Scenes in
/// use contain about half as many: the odds that a detection is correct are this many times higher.
constexpr double kFewerUnknown = 4.2;

struct FitScoreArguments {
  std::vector<std::string> libraries, manifests, outcomes;
  std::string output, csv;
  unsigned rounds = 2;
};

Result<Outcomes> recognize_with(const kernels::ScoreModel& score,
                                const FitScoreArguments& arguments, const Context& context) {
  Outcomes outcomes;
  for (std::size_t k = 0; k < arguments.manifests.size(); ++k) {
    Result<Library> library = open_library(arguments.libraries[k]);
    if (!library) return library.error();
    const Result<Manifest> manifest = read_manifest(arguments.manifests[k]);
    if (!manifest) return manifest.error();
    const Recognizer recognizer(std::move(*library), score);
    const Result<void> added = add_outcomes(
        recognizer, *manifest, {}, context.console.progress("recognized", context.stop), outcomes);
    if (!added) return added.error();
  }
  return outcomes;
}

/// Counts correct and wrong detections.
std::pair<std::size_t, std::size_t> count(const Outcomes& outcomes) {
  const auto right = static_cast<std::size_t>(std::ranges::count(outcomes.right, 1));
  return {right, outcomes.right.size() - right};
}

Result<void> check_outcomes(const Outcomes& outcomes, const std::string& source) {
  const auto [right, wrong] = count(outcomes);
  if (right < 20 || wrong < 20) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected scenes with at least 20 right and 20 wrong detections, "
                             "found {} and {}; scan more scenes, with objects that the library has "
                             "and others that it has not",
                             source, right, wrong)};
  }
  return {};
}

void set_prior(kernels::ScoreModel& model) {
  for (float& bias : model.bias) bias += static_cast<float>(std::log(kFewerUnknown));
}

std::string origin_of(const Outcomes& outcomes) {
  const auto [right, wrong] = count(outcomes);
  return fmt::format(
      "trivet fit-score {} on {} right and {} wrong detections in rendered scenes, the odds of "
      "right ones times {}",
      TRIVET_VERSION, right, wrong, kFewerUnknown);
}

Result<void> publish_text(const std::string& file, const std::string& text) {
  return publish_file(file, std::as_bytes(std::span(text)));
}

std::string csv_header() {
  std::string text = "right";
  for (const kernels::ScorePart& part : kernels::kScoreParts) text += fmt::format(",{}", part.name);
  return text;
}

std::string csv_of(const Outcomes& outcomes) {
  std::string text = csv_header() + '\n';
  for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
    text += outcomes.right[i] != 0 ? '1' : '0';
    for (const float value : outcomes.parts[i]) text += fmt::format(",{:.6g}", value);
    text += '\n';
  }
  return text;
}

/// Adds the output of csv_of().
Result<void> read_outcomes(const std::string& file, Outcomes& outcomes) {
  const Result<std::string> text = read_text_file(file, kMaxOutcomesBytes);
  if (!text) return text.error();
  formats::TextCursor cursor(*text, ",");
  if (cursor.rest_of_line() != csv_header()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected outcomes of this version, of columns \"{}\", found "
                             "\"{:.100}\"",
                             file, csv_header(), cursor.rest_of_line())};
  }
  while (cursor.next_line() && cursor.remaining() > 0) {
    const std::string_view line = cursor.rest_of_line();
    const std::optional<std::int64_t> right = parse_integer(cursor.word());
    kernels::ScoreParts parts{};
    bool is_valid = right == 0 || right == 1;
    for (float& part : parts) {
      const std::optional<double> value = parse_number(cursor.word());
      is_valid = is_valid && value;
      part = to_float(value.value_or(0));
    }
    if (!is_valid || !cursor.word().empty()) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}: line {}: expected 0 or 1 and {} numbers, found \"{:.100}\"",
                               file, cursor.line(), parts.size(), line)};
    }
    outcomes.parts.push_back(parts);
    outcomes.right.push_back(static_cast<std::uint8_t>(*right));
  }
  return {};
}

Result<void> fit_score(const FitScoreArguments& arguments, const Context& context) {
  if (arguments.libraries.size() != arguments.manifests.size()) {
    return Error{ErrorCode::usage,
                 fmt::format("expected one --library for each --scenes, found {} and {}",
                             arguments.libraries.size(), arguments.manifests.size())};
  }
  if (arguments.manifests.empty() && arguments.outcomes.empty())
    return Error{ErrorCode::usage, "expected --scenes or --outcomes to fit to, found neither"};
  Outcomes known;
  for (const std::string& file : arguments.outcomes) {
    TRIVET_TRY(read_outcomes(file, known));
  }
  const std::string& source =
      arguments.manifests.empty() ? arguments.outcomes.front() : arguments.manifests.front();
  kernels::ScoreModel model = default_score();
  Outcomes outcomes;
  // Outcomes of earlier runs stay as they are.
  const unsigned rounds = arguments.manifests.empty() ? 1 : arguments.rounds;
  for (unsigned round = 0; round < rounds; ++round) {
    Result<Outcomes> found = recognize_with(model, arguments, context);
    if (!found) return found.error();
    if (!arguments.csv.empty()) {
      const Result<void> written = publish_text(arguments.csv, csv_of(*found));
      if (!written) return written;
    }
    outcomes = known;
    outcomes.parts.insert(outcomes.parts.end(), found->parts.begin(), found->parts.end());
    outcomes.right.insert(outcomes.right.end(), found->right.begin(), found->right.end());
    if (arguments.output.empty()) return {};
    TRIVET_TRY(check_outcomes(outcomes, source));
    const double before = kernels::log_loss(model, outcomes.parts, outcomes.right);
    model = kernels::fit_score(outcomes.parts, outcomes.right, kRidge);
    context.console.line(fmt::format("round {}: {}, log loss {:.4f} -> {:.4f}", round + 1,
                                     counted(outcomes.right.size(), "detection"), before,
                                     kernels::log_loss(model, outcomes.parts, outcomes.right)));
  }
  set_prior(model);
  return publish_text(arguments.output, score_text({model, origin_of(outcomes)}));
}

}  // namespace

void add_fit_score(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<FitScoreArguments>();
  CLI::App* command = app.add_subcommand(
      "fit-score",
      "Fit the default score of detections to scenes of known truth, for developers\n\n"
      "Recognizes the scenes, and fits a monotone logistic model to what the examination of each\n"
      "detection found and whether it was right. The detections depend on their scores, so this\n"
      "is done in rounds. Objects in the scenes that the library does not have are unknown ones.\n"
      "`trivet calibrate` adapts the score that this program has to the scans of one cell.");
  command->add_option("--library", arguments->libraries,
                      "Library to find in the scenes that follow; as often as --scenes");
  command->add_option("--scenes", arguments->manifests, "Manifest of scenes with their truth");
  command->add_option("--outcomes", arguments->outcomes,
                      "What --csv of earlier runs wrote, to fit to as well or alone");
  command->add_option(
      "-o,--output", arguments->output,
      "The score as JSON, engine/loaded_library/default_score.json; without it nothing is fitted");
  command->add_option("--csv", arguments->csv,
                      "Write the parts of every detection's score and the outcome to this file");
  command->add_option("--rounds", arguments->rounds, "Of recognizing and fitting")
      ->check(CLI::Range(1, 5))
      ->capture_default_str();
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return fit_score(*arguments, context); };
  });
}

}  // namespace trivet::apps
