#include "apps/words/explanation_words.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "apps/words/rejection_words.hpp"
#include "apps/words/score_words.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

/// The last stage that the poses reached before the search discarded them.
std::string giving_up(const ModelExplanation& explanation, const PoseOptions& limits) {
  switch (*explanation.reached()) {
    case PoseStage::proposed:
      return fmt::format(
          "{} of it {} proposed here, but others had more votes: {} clusters are looked at "
          "(max-clusters)",
          counted(explanation.num_poses[0], "pose"), explanation.num_poses[0] == 1 ? "was" : "were",
          limits.max_clusters);
    case PoseStage::screened:
      return fmt::format(
          "was looked at here, but other poses of it looked better at first sight: {} are refined "
          "(max-refined)",
          limits.max_refined);
    default:
      return fmt::format(
          "was refined here, but other poses of it fit better: {} are tested by rays "
          "(max-examined)",
          limits.max_examined);
  }
}

}  // namespace

std::string explanation_words(const SceneResult& result, const ModelExplanation& explanation,
                              const kernels::ScoreModel& score, const RecognizeOptions& options) {
  if (explanation.detection) {
    const Detection& detection = result.detections[*explanation.detection];
    const std::string cost = cost_words(detection, score);
    return fmt::format("is found here with a score of {}{}", score_text(detection.score),
                       cost.empty() ? cost : ": " + cost);
  }
  if (!explanation.reached())
    return "no pose of it was proposed here: too little of its shape is seen";
  if (!explanation.given_up && !explanation.pose)
    return "came near, but its poses moved elsewhere when they were refined";
  if (!explanation.given_up) {
    return fmt::format("was tested by rays here and has a score of {}: {}",
                       score_text(explanation.pose->score),
                       rejection_words(result, *explanation.pose, score, options).text());
  }
  const std::string why = giving_up(explanation, options.pose);
  if (!explanation.pose) return why + "; tested after all, it moves elsewhere";
  const float tested = explanation.pose->score;
  if (tested >= options.min_score)
    return fmt::format("{}; tested after all, it has a score of {}: more effort finds it", why,
                       score_text(tested));
  return fmt::format("{}; tested after all, it has a score of {}: {}", why, score_text(tested),
                     rejection_words(result, *explanation.pose, score, options).text());
}

std::string stage_words(const ModelExplanation& explanation) {
  constexpr std::array<std::string_view, kNumPoseStages> kWords{"proposed", "looked at", "refined",
                                                                "tested by rays"};
  std::string text;
  for (std::size_t k = 0; k < kNumPoseStages; ++k) {
    const std::size_t num = explanation.num_poses[k];
    text += fmt::format("{}{} {}", k == 0 ? "" : ", ", num == 0 ? "none" : std::to_string(num),
                        kWords[k]);
  }
  return text;
}

std::string explanation_text(const SceneResult& result, const kernels::ScoreModel& score,
                             const RecognizeOptions& options) {
  if (!result.explanation) return {};
  const PlaceExplanation& place = *result.explanation;
  std::string text =
      fmt::format("  at {:.6g}, {:.6g}, {:.6g} (nearest point of the scan: {:.3g} away):\n",
                  place.point.x(), place.point.y(), place.point.z(), place.nearest_point);
  if (place.models.empty()) text += "    nothing was proposed here\n";
  for (const ModelExplanation& of : place.models)
    text += fmt::format("    {} {}\n", of.model, explanation_words(result, of, score, options));
  return text;
}

}  // namespace trivet::apps
