#include "engine/evaluation/average_precision.hpp"

#include <algorithm>
#include <functional>

namespace trivet::engine {

double average_precision(std::vector<ScoredMatch>& matches, std::size_t num_targets) {
  constexpr int kLastPlace = 100;
  if (num_targets == 0) return 0;
  std::ranges::stable_sort(matches, std::greater(), &ScoredMatch::score);

  std::size_t num_found =
      static_cast<std::size_t>(std::ranges::count(matches, true, &ScoredMatch::found));
  // Recall falls from the last match to the first; each place receives the best precision so far.
  int place = kLastPlace;
  double sum = 0, best = 0;
  const auto settle = [&](double recall_before) {  // places that only the matches so far reach
    for (; place >= 0; --place) {
      const double at = place == kLastPlace ? 1 : place * 0.01;
      if (at <= recall_before) return;
      sum += best;
    }
  };
  for (std::size_t n = matches.size(); n > 0; --n) {
    settle(static_cast<double>(num_found) / static_cast<double>(num_targets));
    best = std::max(best, static_cast<double>(num_found) / static_cast<double>(n));
    if (matches[n - 1].found) --num_found;
  }
  settle(-1);
  return sum / (kLastPlace + 1);
}

}  // namespace trivet::engine
