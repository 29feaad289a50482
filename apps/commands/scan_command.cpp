#include <fmt/format.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/options/option_names.hpp"
#include "engine/simulation/make_parts.hpp"
#include "engine/simulation/render_scenes.hpp"

namespace trivet::apps {
namespace {

struct ScanArguments {
  std::vector<std::string> models;
  std::string output, unit;
  std::uint32_t num_parts = 0;
  std::vector<std::string> families;  ///< of the parts; empty: all
  ScanModelOptions model_options;
  ScanOptions options;
};

constexpr std::uint32_t kMaxParts = 1000;

/// The models of the command line, then made parts. Errors: usage (none, two of one name), of
/// reading.
Result<std::vector<ScanModel>> gather_models(const ScanArguments& arguments,
                                             const ModelInputs& inputs, LengthUnit unit) {
  Result<std::vector<ScanModel>> models =
      read_scan_models(inputs.sources, unit, arguments.model_options);
  if (!models) return models.error();
  std::set<std::string> names;
  for (const ScanModel& model : *models) names.insert(model.name);
  for (ScanModel& part :
       make_scan_models(arguments.num_parts, arguments.options.seed, arguments.families)) {
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
  const Result<LengthUnit> unit = choose_unit(*inputs, arguments.unit);
  if (!unit) return unit.error();
  if (const Result<void> valid = validate(arguments.options); !valid) return valid.error();
  const Result<std::vector<ScanModel>> models = gather_models(arguments, *inputs, *unit);
  if (!models) return models.error();
  const Result<Manifest> manifest =
      render_scenes(*models, *unit, arguments.options, arguments.output,
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
  ScanOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand(
      "scan",
      "Scan piles of models with a virtual depth sensor\n\n"
      "Objects are dropped one after the other and come to rest on one another, without entering\n"
      "each other. A camera of 640 x 480 pixels looks down on them from a random side. The output\n"
      "folder is a BOP data set (models/, camera.json, test/000001/...) and has a manifest.json\n"
      "over the same files, for trivet train, recognize and evaluate; the truth has every pose,\n"
      "visible fraction, occlusion and clutter.");
  command->add_option(
      "MODEL", arguments->models,
      "Meshes (PLY, OBJ, STL, OFF), NAME=FILE, folders, manifests, or BOP data sets");
  CLI::Option* const parts =
      command
          ->add_option("--parts", arguments->num_parts,
                       "Scan so many machine parts, made for it by --seed, beside the MODELs or "
                       "alone; their sizes are real, 20 to 200 mm")
          ->check(CLI::Range(kMaxParts));
  command
      ->add_option(
          "--families", arguments->families,
          fmt::format("Only parts of these families, as a,b,c, which take turns as they are "
                      "named; known are {}; and of a household, which no part is without being "
                      "named, {}, or all of these as {}",
                      fmt::join(part_families(), ", "), fmt::join(household_families(), ", "),
                      kHousehold))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(known_families()).description(""))
      ->needs(parts);
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for the models, the depth images and the truth")
      ->required();
  const std::string what = "What is in a scene", how = "How it is measured";
  command->add_option("--scenes", options.num_scenes, "Scenes to scan")
      ->capture_default_str()
      ->group(what);
  command->add_option("--instances", options.num_instances, "Objects of a scene")
      ->capture_default_str()
      ->group(what);
  command
      ->add_option("--of-a-kind", options.of_a_kind,
                   "So many copies of a model lie in a scene before the next model comes")
      ->capture_default_str()
      ->group(what);
  command->add_option("--seed", options.seed, "Other seeds give other scenes")
      ->capture_default_str()
      ->group(what);
  command
      ->add_option("--clutter", options.num_clutter,
                   "So many other parts lie among the objects and are in no truth")
      ->capture_default_str()
      ->group(what);
  command
      ->add_option("--deviation", options.deviation,
                   "The objects differ from their models by smooth deviations, root mean square of "
                   "so many diameters, as printed, cast and scanned ones do; 0.005 is usual")
      ->capture_default_str()
      ->group(what);
  command
      ->add_flag("--bin", options.bin,
                 "Drop the objects into an open box; else onto a table. The camera then looks down "
                 "more steeply")
      ->group(what);
  command
      ->add_flag("--walls", options.walls,
                 "A corner of two walls stands behind the objects, as large planes")
      ->group(what);
  command
      ->add_option("--unit", arguments->unit,
                   "Unit of the models and of manifest.json: m (default) or mm; the BOP files are "
                   "always in mm")
      ->check(CLI::IsMember({"m", "mm"}))
      ->group(what);
  command
      ->add_option("--diameter", arguments->model_options.diameter,
                   "Scale every MODEL to this diameter, for meshes of arbitrary size")
      ->group(what);
  command
      ->add_flag("--metal", arguments->model_options.metal,
                 "The MODELs are of bright metal: where they mirror the sensor's light into the "
                 "camera, nothing is measured, and around it the noise is strong")
      ->group(what);
  command
      ->add_option("--sensor", options.sensor.sensor,
                   "structured-light: a projector 75 mm beside the camera casts shadows; noise as "
                   "of a Kinect, 1.2 mm and more from 0.4 m on.\n"
                   "time-of-flight: no shadows; noise grows with range, on dark and on grazing "
                   "surfaces; pixels at depth edges float between the surfaces.\n"
                   "stereo: a second camera 100 mm beside; noise grows with the square of depth, "
                   "depth comes in steps of 1/16 pixel of disparity.\n"
                   "laser: a plane of light from 200 mm beside the camera; wide shadows, noise "
                   "below 0.1 mm at 0.7 m, steps of 0.02 mm, range up to 1.3 m")
      ->transform(CLI::CheckedTransformer(option_names<Sensor>())
                      .description("{structured-light,time-of-flight,stereo,laser}"))
      ->default_str("structured-light")
      ->group(how);
  command
      ->add_option("--noise", options.sensor.noise,
                   "Noise, in that of the sensor; 0: none, but what is hidden stays hidden")
      ->capture_default_str()
      ->group(how);
  command
      ->add_option("--disparity-step", options.sensor.disparity_step_pixel,
                   "Tell depth in such steps of disparity [pixel], as sensors that match images "
                   "do: a Kinect 0.125. 0: not; without this option the sensor's own")
      ->group(how);
  command
      ->add_flag("--randomize", options.randomize,
                 "Draw anew for each scene how the sensor falls short of the ideal one, and where "
                 "it stands: windows that fatten outlines and fill recesses, noise that "
                 "neighbors share, holes on dark and bright surfaces, filters, an image that is "
                 "shifted, a camera and a depth scale that are written wrongly; focal length, "
                 "distance, the room behind. Each strength is drawn over what real sensors of "
                 "the kind show, and more. For all scenes together: images 640 or 848 pixels wide, "
                 "and objects that differ from their models in size, form and, where these have "
                 "one, by a lid that is off")
      ->group(how);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return scan(*arguments, context); };
  });
}

}  // namespace trivet::apps
