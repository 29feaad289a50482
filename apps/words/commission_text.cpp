#include "apps/words/commission_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/words/score_words.hpp"
#include "engine/evaluation/score_curves.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

constexpr float kLeastReportedChange = 0.05F;  // smallest reported change of a weight
constexpr std::size_t kReportedMarks = 5;
constexpr float kSure = 0.9F, kHopeless = 0.1F;  // scores that marks contradict

std::string changed_weights(const kernels::ScoreAdaptation& adaptation, bool more) {
  std::vector<std::size_t> parts;
  for (std::size_t k = 0; k < adaptation.weights.size(); ++k) {
    const float change = adaptation.weights[k] - 1;
    if ((more ? change : -change) >= kLeastReportedChange) parts.push_back(k);
  }
  std::ranges::stable_sort(parts, std::ranges::greater{},
                           [&](std::size_t k) { return std::abs(adaptation.weights[k] - 1); });
  std::string text;
  for (const std::size_t k : parts) {
    text += fmt::format("{}{} (x {:.2f})", text.empty() ? "" : ", ", words_of(k).label,
                        adaptation.weights[k]);
  }
  return text.empty() ? "nothing" : text;
}

std::string comparison(const Commissioning& found, float least) {
  const ScoreTally &was = found.before, &is = found.after;
  std::string text = "each scan scored by what the others say:      before   after\n";
  text += fmt::format("  right ones with a score of {:.2g} or more     {:8}{:8}   of {}\n", least,
                      was.right, is.right, found.num_right);
  text += fmt::format("  wrong ones with a score of {:.2g} or more     {:8}{:8}   of {}\n", least,
                      was.wrong, is.wrong, found.num_wrong);
  return text + fmt::format("  log loss, the smaller the better          {:8.3f}{:8.3f}\n",
                            was.log_loss, is.log_loss);
}

std::string trust(const Commissioning& found, std::size_t num_scans) {
  const std::size_t reported = found.after.right + found.after.wrong;
  const auto [low, high] = wilson_interval(found.after.right, reported);
  return fmt::format(
      "believe it as far as {} show: {} of {} reported detections are right, with 95 % "
      "certainty {:.0f} to {:.0f} %\n",
      counted(num_scans, "scan"), found.after.right, reported, 100 * low, 100 * high);
}

}  // namespace

std::string commission_text(const Commissioning& found, const Outcomes& outcomes, float least) {
  std::string text =
      fmt::format("{} with {} right and {} wrong detections\n",
                  counted(outcomes.scans.size(), "scan"), found.num_right, found.num_wrong);
  if (!found.helps()) {
    return text +
           "no change of the score is better for the scans that it was not made from: it stays as "
           "it is; more scans may show more\n";
  }
  text += comparison(found, least);
  text += fmt::format(
      "now reported: {} more right and no wrong ones; no longer: {} right and {} wrong ones\n",
      found.right_gained, found.right_lost, found.wrong_lost);
  text += fmt::format("counts for less: {}\n", changed_weights(found.adaptation, false));
  text += fmt::format("counts for more: {}\n", changed_weights(found.adaptation, true));
  text += fmt::format("all odds x {:.2f}; {:.0f} % of what the scans alone would have it\n",
                      std::exp(found.adaptation.shift), 100 * found.share);
  return text + trust(found, outcomes.scans.size());
}

std::string doubtful_marks(const kernels::ScoreModel& model, const Outcomes& outcomes) {
  struct Mark {
    std::size_t row;
    float score, contradiction;
  };
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < outcomes.right.size(); ++i) {
    const float score = kernels::pose_probability(model, outcomes.parts[i]);
    const bool right = outcomes.right[i] != 0;
    if (right ? score <= kHopeless : score >= kSure)
      marks.push_back({i, score, right ? 1 - score : score});
  }
  std::ranges::stable_sort(marks, std::ranges::greater{}, &Mark::contradiction);
  if (marks.size() > kReportedMarks) marks.resize(kReportedMarks);
  std::string text;
  for (const Mark& mark : marks) {
    text += fmt::format("  {}: marked {}, scored {:.3f}\n", outcomes.scans[outcomes.scan[mark.row]],
                        outcomes.right[mark.row] != 0 ? "right" : "wrong", mark.score);
  }
  return text.empty() ? text : "check whether these are marked correctly:\n" + text;
}

}  // namespace trivet::apps
