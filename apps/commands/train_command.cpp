#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/options/presets.hpp"

namespace trivet::apps {
namespace {

struct TrainArguments {
  std::vector<std::string> models;
  std::string output, unit, preset = "balanced";
  std::vector<std::string> methods{"ppf", "trisi"};
  std::optional<float> relative_step, component_energy;
  std::optional<std::uint32_t> components;
};

Result<void> train(const TrainArguments& arguments, const Context& context) {
  const Result<ModelInputs> inputs = collect_models(arguments.models);
  if (!inputs) return inputs.error();
  const Result<LengthUnit> unit = choose_unit(*inputs, arguments.unit);
  if (!unit) return unit.error();
  TrainOptions options = train_presets().at(arguments.preset);
  if (arguments.relative_step) options.relative_step = *arguments.relative_step;
  const auto wanted = [&](std::string_view method) {
    return std::ranges::find(arguments.methods, method) != arguments.methods.end();
  };
  options.point_pairs = wanted("ppf");
  options.tri_spin_images = wanted("trisi");
  if (arguments.components) options.num_components = *arguments.components;
  if (arguments.component_energy) options.component_energy = *arguments.component_energy;

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
  context.console.line(fmt::format("{}: {} models, {} point pairs, {} features, {:.2f} s",
                                   arguments.output, stats->models.size(), entries, features,
                                   stats->seconds));
  return {};
}

}  // namespace

void add_train(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = app.add_subcommand("train", "Train models into one library file");
  command
      ->add_option(
          "MODEL", arguments->models,
          "Meshes or clouds (PLY, PCD, OBJ, STL, OFF, XYZ), NAME=FILE, folders, manifests, or BOP "
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
  command
      ->add_option("--preset", arguments->preset,
                   "fast, balanced or accurate: how finely models are sampled")
      ->check(CLI::IsMember({"fast", "balanced", "accurate"}))
      ->capture_default_str();
  command->add_option(
      "--relative-step", arguments->relative_step,
      "Sampling step as a share of the diameter, 0.01 to 0.2; overrides the preset");
  command
      ->add_option("--methods", arguments->methods,
                   "What to train for, as a,b: ppf (point pairs), trisi (Tri-Spin-Images)")
      ->delimiter(',')
      ->check(CLI::IsMember({"ppf", "trisi"}).description(""))
      ->capture_default_str();
  command->add_option("--components", arguments->components,
                      "Principal components that are kept of Tri-Spin-Images, 1 to 675 (default "
                      "60)");
  command->add_option("--component-energy", arguments->component_energy,
                      "Fewer are kept where they have this share of the variance, above 0 to 1 "
                      "(default 1)");
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return train(*arguments, context); };
  });
}

}  // namespace trivet::apps
