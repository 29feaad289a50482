#include <array>

#include "engine/evaluation/degrade_scene.hpp"
#include "engine/options/declare_option.hpp"

namespace trivet {
namespace {

constexpr std::array<Choice, 5> kSubsamplers{
    {{"none"}, {"voxel-grid"}, {"approximate-voxel-grid"}, {"grid-minimum"}, {"local-maximum"}}};
constexpr std::string_view kGroup = "What is done to a scan";

template <auto Path>
Option<DegradeOptions> declare(const OptionInfo& info) {
  return engine::declare_option<DegradeOptions, Path>(info);
}

}  // namespace

template <>
std::span<const Choice> choices_of<Subsampler>() {
  return kSubsamplers;
}

template <>
std::span<const Option<DegradeOptions>> options_of<DegradeOptions>() {
  static const std::array kOptions{
      declare<TRIVET_FIELD(scattered)>({.name = "scattered",
                                        .group = kGroup,
                                        .label = "without the pixel grid",
                                        .help = "Take the pixel grid away"}),
      declare<TRIVET_FIELD(noise)>({.name = "noise",
                                    .group = kGroup,
                                    .label = "Gaussian noise",
                                    .unit = "resolution of the scan",
                                    .help = "Of x, y and z each",
                                    .range = {0, 10}}),
      declare<TRIVET_FIELD(noise_diameters)>({.name = "noise-diameters",
                                              .group = kGroup,
                                              .label = "Gaussian noise",
                                              .unit = "mean diameter",
                                              .help = "Of x, y and z each",
                                              .range = {0, 1}}),
      declare<TRIVET_FIELD(ray_noise)>({.name = "ray-noise",
                                        .group = kGroup,
                                        .label = "noise along the viewing ray",
                                        .unit = "resolution of the scan",
                                        .help = "Along the line of sight",
                                        .range = {0, 10}}),
      declare<TRIVET_FIELD(shot_noise)>({.name = "shot-noise",
                                         .group = kGroup,
                                         .label = "share of stray points",
                                         .help = "Points that land anywhere in the scan's box",
                                         .range = {0, 1}}),
      declare<TRIVET_FIELD(keep)>({.name = "keep",
                                   .group = kGroup,
                                   .label = "share of the points that is kept",
                                   .help = "Share of the points that stay",
                                   .range = {0, 1, true}}),
      declare<TRIVET_FIELD(subsampler)>({.name = "subsampler",
                                         .group = kGroup,
                                         .label = "subsampler",
                                         .help = "How points become fewer"}),
      declare<TRIVET_FIELD(cell)>({.name = "cell",
                                   .group = kGroup,
                                   .label = "cell of the subsampler",
                                   .unit = "mean diameter",
                                   .help = "Cell or radius of the subsampler",
                                   .range = {0, 1, true}}),
  };
  return kOptions;
}

Result<void> validate(const DegradeOptions& options) { return check_options(options); }

}  // namespace trivet
