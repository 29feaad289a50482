#include "engine/recognition/search_budget.hpp"

#include <algorithm>
#include <cmath>

namespace trivet::engine {
namespace {

// Searching for each of so many models on its own costs about what the budget allows.
constexpr std::size_t kSmallLibrary = 30;

}  // namespace

std::optional<SearchBudget> budget_of(const RecognizeOptions& options, const Library& library,
                                      std::size_t num_models) {
  const bool indexed = library.basis.components.size() > 0;
  if (options.search == Search::exhaustive || options.method == Method::ppf || !indexed ||
      num_models <= kSmallLibrary)
    return std::nullopt;
  SearchBudget budget;
  const auto scaled = [&](std::size_t count) {
    return std::max<std::size_t>(
        1, static_cast<std::size_t>(
               std::llround(static_cast<double>(count) * static_cast<double>(options.budget))));
  };
  budget.poses = {scaled(budget.poses.looked_at), scaled(budget.poses.refined),
                  scaled(budget.poses.examined)};
  budget.voted_models = scaled(budget.voted_models);
  return budget;
}

}  // namespace trivet::engine
