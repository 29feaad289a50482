#include "engine/common/checked_parts.hpp"

#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

/// part  requested ahead
/// get   member of Library that gives it
template <class Part>
Result<std::vector<const Part*>> parts_of(const Library& library,
                                          std::span<const std::uint32_t> models, ModelPart part,
                                          Result<const Part*> (Library::*get)(std::uint32_t)
                                              const) {
  for (const std::uint32_t m : models) library.ask_for(m, part);
  std::vector<const Part*> parts(models.size());
  std::vector<Result<void>> results(models.size());
  for_each_index(models.size(), [&](std::size_t k) {
    const Result<const Part*> found = (library.*get)(models[k]);
    if (found) {
      parts[k] = *found;
    } else {
      results[k] = found.error();
    }
  });
  for (const Result<void>& result : results) {
    if (!result) return result.error();
  }
  return parts;
}

}  // namespace

Result<std::vector<const ModelSamples*>> samples_of(const Library& library,
                                                    std::span<const std::uint32_t> models) {
  return parts_of(library, models, ModelPart::samples, &Library::samples);
}

Result<std::vector<const ModelPairs*>> pairs_of(const Library& library,
                                                std::span<const std::uint32_t> models) {
  return parts_of(library, models, ModelPart::pairs, &Library::pairs);
}

Result<kernels::ModelSamples> kernel_samples(const Library& library, std::uint32_t model) {
  TRIVET_TRY_ASSIGN(const ModelSamples* const own, library.samples(model));
  const ModelInfo& info = library.models[model];
  return kernels::ModelSamples{own->samples,        own->sample_normals, own->sample_views,
                               info.sample_spacing, info.diameter,       info.center};
}

}  // namespace trivet::engine
