#include <fmt/format.h>

#include <memory>

#include "apps/commands.hpp"
#include "apps/inputs.hpp"
#include "engine/render_scenes.hpp"

namespace trivet::apps {
namespace {

struct ScanArguments {
  std::vector<std::string> models;
  std::string output, unit;
  ScanOptions options;
};

Result<void> scan(const ScanArguments& arguments, const Context& context) {
  const Result<ModelInputs> inputs = collect_models(arguments.models);
  if (!inputs) return inputs.error();
  const Result<LengthUnit> unit = choose_unit(*inputs, arguments.unit);
  if (!unit) return unit.error();
  const Result<Manifest> manifest =
      render_scenes(inputs->sources, *unit, arguments.options, arguments.output,
                    context.console.progress("rendered", context.stop));
  if (!manifest) return manifest.error();
  std::size_t num_instances = 0;
  for (const ManifestScene& scene : manifest->scenes) num_instances += scene.truth.size();
  context.console.line(fmt::format("{}/manifest.json: {} scenes with {} instances of {} models",
                                   arguments.output, manifest->scenes.size(), num_instances,
                                   manifest->models.size()));
  return {};
}

}  // namespace

void add_scan(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<ScanArguments>();
  CLI::App* command =
      app.add_subcommand("scan", "Render scans of heaps of models with a virtual depth sensor");
  command
      ->add_option("MODEL", arguments->models,
                   "Meshes (PLY, OBJ, STL, OFF), NAME=FILE, folders, manifests, or BOP data sets")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for the depth images, the models and manifest.json")
      ->required();
  command->add_option("--scenes", arguments->options.num_scenes, "Scenes to render")
      ->capture_default_str();
  command->add_option("--instances", arguments->options.num_instances, "Objects of a scene")
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Other seeds give other scenes")
      ->capture_default_str();
  command
      ->add_option("--noise", arguments->options.noise,
                   "Noise, in those of a household depth camera; 0: none")
      ->capture_default_str();
  command
      ->add_option("--unit", arguments->unit, "Unit of the models and the scans: m (default) or mm")
      ->check(CLI::IsMember({"m", "mm"}));
  command->add_option("--diameter", arguments->options.diameter,
                      "Scale every model to this diameter, for meshes of arbitrary size");
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return scan(*arguments, context); };
  });
}

}  // namespace trivet::apps
