#include <array>

#include "engine/options/declare_option.hpp"
#include "engine/simulation/render_scenes.hpp"

namespace trivet {
namespace {

constexpr std::array<Choice, 4> kSensors{{
    {"structured-light",
     "a projector 75 mm beside the camera casts shadows; noise as of a Kinect, 1.2 mm and more "
     "from 0.4 m on"},
    {"time-of-flight",
     "no shadows; noise grows with range, on dark and on grazing surfaces; pixels at depth edges "
     "float between the surfaces"},
    {"stereo",
     "a second camera 100 mm beside; noise grows with the square of depth, depth comes in steps of "
     "1/16 pixel of disparity"},
    {"laser",
     "a plane of light from 200 mm beside the camera; wide shadows, noise below 0.1 mm at 0.7 m, "
     "steps of 0.02 mm, range up to 1.3 m"},
}};

constexpr std::string_view kWhat = "What is in a scene", kHow = "How it is measured";

template <auto Path>
Option<ScanOptions> declare(const OptionInfo& info) {
  return engine::declare_option<ScanOptions, Path>(info);
}

}  // namespace

template <>
std::span<const Choice> choices_of<Sensor>() {
  return kSensors;
}

template <>
std::span<const Option<ScanOptions>> options_of<ScanOptions>() {
  static const std::array kOptions{
      declare<TRIVET_FIELD(num_scenes)>({.name = "scenes",
                                         .group = kWhat,
                                         .label = "scenes",
                                         .help = "Scenes to scan",
                                         .range = {1, 10000}}),
      declare<TRIVET_FIELD(num_instances)>({.name = "instances",
                                            .group = kWhat,
                                            .label = "objects of a scene",
                                            .help = "Objects of a scene",
                                            .range = {1, 200}}),
      declare<TRIVET_FIELD(of_a_kind)>(
          {.name = "of-a-kind",
           .group = kWhat,
           .label = "copies of a model side by side",
           .help = "So many copies of a model lie in a scene before the next model comes",
           .range = {1, 200}}),
      declare<TRIVET_FIELD(num_clutter)>(
          {.name = "clutter",
           .group = kWhat,
           .label = "unknown objects of a scene",
           .help = "So many other parts lie among the objects and are in no truth",
           .range = {0, 200}}),
      declare<TRIVET_FIELD(seed)>({.name = "seed",
                                   .group = kWhat,
                                   .label = "seed of the scenes",
                                   .help = "Other seeds give other scenes"}),
      declare<TRIVET_FIELD(deviation)>(
          {.name = "deviation",
           .group = kWhat,
           .label = "deviation of the objects from their models",
           .unit = "diameters",
           .help = "The objects differ from their models by smooth deviations, root mean square of "
                   "so many diameters, as printed, cast and scanned ones do; 0.005 is usual",
           .range = {0, 0.05}}),
      declare<TRIVET_FIELD(bin)>(
          {.name = "bin",
           .group = kWhat,
           .label = "in an open box",
           .help = "Drop the objects into an open box; else onto a table. The camera then looks "
                   "down more steeply"}),
      declare<TRIVET_FIELD(walls)>(
          {.name = "walls",
           .group = kWhat,
           .label = "walls behind the objects",
           .help = "A corner of two walls stands behind the objects, as large planes"}),
      declare<TRIVET_FIELD(sensor.sensor)>(
          {.name = "sensor", .group = kHow, .label = "sensor", .help = "What measures"}),
      declare<TRIVET_FIELD(sensor.noise)>(
          {.name = "noise",
           .group = kHow,
           .label = "noise of the sensor, in its own",
           .help = "Noise, in that of the sensor; 0: none, but what is hidden stays hidden",
           .range = {0, 10}}),
      declare<TRIVET_FIELD(sensor.disparity_step_pixel)>(
          {.name = "disparity-step",
           .group = kHow,
           .label = "steps of disparity",
           .unit = "pixel",
           .help = "Measure depth in such steps of disparity, as sensors that match images do: a "
                   "Kinect 0.125; 0: not",
           .unset_help = "the sensor's own",
           .range = {0, 8}}),
      declare<TRIVET_FIELD(resolution)>(
          {.name = "resolution",
           .group = kHow,
           .label = "resolution of the image",
           .help = "Pixels along each side of the image, in those of a camera of 640 x 480 with "
                   "the same view: 0.5 is 320 x 240",
           .range = {0.25, 4}}),
      declare<TRIVET_FIELD(randomize)>(
          {.name = "randomize",
           .group = kHow,
           .label = "sensors and places drawn again for each scene",
           .help = "Draw for each scene how the sensor falls short of the ideal one, and "
                   "where it stands: windows that fatten outlines and fill recesses, noise that "
                   "neighbors share, holes on dark and bright surfaces, filters, an image that is "
                   "shifted, a camera and a depth scale that are written wrongly; focal length, "
                   "distance, the room behind. Each strength is drawn over what real sensors of "
                   "the kind show, and more. For all scenes together: images 640 or 848 pixels "
                   "wide, and objects that differ from their models in size, form and, where "
                   "these have one, by a lid that is off",
           .place = OptionPlace::not_in_studies}),
  };
  return kOptions;
}

Result<void> validate(const ScanOptions& options) { return check_options(options); }

}  // namespace trivet
