#include "engine/loaded_library/find_look_alikes.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/common/checked_parts.hpp"
#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

constexpr float kSpreadAlike = 0.06F;      // difference of the standard deviations [diameters]
constexpr std::size_t kMostCompared = 60;  // number of models with the most similar spread
constexpr std::size_t kMostLookAlikes = 40;

/// Other models, sorted by the difference of their spread from this one's.
std::vector<std::uint32_t> spread_alike(std::span<const kernels::ShapeFrame> frames,
                                        std::uint32_t model, float diameter) {
  std::vector<std::pair<float, std::uint32_t>> near;
  for (std::uint32_t m = 0; m < frames.size(); ++m) {
    const float difference = (frames[m].deviations - frames[model].deviations).norm() / diameter;
    if (m != model && difference < kSpreadAlike) near.emplace_back(difference, m);
  }
  std::ranges::sort(near);
  near.resize(std::min(near.size(), kMostCompared));
  std::vector<std::uint32_t> models;
  models.reserve(near.size());
  for (const auto& [difference, m] : near) models.push_back(m);
  return models;
}

}  // namespace

Result<std::vector<kernels::ShapeFrame>> shape_frames(const Library& library) {
  std::vector<std::uint32_t> all(library.models.size());
  std::iota(all.begin(), all.end(), 0U);
  TRIVET_TRY_ASSIGN(const std::vector<const ModelSamples*> models, samples_of(library, all));
  std::vector<kernels::ShapeFrame> frames(all.size());
  for_each_index(all.size(),
                 [&](std::size_t m) { frames[m] = kernels::shape_frame(models[m]->samples); });
  return frames;
}

Result<std::vector<LookAlike>> find_look_alikes(const Library& library,
                                                std::span<const kernels::ShapeFrame> frames,
                                                std::uint32_t model) {
  const float diameter = library.models[model].diameter;
  TRIVET_TRY_ASSIGN(const ModelSamples* const own, library.samples(model));
  const kernels::ShapeAligner aligner(own->samples, own->sample_normals, frames[model], diameter);
  std::vector<std::pair<float, LookAlike>> found;
  for (const std::uint32_t m : spread_alike(frames, model, diameter)) {
    check_stop();
    TRIVET_TRY_ASSIGN(const ModelSamples* const other, library.samples(m));
    for (const auto& [T_this_other, distance] : aligner.align(other->samples, frames[m]))
      found.emplace_back(distance, LookAlike{m, T_this_other});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  found.resize(std::min(found.size(), kMostLookAlikes));
  std::vector<LookAlike> look_alikes;
  look_alikes.reserve(found.size());
  for (const auto& [distance, look_alike] : found) look_alikes.push_back(look_alike);
  return look_alikes;
}

Result<std::vector<NearCopy>> find_near_copies(const Library& library,
                                               std::span<const LookAlike> look_alikes,
                                               std::uint32_t model) {
  TRIVET_TRY_ASSIGN(const kernels::ModelSamples own, kernel_samples(library, model));
  std::vector<kernels::ModelSamples> others;
  for (const LookAlike& like : look_alikes) {
    TRIVET_TRY_ASSIGN(const kernels::ModelSamples other, kernel_samples(library, like.model));
    others.push_back(other);
  }
  std::vector<NearCopy> copies(look_alikes.size());
  for_each_index(look_alikes.size(), [&](std::size_t k) {
    const LookAlike& like = look_alikes[k];
    const kernels::RefinedAlignment found = kernels::refine_alignment(
        own, others[k], coinciding_distance(own.diameter), like.T_model_other);
    copies[k] = {like.model, found.T_this_other, found.agreeing};
  });
  std::erase_if(copies, [](const NearCopy& copy) { return copy.agreeing < kCoinciding; });
  std::ranges::stable_sort(copies, std::ranges::greater(), &NearCopy::agreeing);
  return copies;
}

}  // namespace trivet::engine
