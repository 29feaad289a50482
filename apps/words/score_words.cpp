#include "apps/words/score_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/scoring/adapt_score.hpp"
#include "kernels/scoring/pose_score.hpp"

namespace trivet::apps {
namespace {

constexpr float kDegreesPerRadian = 57.29578F;
constexpr float kWorthWords = 1;  // of log odds: smaller losses are not mentioned
constexpr float kMinor = 0.4F;    // share of the largest loss: smaller ones are not mentioned
constexpr float kHardlyLower = 0.95F;

std::string percent(float share) {
  return share < 0.01F ? "less than 1 %" : fmt::format("{:.0f} %", 100 * std::min(share, 1.0F));
}

constexpr kernels::ScoreOffsets kOffsets = kernels::kScoreOffsets;

/// Each function inverts the logarithm of kernels::score_parts.
struct Entry {
  std::string_view name;  // from kernels::kScoreParts
  PartWords words;
  std::string (*finding)(float value);
};

constexpr std::array<Entry, 17> kEntries{{
    {"violation",
     {"looked through",
      "share of what is seen that the sensor looked through, or that is behind a table, a floor or "
      "a wall"},
     [](float v) {
       return "the sensor looked through " + percent(std::exp(v) - kOffsets.violation) +
              " of it, or saw a table, a floor or a wall before it";
     }},
    {"background",
     {"background", "share of what is seen that lies on a table, a floor or a wall"},
     [](float v) {
       return percent(std::exp(v) - kOffsets.background) +
              " of what is seen lies on a table, a floor or a wall";
     }},
    {"free",
     {"free", "share of its outline beyond which the scene falls back"},
     [](float v) { return "the scene falls back beyond only " + percent(v) + " of its outline"; }},
    {"crossed",
     {"outline", "share of its outline beyond which the scene runs on as if it were not there"},
     [](float v) {
       return "the scene runs on beyond " + percent(std::exp(v) - kOffsets.crossed) +
              " of its outline";
     }},
    {"touching",
     {"contact", "share of its outline beyond which something else touches"},
     [](float v) {
       return "something touches " + percent(std::exp(v) - kOffsets.touching) + " of its outline";
     }},
    {"buried",
     {"buried", "share of the edge of its seen part where it dips beneath a surface that runs on"},
     [](float v) {
       return percent(std::exp(v) - kOffsets.buried) +
              " of the edge of what is seen dips beneath a surface that runs on";
     }},
    {"residual",
     {"distance", "how far the measured surface is from the model's, in tolerances"},
     [](float v) {
       return fmt::format("its surface is {:.2f} tolerances off", std::sqrt(std::max(0.0F, v)));
     }},
    {"smooth",
     {"shape", "the same with noise averaged out: what is left is a difference in shape"},
     [](float v) {
       return fmt::format("its shape is {:.2f} tolerances off, noise left aside",
                          std::sqrt(std::max(0.0F, std::exp(v) - kOffsets.smooth)));
     }},
    {"slope",
     {"slope", "angle between the measured surface and the model's"},
     [](float v) {
       return fmt::format("its surface is inclined by {:.0f}° to the measured one",
                          kDegreesPerRadian * std::max(0.0F, std::exp(v) - kOffsets.slope));
     }},
    {"stability",
     {"stability", "how firmly the seen surface keeps the model from sliding and turning"},
     [](float) { return std::string("what is seen of it would let it slide or turn"); }},
    {"consistent",
     {"agreement", "share of its silhouette that was measured where the model says"},
     [](float v) {
       return "only " + percent(std::exp(v) - kOffsets.consistent) +
              " of its silhouette is measured where it should be";
     }},
    {"unknown",
     {"unmeasured", "share of its silhouette without a measurement"},
     [](float v) { return percent(v) + " of its silhouette was not measured"; }},
    {"pixels",
     {"pixels", "number of pixels that agree"},
     [](float v) {
       return fmt::format("only {:.0f} pixels agree", std::exp(v) - kOffsets.pixels);
     }},
    {"sunk",
     {"sunk", "share of it that lies just beneath the measured surface"},
     [](float v) {
       return percent(std::exp(v) - kOffsets.sunk) +
              " of it lies just beneath the measured surface";
     }},
    {"relief",
     {"relief", "how far what is seen of it is from a plane, in tolerances"},
     [](float v) {
       return fmt::format("what is seen of it is within {:.1f} tolerances of a plane",
                          std::max(0.0F, std::exp(v) - kOffsets.relief));
     }},
    {"coarseness",
     {"tolerance", "how far off a measurement may be and agree, in diameters"},
     [](float v) {
       return fmt::format("agreement is to {:.1f} % of the diameter only", 100 * std::exp(v));
     }},
    {"correlation",
     {"sensor",
      "how alike neighboring pixels err: 0, each for itself, to 1, as in matched windows"},
     [](float v) { return percent(v) + " of the scan's errors are shared by neighbors"; }},
}};

constexpr bool each_part_has_words() {
  for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k)
    if (kEntries[k].name != kernels::kScoreParts[k].name) return false;
  return true;
}
static_assert(kEntries.size() == kernels::kNumScoreParts && each_part_has_words(),
              "words for each part of the score, in the order of kScoreParts");

}  // namespace

std::string score_text(float score) {
  constexpr float kLeast = 0.001F;
  if (score < kLeast) return "< 0.001";
  return score > 1 - kLeast ? "> 0.999" : fmt::format("{:.3f}", score);
}

PartWords words_of(std::size_t part) { return kEntries[part].words; }

std::string finding_of(std::size_t part, float value) { return kEntries[part].finding(value); }

std::array<float, kernels::kNumScoreParts> most_evidence(const kernels::ScoreModel& model,
                                                         float correlation) {
  std::array<float, kernels::kNumScoreParts> most{};
  for (std::size_t k = 0; k < most.size(); ++k) {
    const auto [independent, shared] = kernels::most_evidence(model, k);
    most[k] = (1 - correlation) * independent + correlation * shared;
  }
  return most;
}

std::string costliest_findings(const kernels::ScoreModel& model, const kernels::ScoreParts& parts) {
  std::array<float, kernels::kNumScoreParts> cost =
      most_evidence(model, parts[kernels::kCorrelationPart]);
  for (std::size_t k = 0; k < cost.size(); ++k) cost[k] -= kernels::part_evidence(model, parts, k);
  std::array<std::size_t, kernels::kNumScoreParts> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cost[a] > cost[b]; });
  if (!(cost[order[0]] >= kWorthWords)) return "";
  std::string out = finding_of(order[0], parts[order[0]]);
  if (cost[order[1]] >= std::max(kWorthWords, kMinor * cost[order[0]]))
    out += "; " + finding_of(order[1], parts[order[1]]);
  return out;
}

float deduction(const kernels::ScoreModel& model, const kernels::ScoreParts& parts, float score) {
  constexpr double kLeast = 1e-6;  // beyond it the odds of a float are rounding errors
  const auto log_odds = [=](double p) {
    const double inside = std::clamp(p, kLeast, 1 - kLeast);
    return std::log(inside / (1 - inside));
  };
  const float alone = kernels::pose_probability(model, parts);
  return static_cast<float>(log_odds(static_cast<double>(score)) -
                            log_odds(static_cast<double>(alone)));
}

std::string lowered_from(const kernels::ScoreModel& model, const kernels::ScoreParts& parts,
                         float score) {
  const float alone = kernels::pose_probability(model, parts);
  return score < kHardlyLower * alone ? score_text(alone) + " but for other answers" : "";
}

}  // namespace trivet::apps
