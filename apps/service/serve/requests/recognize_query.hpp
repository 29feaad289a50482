/// What a client may ask of a recognition: the options of `trivet recognize`, and how its scan is
/// to be read.
#pragma once

#include "apps/service/http/query.hpp"
#include "apps/service/serve/requests/served_scene.hpp"
#include "engine/options/recognize_options.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct RecognizeQuery {
  RecognizeOptions options;
  ServedScene scene;
};

/// The preset with the options of a recognition and of the scan in its place, each given once.
/// Errors: usage.
Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters);

/// What the parameter `preset` may be.
const OptionInfo& preset_parameter();

}  // namespace trivet::apps::service
