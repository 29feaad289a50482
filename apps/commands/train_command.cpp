#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/options/add_options.hpp"
#include "apps/options/presets.hpp"
#include "storage/counted.hpp"

namespace trivet::apps {
namespace {

struct TrainArguments {
  std::vector<std::string> models;
  std::string output, unit;
  GivenOption preset;
  GivenOptions given;
};

Result<void> train(const TrainArguments& arguments, const Context& context) {
  const Result<ModelInputs> inputs = collect_models(arguments.models);
  if (!inputs) return inputs.error();
  for (const std::string& note : inputs->notes) context.console.line(note);
  const Result<LengthUnit> unit = choose_unit(*inputs, arguments.unit);
  if (!unit) return unit.error();
  const GivenOption& preset = arguments.preset;
  TrainOptions options =
      train_presets().find(preset.is_given() ? preset.text : kUsualPreset)->second;
  if (const Result<void> set = set_given(arguments.given, options); !set) return set;

  const Result<LibraryStats> stats =
      train_library(inputs->sources, *unit, options, arguments.output,
                    context.console.progress("trained", context.stop));
  if (!stats) return stats.error();
  std::uint64_t entries = 0, features = 0;
  for (const auto& [name, model] : stats->models) {
    entries += model.num_ppf_entries;
    features += model.num_features;
    for (const std::string& warning : model.warnings)
      context.console.warning(fmt::format("{}: {}", name, warning));
  }
  context.console.line(fmt::format(
      "{}: {}, {}, {}, {:.2f} s", arguments.output, counted(stats->models.size(), "model"),
      counted(entries, "point pair"), counted(features, "feature"), stats->seconds));
  return {};
}

}  // namespace

void add_train(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = app.add_subcommand("train", "Train models into one library file");
  command
      ->add_option(
          "MODEL", arguments->models,
          "Meshes or clouds (PLY, PCD, OBJ, STL, OFF, XYZ, glTF, NPY), packed by gzip or not, "
          "NAME=FILE, folders, manifests, or BOP "
          "data sets")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Library file to write; it appears whole or not at all")
      ->required();
  command
      ->add_option("--unit", arguments->unit,
                   "Unit of the models: m (default) or mm; manifests name their own, BOP data sets "
                   "are in mm")
      ->check(CLI::IsMember({"m", "mm"}));
  add_option(*command, preset_option("Options", "How finely models are sampled"),
             std::string(kUsualPreset), arguments->preset);
  add_options<TrainOptions>(*command, arguments->given);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return train(*arguments, context); };
  });
}

}  // namespace trivet::apps
