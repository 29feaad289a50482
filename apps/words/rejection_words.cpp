#include "apps/words/rejection_words.hpp"

#include <fmt/format.h>

#include <initializer_list>

#include "apps/words/score_words.hpp"

namespace trivet::apps {
namespace {

/// The texts that are not empty, joined by semicolons.
std::string joined(std::initializer_list<std::string> texts) {
  std::string out;
  for (const std::string& text : texts) {
    if (!text.empty()) out += (out.empty() ? "" : "; ") + text;
  }
  return out;
}

/// "it would be 13 % of its diameter deep in a table, a floor or a wall".
std::string depth_words(const RejectedPose& rejected) {
  return fmt::format("it would be {:.0f} % of its diameter deep in a table, a floor or a wall",
                     100 * rejected.depth_in_ground);
}

/// "83 % of its pixels are explained by gear"; empty if no detection explains them.
std::string explanation(const SceneResult& result, const RejectedPose& rejected) {
  if (!rejected.explained_by) return "";
  return fmt::format("{:.0f} % of its pixels are explained by {}", 100 * rejected.explained_share,
                     result.detections[*rejected.explained_by].model);
}

}  // namespace

RejectionWords rejection_words(const SceneResult& result, const RejectedPose& rejected,
                               const kernels::ScoreModel& score, const RecognizeOptions& options) {
  switch (rejected.reason) {
    case Rejection::too_low: {
      const std::string below = fmt::format("below {}", options.min_score);
      if (rejected.depth_in_ground > 0)
        return {below, joined({depth_words(rejected), explanation(result, rejected)})};
      if (options.require_identity && !options.require_pose && rejected.score >= options.min_score)
        return {"this very model is " + below,
                joined({"the scan does not distinguish it from others of this place",
                        explanation(result, rejected)})};
      if (options.require_pose && rejected.score >= options.min_score)
        return {"this very pose is " + below,
                joined({"the scan does not distinguish it from others of this place",
                        explanation(result, rejected)})};
      return {below, joined({costliest_findings(score, rejected.parts),
                             lowered_from(score, rejected.parts, rejected.score),
                             explanation(result, rejected)})};
    }
    case Rejection::explained:
      return {"place taken", rejected.explained_by ? explanation(result, rejected)
                                                   : "by one that was one too many"};
    case Rejection::too_many:
      return {"one too many", fmt::format("{} of this model were asked for, and better ones found",
                                          options.max_instances)};
  }
  return {};
}

std::string cost_words(const Detection& detection, const kernels::ScoreModel& score) {
  return joined({costliest_findings(score, detection.parts),
                 lowered_from(score, detection.parts, detection.score)});
}

}  // namespace trivet::apps
