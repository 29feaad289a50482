#include "apps/options/recognize_arguments.hpp"

#include <CLI/CLI.hpp>

#include "apps/results/detections_json.hpp"
#include "engine/options/presets.hpp"

namespace trivet::apps {
namespace {

constexpr OptionInfo kPreset = preset_option("What is searched", "Between speed and recall");

}  // namespace

void add_recognize_options(CLI::App& command, RecognizeArguments& arguments) {
  add_option(command, kPreset, std::string(kUsualPreset), arguments.preset);
  command
      .add_option("--expected", arguments.expected,
                  "Result of an earlier recognition (--json): its poses are tested first, and "
                  "voting is for what they leave unexplained")
      ->type_name("FILE")
      ->group(std::string(kPreset.group));
  add_options<RecognizeOptions>(command, arguments.given);
}

Result<RecognizeOptions> recognize_options(const RecognizeArguments& arguments) {
  const GivenOption& preset = arguments.preset;
  RecognizeOptions options =
      recognize_presets().find(preset.is_given() ? preset.text : kUsualPreset)->second;
  TRIVET_TRY(set_given(arguments.given, options));
  if (!arguments.expected.empty()) {
    Result<std::vector<ExpectedPose>> expected = read_expected_poses(arguments.expected);
    if (!expected) return expected.error();
    options.expected = std::move(*expected);
  } else if (options.pose.rounds == 0) {
    return Error{ErrorCode::usage,
                 "--rounds 0 tests expected poses only, and none are given: give --expected FILE, "
                 "or 1 round or more"};
  }
  return options;
}

}  // namespace trivet::apps
