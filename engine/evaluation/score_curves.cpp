#include "engine/evaluation/score_curves.hpp"

#include <algorithm>
#include <cmath>

namespace trivet {
namespace {

constexpr std::size_t kBins = 10;

double ratio(std::size_t part, std::size_t total) noexcept {
  return total == 0 ? 0 : static_cast<double>(part) / static_cast<double>(total);
}

}  // namespace

double OperatingPoint::f1() const noexcept {
  return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

PrecisionRecall precision_recall(std::span<const ScoredOutcome> outcomes, std::size_t instances) {
  std::vector<ScoredOutcome> falling(outcomes.begin(), outcomes.end());
  std::stable_sort(
      falling.begin(), falling.end(),
      [](const ScoredOutcome& a, const ScoredOutcome& b) { return a.score > b.score; });
  PrecisionRecall out;
  std::size_t right = 0;
  for (std::size_t i = 0; i < falling.size(); ++i) {
    right += falling[i].right ? 1 : 0;
    // A threshold includes all equal scores.
    if (i + 1 < falling.size() && falling[i + 1].score == falling[i].score) continue;
    const OperatingPoint point{falling[i].score, ratio(right, i + 1), ratio(right, instances)};
    if (!out.best_f1 || point.f1() > out.best_f1->f1()) out.best_f1 = point;
    out.points.push_back(point);
  }
  double best_precision = 0;
  for (std::size_t i = out.points.size(); i-- > 0;) {
    best_precision = std::max(best_precision, out.points[i].precision);
    const double recall_before = i == 0 ? 0 : out.points[i - 1].recall;
    out.average_precision += (out.points[i].recall - recall_before) * best_precision;
  }
  return out;
}

std::optional<Calibration> calibrate(std::span<const ScoredOutcome> outcomes) {
  if (outcomes.empty()) return std::nullopt;
  Calibration out;
  for (std::size_t b = 0; b < kBins; ++b)
    out.bins.push_back({ratio(b, kBins), ratio(b + 1, kBins), 0, 0, 0});
  for (const ScoredOutcome& outcome : outcomes) {
    if (!(outcome.score >= 0 && outcome.score <= 1)) return std::nullopt;
    const auto bin = static_cast<std::size_t>(outcome.score * kBins);
    CalibrationBin& own = out.bins[std::min(bin, kBins - 1)];
    ++own.all;
    own.right += outcome.right ? 1 : 0;
    own.mean_score += outcome.score;
  }
  for (CalibrationBin& bin : out.bins) {
    if (bin.all == 0) continue;
    bin.mean_score /= static_cast<double>(bin.all);
    out.expected_error +=
        ratio(bin.all, outcomes.size()) * std::abs(bin.mean_score - ratio(bin.right, bin.all));
  }
  return out;
}

std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) noexcept {
  if (trials == 0) return {0, 1};
  constexpr double z = 1.959963984540054;
  const auto n = static_cast<double>(trials);
  const double p = static_cast<double>(successes) / n;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  // At the ends the bound is exact, and rounding must not change it.
  return {successes == 0 ? 0 : middle - half, successes == trials ? 1 : middle + half};
}

}  // namespace trivet
