/// Parameters of a recognition request: the options of `trivet recognize`, and how the scan is
/// read.
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

/// The preset, overridden by the options of the recognition and of the scan. Each may be given
/// once. Errors: usage.
Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters);

/// The values of the parameter `preset`.
const OptionInfo& preset_parameter();

}  // namespace trivet::apps::service
