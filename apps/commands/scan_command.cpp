#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/options/add_options.hpp"
#include "engine/simulation/make_parts.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

struct ScanArguments {
  std::vector<std::string> models;
  std::string output, unit;
  std::uint32_t num_parts = 0;
  std::vector<std::string> families;  ///< families of the parts; empty: all
  ScanModelOptions model_options;
  GivenOptions given;
};

/// The models of the command line, then generated parts.
/// Errors: usage (none, two of one name), of reading.
Result<std::vector<ScanModel>> gather_models(const ScanArguments& arguments,
                                             const ModelInputs& inputs, LengthUnit unit,
                                             std::uint64_t seed) {
  Result<std::vector<ScanModel>> models =
      read_scan_models(inputs.sources, unit, arguments.model_options);
  if (!models) return models.error();
  std::set<std::string> names;
  for (const ScanModel& model : *models) names.insert(model.name);
  for (ScanModel& part : make_scan_models(arguments.num_parts, seed, arguments.families)) {
    if (!names.insert(part.name).second) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected one model of this name, found a file and a made part; "
                               "give the file as NAME=FILE",
                               part.name)};
    }
    models->push_back(std::move(part));
  }
  return models;
}

Result<void> scan(const ScanArguments& arguments, const Context& context) {
  if (arguments.models.empty() && arguments.num_parts == 0) {
    return Error{ErrorCode::usage,
                 "expected models to scan, found none; name files, or have parts "
                 "made with --parts"};
  }
  const Result<ModelInputs> inputs = collect_models(arguments.models);
  if (!inputs) return inputs.error();
  for (const std::string& note : inputs->notes) context.console.line(note);
  const Result<LengthUnit> unit = choose_unit(*inputs, arguments.unit);
  if (!unit) return unit.error();
  ScanOptions options;
  TRIVET_TRY(set_given(arguments.given, options));
  const Result<std::vector<ScanModel>> models =
      gather_models(arguments, *inputs, *unit, options.seed);
  if (!models) return models.error();
  const Result<Manifest> manifest =
      render_scenes(*models, *unit, options, arguments.output,
                    context.console.progress("rendered", context.stop));
  if (!manifest) return manifest.error();
  std::size_t num_instances = 0;
  for (const ManifestScene& scene : manifest->scenes) num_instances += scene.truth.size();
  context.console.line(fmt::format("{}/manifest.json: {} with {} of {}", arguments.output,
                                   counted(manifest->scenes.size(), "scene"),
                                   counted(num_instances, "instance"),
                                   counted(manifest->models.size(), "model")));
  return {};
}

}  // namespace

void add_scan(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<ScanArguments>();
  CLI::App* command = app.add_subcommand(
      "scan",
      "Scan piles of models with a virtual depth sensor\n\n"
      "Objects are dropped one after the other and come to rest on one another, without entering\n"
      "each other. A camera of 640 x 480 pixels, or of --resolution, looks down on them from a\n"
      "random side. The output folder is a BOP data set (models/, camera.json, test/000001/...)\n"
      "and has a manifest.json over the same files, for trivet train, recognize and evaluate; the\n"
      "truth has every pose, visible fraction, occlusion and clutter.");
  command->add_option(
      "MODEL", arguments->models,
      "Meshes (PLY, OBJ, STL, OFF), NAME=FILE, folders, manifests, or BOP data sets");
  CLI::Option* const parts =
      command
          ->add_option("--parts", arguments->num_parts,
                       "Scan so many machine parts, made for it by --seed, beside the MODELs or "
                       "alone; their sizes are real, 20 to 200 mm")
          ->check(CLI::Range(kMaxParts));
  std::vector<std::string> groups;
  for (const std::string& group : family_groups())
    groups.push_back(fmt::format("{} ({})", group, fmt::join(families_of(group), ", ")));
  command
      ->add_option(
          "--families", arguments->families,
          fmt::format("Only parts of these families, as a,b,c, which take turns as they are "
                      "named; known are {}; and in groups, of which each may be named as a whole "
                      "and none is made without being named, {}",
                      fmt::join(part_families(), ", "), fmt::join(groups, "; ")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(known_families()).description(""),
              fmt::format("{}", fmt::join(known_families(), ",")))
      ->needs(parts);
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for the models, the depth images and the truth")
      ->required();
  command
      ->add_option("--unit", arguments->unit,
                   "Unit of the models and of manifest.json: m (default) or mm; the BOP files are "
                   "always in mm")
      ->check(CLI::IsMember({"m", "mm"}));
  command->add_option("--diameter", arguments->model_options.diameter,
                      "Scale every MODEL to this diameter, for meshes of arbitrary size");
  command->add_flag("--metal", arguments->model_options.metal,
                    "The MODELs are of bright metal: where they mirror the sensor's light into the "
                    "camera, nothing is measured, and around it the noise is strong");
  add_options<ScanOptions>(*command, arguments->given);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return scan(*arguments, context); };
  });
}

}  // namespace trivet::apps
