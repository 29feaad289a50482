/// What the values of enumerations are called on the command line and in files of settings.
#pragma once

#include <string>

#include "engine/option.hpp"

namespace trivet::apps {

template <class Enum>
std::string option_name(Enum value) {
  return std::string(choice_name(value));
}

}  // namespace trivet::apps
