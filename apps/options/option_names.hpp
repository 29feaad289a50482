/// What the values of enumerations are called on the command line and in files of settings.
#pragma once

#include <map>
#include <string>

#include "engine/evaluation/degrade_scene.hpp"
#include "engine/recognize.hpp"
#include "engine/simulation/measure_scene.hpp"

namespace trivet::apps {

template <class Enum>
using OptionNames = std::map<std::string, Enum>;

template <class Enum>
const OptionNames<Enum>& option_names();

template <>
inline const OptionNames<Sensor>& option_names<Sensor>() {
  static const OptionNames<Sensor> names{{"structured-light", Sensor::structured_light},
                                         {"time-of-flight", Sensor::time_of_flight},
                                         {"stereo", Sensor::stereo},
                                         {"laser", Sensor::laser}};
  return names;
}

template <>
inline const OptionNames<Subsampler>& option_names<Subsampler>() {
  static const OptionNames<Subsampler> names{
      {"none", Subsampler::none},
      {"voxel-grid", Subsampler::voxel_grid},
      {"approximate-voxel-grid", Subsampler::approximate_voxel_grid},
      {"grid-minimum", Subsampler::grid_minimum},
      {"local-maximum", Subsampler::local_maximum}};
  return names;
}

template <>
inline const OptionNames<Method>& option_names<Method>() {
  static const OptionNames<Method> names = [] {
    OptionNames<Method> all;
    for (const MethodName& known : kMethods) all[std::string(known.name)] = known.method;
    return all;
  }();
  return names;
}

template <>
inline const OptionNames<Detector>& option_names<Detector>() {
  static const OptionNames<Detector> names{
      {"uniform", Detector::uniform}, {"iss", Detector::iss}, {"harris", Detector::harris}};
  return names;
}

template <>
inline const OptionNames<Grouping>& option_names<Grouping>() {
  static const OptionNames<Grouping> names{{"frames", Grouping::frames},
                                           {"consistency", Grouping::consistency},
                                           {"ransac", Grouping::ransac}};
  return names;
}

template <class Enum>
const std::string& option_name(Enum value) {
  for (const auto& [name, known] : option_names<Enum>()) {
    if (known == value) return name;
  }
  static const std::string none;
  return none;
}

}  // namespace trivet::apps
