#include "engine/libraries/index_features.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/libraries/build_code_lists.hpp"
#include "kernels/spin_images/rotation_code.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kGrain = 4096;

/// The features of a level as the models have them, one model after the other.
struct Gathered {
  std::vector<std::uint32_t> from, row;  // which of the features, and which of these
  Column<std::uint8_t> codes;            // padded
};

Gathered gather(std::span<const FeaturesOfModel> features, std::span<const std::uint32_t> level) {
  const std::size_t k = features[level.front()].features.num_components;
  const std::size_t stride = kernels::code_stride(k);
  Gathered all;
  std::size_t n = 0;
  for (const std::uint32_t i : level) n += features[i].features.size();
  all.from.reserve(n);
  all.row.reserve(n);
  all.codes.resize(n * stride);
  for (const std::uint32_t i : level) {
    const TriSpinFeatures& own = features[i].features;
    kernels::pad_codes(own.codes, k,
                       std::span(all.codes).subspan(all.from.size() * stride, own.size() * stride));
    for (std::uint32_t row = 0; row < own.size(); ++row) {
      all.from.push_back(i);
      all.row.push_back(row);
    }
  }
  return all;
}

}  // namespace

FeatureIndexer::FeatureIndexer(std::span<const FeaturesOfModel> features) : features_(features) {
  std::map<float, std::vector<std::uint32_t>> levels;
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    if (features[i].features.size() > 0) levels[features[i].features.resolution].push_back(i);
  }
  for (auto& [resolution, of_level] : levels) levels_.push_back(std::move(of_level));
}

FeatureLevel FeatureIndexer::level(std::size_t k) const {
  const std::vector<std::uint32_t>& own = levels_[k];
  Gathered all = gather(features_, own);
  const std::size_t n = all.row.size(), stride = all.codes.size() / n;
  CodeLists lists = build_code_lists(all.codes, stride);
  Column<std::uint32_t> model(n);
  Points keypoints(n);
  Column<RotationCode> frames(n);
  Column<std::uint8_t> codes(n * stride);
  for_chunks(n, kGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t to = first; to < first + count; ++to) {
      const std::uint32_t at = lists.order[to], row = all.row[at];
      const auto& [rank, features] = features_[all.from[at]];
      model[to] = rank;
      keypoints.set(to, features.keypoints[row]);
      frames[to] =
          kernels::encode_rotation(Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
              features.frames[row].data()));
      std::ranges::copy(std::span(all.codes).subspan(at * stride, stride),
                        codes.begin() + static_cast<std::ptrdiff_t>(to * stride));
    }
  });
  Column<std::uint32_t> models;
  for (const std::uint32_t i : own) models.push_back(features_[i].model);
  FeatureLevel level;
  level.resolution = features_[own.front()].features.resolution;
  level.stride = stride;
  level.models = std::move(models);
  level.centroids = std::move(lists.centroids);
  level.offsets = std::move(lists.offsets);
  level.codes = std::move(codes);
  level.model = std::move(model);
  level.keypoints = std::move(keypoints);
  level.frames = std::move(frames);
  return level;
}

Result<FeatureIndex> index_features(const Library& library) {
  std::vector<FeaturesOfModel> features;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    if (const Result<void> good = library.check(m, ModelPart::features); !good) return good.error();
    for (const TriSpinFeatures& at_scale : library.models[m].features)
      features.push_back({m, at_scale});
  }
  const FeatureIndexer indexer(features);
  FeatureIndex levels;
  for (std::size_t k = 0; k < indexer.num_levels(); ++k) levels.push_back(indexer.level(k));
  return levels;
}

Result<void> add_index(LibraryWriter& writer) {
  std::optional<FeatureIndexer> indexer;
  return writer.add_index([&](std::span<const FeaturesOfModel> features, std::size_t k) {
    if (!indexer) indexer.emplace(features);
    return k < indexer->num_levels() ? std::optional(indexer->level(k)) : std::nullopt;
  });
}

kernels::CodeIndexView code_index(const FeatureLevel& level) noexcept {
  return {level.stride, level.centroids, level.offsets, level.codes};
}

}  // namespace trivet::engine
