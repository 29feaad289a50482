#include "engine/common/check_models.hpp"

#include <vector>

#include "engine/common/parallel.hpp"

namespace trivet::engine {

Result<void> check_models(const Library& library, std::span<const std::uint32_t> models,
                          ModelPart part) {
  for (const std::uint32_t m : models) library.ask_for(m, part);
  std::vector<Result<void>> results(models.size());
  for_each_index(models.size(),
                 [&](std::size_t k) { results[k] = library.check(models[k], part); });
  for (const Result<void>& result : results) {
    if (!result) return result;
  }
  return {};
}

}  // namespace trivet::engine
