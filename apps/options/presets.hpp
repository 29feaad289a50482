/// Named settings: fast, balanced, accurate.
#pragma once

#include <map>
#include <string>

#include "engine/recognize.hpp"
#include "engine/train.hpp"

namespace trivet::apps {

inline const std::map<std::string, TrainOptions>& train_presets() {
  static const std::map<std::string, TrainOptions> presets{
      {"fast", {.relative_step = 0.05F}}, {"balanced", {}}, {"accurate", {.relative_step = 0.03F}}};
  return presets;
}

inline const std::map<std::string, RecognizeOptions>& recognize_presets() {
  static const std::map<std::string, RecognizeOptions> presets{
      {"fast",
       {.vote = {.reference_share = 0.05F},
        .later = {.radius = 0.7F, .reference_share = 0.1F, .max_votes = 60000},
        .pose = {.max_clusters = 200, .max_refined = 20, .max_examined = 10}}},
      {"balanced", {}},
      {"accurate",
       {.vote = {.reference_share = 0.3F, .max_references = 10000},
        .later =
            {.radius = 0.7F, .reference_share = 0.4F, .max_references = 10000, .max_votes = 60000},
        .pose = {.max_clusters = 600, .max_refined = 160, .max_examined = 40}}}};
  return presets;
}

}  // namespace trivet::apps
