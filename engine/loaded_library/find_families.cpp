#include "engine/loaded_library/find_families.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "engine/common/checked_parts.hpp"
#include "engine/common/parallel.hpp"
#include "engine/loaded_library/find_look_alikes.hpp"

namespace trivet {
namespace {

/// For each pair of models, the pose in which their surfaces differ least.
using ClosestPairs = std::map<std::pair<std::uint32_t, std::uint32_t>, FamilyPair>;

Result<std::vector<FamilyPair>> near_pairs_of(const Recognizer& recognizer, std::uint32_t model) {
  const Library& library = recognizer.library();
  TRIVET_TRY_ASSIGN(const std::vector<engine::NearCopy>* const copies,
                    recognizer.near_copies(model));
  TRIVET_TRY_ASSIGN(const kernels::ModelSamples own, engine::kernel_samples(library, model));
  std::vector<FamilyPair> pairs;
  for (const engine::NearCopy& copy : *copies) {
    check_stop();
    TRIVET_TRY_ASSIGN(const kernels::ModelSamples other,
                      engine::kernel_samples(library, copy.model));
    const bool is_first = model < copy.model;
    const Pose T = is_first ? copy.T_model_other : copy.T_model_other.inverse();
    const kernels::RefinedAlignment back = kernels::refine_alignment(
        other, own, engine::coinciding_distance(other.diameter), copy.T_model_other.inverse());
    const float agreeing = std::min(copy.agreeing, back.agreeing);
    if (agreeing < kFamilyAgreement) continue;
    pairs.push_back({std::min(model, copy.model), std::max(model, copy.model), T, agreeing,
                     is_first ? kernels::find_difference(own, other, T)
                              : kernels::find_difference(other, own, T)});
  }
  return pairs;
}

/// The representative of a model's group, in a forest of models.
std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t model) {
  while (parents[model] != model) model = parents[model] = parents[parents[model]];
  return model;
}

}  // namespace

Result<std::vector<Family>> find_families(const Recognizer& recognizer,
                                          const std::optional<float>& deviation) {
  const Library& library = recognizer.library();
  const std::size_t n = library.models.size();
  std::vector<Result<std::vector<FamilyPair>>> found(n, std::vector<FamilyPair>{});
  engine::for_each_index(n, [&](std::size_t m) {
    found[m] = near_pairs_of(recognizer, static_cast<std::uint32_t>(m));
  });
  ClosestPairs closest;
  for (const Result<std::vector<FamilyPair>>& pairs : found) {
    if (!pairs) return pairs.error();
    for (const FamilyPair& pair : *pairs) {
      const auto [at, is_new] = closest.try_emplace({pair.first, pair.second}, pair);
      if (pair.difference.deviation < at->second.difference.deviation) at->second = pair;
    }
  }
  std::erase_if(closest, [&](const auto& entry) {
    return deviation && entry.second.difference.deviation > *deviation;
  });

  std::vector<std::uint32_t> parents(n);
  std::iota(parents.begin(), parents.end(), 0U);
  for (const auto& [models, pair] : closest) {
    const std::uint32_t a = root_of(parents, pair.first), b = root_of(parents, pair.second);
    parents[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::uint32_t, Family> families;  // keyed by the first model
  for (std::uint32_t m = 0; m < n; ++m) families[root_of(parents, m)].models.push_back(m);
  for (const auto& [models, pair] : closest)
    families[root_of(parents, pair.first)].pairs.push_back(pair);
  std::vector<Family> out;
  for (auto& [first, family] : families) {
    if (family.models.size() > 1) out.push_back(std::move(family));
  }
  return out;
}

}  // namespace trivet
