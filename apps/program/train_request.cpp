#include "apps/program/train_request.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/inputs/inputs.hpp"
#include "apps/results/write_json.hpp"
#include "apps/words/train_summary.hpp"
#include "engine/options/presets.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {

void add_train_options(CLI::App& command, TrainArguments& arguments) {
  command
      .add_option(
          "MODEL", arguments.models,
          "Meshes or clouds (PLY, PCD, OBJ, STL, OFF, XYZ, glTF, NPY), packed by gzip or not, "
          "NAME=FILE, folders, manifests, or BOP "
          "data sets")
      ->required();
  command
      .add_option("-o,--output", arguments.output,
                  "Library file to bring up to date; it changes as a whole or not at all")
      ->required();
  command
      .add_option("--unit", arguments.unit,
                  "Unit of the models: m or mm; default: the library's, of a new one m; manifests "
                  "name their own, BOP data sets are in mm")
      ->check(CLI::IsMember({"m", "mm"}));
  command.add_flag("--prune", arguments.prune,
                   "Models of the library that are not named go; else they stay");
  command.add_flag("--keep-going", arguments.keep_going,
                   "Leave out models that cannot be trained, and write the others; else nothing is "
                   "written");
  command.add_option("--json", arguments.json,
                     "Write what was trained as JSON to this file, - for standard output");
  add_option(command, preset_option("Options", "How finely models are sampled"),
             std::string(kUsualPreset), arguments.preset);
  add_options<TrainOptions>(command, arguments.given);
}

Result<TrainRequest> make_request(const TrainArguments& arguments, const Console& console) {
  Result<ModelInputs> inputs = collect_models(arguments.models);
  if (!inputs) return inputs.error();
  for (const std::string& note : inputs->notes) console.line(note);
  for (const std::string& words : left_out_words(inputs->left_out)) console.warning(words);
  const Result<LengthUnit> unit =
      choose_unit_into(arguments.output, *inputs, arguments.unit, arguments.prune);
  if (!unit) return unit.error();
  const GivenOption& preset = arguments.preset;
  TrainOptions options =
      train_presets().find(preset.is_given() ? preset.text : kUsualPreset)->second;
  TRIVET_TRY(set_given(arguments.given, options));
  return TrainRequest{std::move(inputs->sources), *unit,           options,
                      arguments.output,           arguments.prune, arguments.keep_going,
                      std::move(inputs->left_out)};
}

TrainProgress train_progress(const Console& console, const std::stop_token& stop) {
  constexpr bool kBrief = true;
  return {console.progress("read", stop, kBrief), console.progress("trained", stop),
          console.progress("wrote", stop, kBrief)};
}

Result<void> write_train_report(const TrainReport& report, const TrainRequest& request,
                                const std::string& json, const Console& console) {
  for (const ModelFacts& model : report.models) {
    for (const std::string& warning : model.warnings)
      console.warning(fmt::format("{}: {}", model.name, warning));
  }
  const std::string file = request.file.string();
  if (const std::string table = train_table(report, request.unit); !table.empty())
    console.line(table);
  console.line(train_line(report, file));
  if (!json.empty()) {
    TRIVET_TRY(write_json(json, train_json(report, request)));
  }
  if (report.faults.empty()) return {};
  Error error{ErrorCode::bad_data,
              fmt::format("{} left out of {}, which has the others:",
                          counted(report.faults.size(), "model is", "models are"), file)};
  for (const ModelFault& fault : report.faults) error.message += "\n" + fault.error.message;
  return error;
}

Result<void> train_and_report(const TrainRequest& request, const std::string& json,
                              const Console& console, const std::stop_token& stop) {
  const Result<TrainReport> report = train_library(request, train_progress(console, stop));
  if (!report) return report.error();
  return write_train_report(*report, request, json, console);
}

}  // namespace trivet::apps
