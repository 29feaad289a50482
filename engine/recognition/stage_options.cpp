#include "engine/recognition/stage_options.hpp"

namespace trivet::engine {

PrepareOptions prepare_options(const RecognizeOptions& options) {
  return {.normal_window = options.normal_window,
          .correlated_noise = !options.ablated.contains(Improvement::correlated_noise)};
}

LargePlanes large_planes(const RecognizeOptions& options) {
  return options.ablated.contains(Improvement::planes) ? LargePlanes::kept : LargePlanes::left_out;
}

SettleOptions settle_options(const RecognizeOptions& options) {
  const auto has = [&](Improvement improvement) { return !options.ablated.contains(improvement); };
  return {.pose = options.pose,
          .test = {.verify = options.verify,
                   .limits = options.limits,
                   .refinement = has(Improvement::refinement),
                   .background = has(Improvement::background)},
          .visibility = has(Improvement::visibility),
          .contour = has(Improvement::contour),
          .rays = has(Improvement::rays)};
}

SelectOptions select_options(const RecognizeOptions& options) {
  return {.min_score = options.min_score,
          .doubtful_score = options.doubtful_score,
          .max_instances = options.max_instances,
          .max_overlap = options.verify.max_overlap,
          .by_pixels = !options.ablated.contains(Improvement::explained)};
}

bool compares_alternatives(const RecognizeOptions& options) {
  return !options.ablated.contains(Improvement::alternatives);
}

}  // namespace trivet::engine
