#include "engine/feature_library.hpp"

#include <algorithm>
#include <map>

#include "engine/parallel.hpp"
#include "engine/recogniser.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kNumComponents = 60;
constexpr std::size_t kBasisFeatures = 15'000;  // that the principal components are found from

/// Images of some of a model's features, spread over all.
void append_some(const Descriptions& all, std::size_t wanted, std::vector<float>& images) {
  const std::size_t n = std::min(wanted, all.size());
  for (std::size_t k = 0; k < n; ++k) {
    const auto image = std::span(all.images)
                           .subspan(k * all.size() / n * kernels::kTriSpinSize)
                           .first(kernels::kTriSpinSize);
    images.insert(images.end(), image.begin(), image.end());
  }
}

}  // namespace

Result<FeatureLibrary> build_features(const Recogniser& recogniser,
                                      const DescribeOptions& options) {
  const Library& library = recogniser.library();
  FeatureLibrary out;
  out.options = options;
  if (library.models.empty()) return out;
  // Images take fifty times the room of what is kept of them: one model's at a time.
  const auto describe = [&](std::uint32_t m) -> Result<Descriptions> {
    const Result<kernels::RayScene>& rays = recogniser.surface(m);
    if (!rays) return rays.error();
    return describe_model(library.models[m], *rays, options);
  };
  std::vector<float> some;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const Result<Descriptions> all = describe(m);
    if (!all) return all.error();
    append_some(*all, 1 + kBasisFeatures / library.models.size(), some);
  }
  if (some.empty()) return out;
  out.basis = kernels::find_components(some, kernels::kTriSpinSize, kNumComponents);

  struct Gathered {
    FeatureLevel level;
    Column<float> features;
  };
  std::map<float, Gathered> gathered;
  const std::size_t k = out.basis.size();
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const Result<Descriptions> all = describe(m);
    if (!all) return all.error();
    const float resolution = resolution_for(library.models[m].diameter);
    Gathered& at = gathered[resolution];
    at.level.resolution = resolution;
    at.level.model.insert(at.level.model.end(), all->size(), m);
    for (std::size_t i = 0; i < all->size(); ++i) at.level.keypoints.push_back(all->keypoints[i]);
    at.level.frames.insert(at.level.frames.end(), all->frames.begin(), all->frames.end());
    const std::size_t before = at.features.size();
    at.features.resize(before + all->size() * k);
    for_chunks(all->size(), 256, [&](std::size_t first, std::size_t count) {
      kernels::project(out.basis,
                       std::span(all->images)
                           .subspan(first * kernels::kTriSpinSize, count * kernels::kTriSpinSize),
                       std::span(at.features).subspan(before + first * k, count * k));
    });
  }
  for (auto& [resolution, at] : gathered) {
    at.level.forest = kernels::FeatureForest(at.features, k);
    out.levels.push_back(std::move(at.level));
  }
  return out;
}

}  // namespace trivet::engine
