#include "engine/hypotheses/feature_library.hpp"

#include <map>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/feature_codes.hpp"

namespace trivet::engine {

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
    levels.push_back(std::move(level));
  }
  const std::size_t k = library.basis.components.size();
  for_each_index(levels.size(), [&](std::size_t l) {
    FeatureLevel& level = levels[l];
    Column<float> numbers;
    for (const std::uint32_t m : level.models) {
      const TriSpinFeatures& features = library.models[m].features;
      level.model.insert(level.model.end(), features.size(), m);
      for (std::size_t i = 0; i < features.size(); ++i) {
        level.keypoints.push_back(features.keypoints[i]);
        level.frames.emplace_back(Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
            features.frames[i].data()));
      }
      const std::size_t before = numbers.size();
      numbers.resize(before + features.codes.size());
      kernels::decode(features.codes, library.basis.code_step, std::span(numbers).subspan(before));
    }
    level.forest = kernels::FeatureForest(numbers, k);
  });
  return levels;
}

}  // namespace trivet::engine
