#include "engine/options/train_options.hpp"

#include <algorithm>
#include <array>

#include "engine/options/declare_option.hpp"

namespace trivet {
namespace {

constexpr std::string_view kSurface = "Surface", kPairs = "Point pairs",
                           kFeatures = "Tri-Spin-Images";
constexpr std::array<Choice, 2> kTrainedMethods{
    {{"ppf", "point pairs"}, {"trisi", "Tri-Spin-Images"}}};

/// Two fields that together form one option, a list of names.
Option<TrainOptions> methods() {
  return {{.name = "methods",
           .group = kSurface,
           .label = "methods that are trained for",
           .help = "What to train for",
           .place = OptionPlace::not_in_studies,
           .kind = OptionKind::names,
           .choices = kTrainedMethods},
          [](const TrainOptions& options) {
            std::vector<std::string> names;
            if (options.point_pairs) names.emplace_back("ppf");
            if (options.tri_spin_images) names.emplace_back("trisi");
            return OptionValue(names);
          },
          [](TrainOptions& options, const OptionValue& value) {
            const auto& names = std::get<std::vector<std::string>>(value);
            options.point_pairs = std::ranges::find(names, "ppf") != names.end();
            options.tri_spin_images = std::ranges::find(names, "trisi") != names.end();
          }};
}

template <auto Path>
Option<TrainOptions> declare_training(const OptionInfo& info) {
  return engine::declare_option<TrainOptions, Path>(info);
}

}  // namespace

template <>
std::span<const Option<TrainOptions>> options_of<TrainOptions>() {
  static const std::array kOptions{
      methods(),
      declare_training<TRIVET_FIELD(num_samples)>(
          {.name = "samples",
           .group = kSurface,
           .label = "samples of the surface",
           .help = "Points of the surface that poses are refined and verified by",
           .range = {256, 1 << 20}}),
      declare_training<TRIVET_FIELD(relative_step)>(
          {.name = "relative-step",
           .group = kPairs,
           .label = "sampling rate tau_d",
           .unit = "diameter",
           .help = "Distance between sampled points; smaller finds more, slower; overrides the "
                   "preset",
           .range = {0.01, 0.2}}),
      declare_training<TRIVET_FIELD(reference_spacing)>(
          {.name = "reference-spacing",
           .group = kPairs,
           .label = "spacing of the model's reference points",
           .unit = "steps",
           .help = "Distance between the points that pairs start at, 0 for every point; larger is "
                   "faster and finds a little less",
           .range = {0, 5}}),
      declare_training<TRIVET_FIELD(num_angle_bins)>(
          {.name = "angle-bins",
           .group = kPairs,
           .label = "bins over 180° of a pair's angles",
           .help = "Bins over 180 degrees of a pair's angles",
           .range = {6, 60}}),
      declare_training<TRIVET_FIELD(normal_cluster_angle_deg)>(
          {.name = "normal-cluster-angle",
           .group = kPairs,
           .label = "angle between normals that stay apart",
           .unit = "°",
           .help = "Sampled points of one voxel stay apart where their normals differ more",
           .range = {0, 180, true}}),
      declare_training<TRIVET_FIELD(num_components)>(
          {.name = "components",
           .group = kFeatures,
           .label = "principal components",
           .help = "Principal components that are kept at most",
           .range = {1, kMostComponents}}),
      declare_training<TRIVET_FIELD(component_energy)>(
          {.name = "component-energy",
           .group = kFeatures,
           .label = "share of the variance in the components",
           .help = "Fewer components are kept where they have this share of the variance",
           .range = {0, 1, true}}),
  };
  return kOptions;
}

Result<void> validate(const TrainOptions& options) {
  TRIVET_TRY(check_options(options));
  if (!options.point_pairs && !options.tri_spin_images)
    return Error{ErrorCode::usage, "methods: expected at least one, found none"};
  return {};
}

}  // namespace trivet
