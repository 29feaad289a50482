#include "engine/hypotheses/feature_library.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/hypotheses/build_code_index.hpp"

namespace trivet::engine {
namespace {

/// The features of a level as the models have them, one model after the other.
struct Gathered {
  std::vector<std::uint32_t> model, row;
  Column<std::uint8_t> codes;  // padded
};

Gathered gather(const Library& library, std::span<const std::uint32_t> models) {
  const std::size_t k = library.basis.components.size(), stride = kernels::code_stride(k);
  Gathered all;
  for (const std::uint32_t m : models) {
    const TriSpinFeatures& features = library.models[m].features;
    const std::size_t before = all.codes.size();
    all.codes.resize(before + features.size() * stride);
    kernels::pad_codes(features.codes, k, std::span(all.codes).subspan(before));
    for (std::uint32_t i = 0; i < features.size(); ++i) {
      all.model.push_back(m);
      all.row.push_back(i);
    }
  }
  return all;
}

void index_level(const Library& library, FeatureLevel& level) {
  const std::size_t stride = kernels::code_stride(library.basis.components.size());
  const Gathered all = gather(library, level.models);
  CodeLists lists = build_code_lists(all.codes, stride);
  level.centroids = std::move(lists.centroids);
  level.offsets = std::move(lists.offsets);
  const std::size_t n = all.model.size();
  level.keypoints.resize(n);
  level.codes.resize(n * stride);
  for (std::size_t to = 0; to < n; ++to) {
    const std::uint32_t from = lists.order[to], row = all.row[from];
    const TriSpinFeatures& features = library.models[all.model[from]].features;
    level.model.push_back(all.model[from]);
    level.keypoints.set(to, features.keypoints[row]);
    level.frames.emplace_back(
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(features.frames[row].data()));
    std::ranges::copy(std::span(all.codes).subspan(from * stride, stride),
                      level.codes.begin() + static_cast<std::ptrdiff_t>(to * stride));
  }
}

}  // namespace

kernels::CodeIndexView FeatureLevel::index() const noexcept {
  const std::size_t n = model.size();
  return {n == 0 ? 0 : codes.size() / n, centroids, offsets, codes};
}

std::vector<FeatureLevel> index_features(const Library& library) {
  std::map<float, std::vector<std::uint32_t>> models;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const TriSpinFeatures& features = library.models[m].features;
    if (features.size() > 0) models[features.resolution].push_back(m);
  }
  std::vector<FeatureLevel> levels;
  for (auto& [resolution, of_level] : models) {
    FeatureLevel level;
    level.resolution = resolution;
    level.models = std::move(of_level);
    index_level(library, level);
    levels.push_back(std::move(level));
  }
  return levels;
}

}  // namespace trivet::engine
