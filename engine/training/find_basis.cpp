#include "engine/training/find_basis.hpp"

#include <algorithm>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/train.hpp"
#include "engine/training/describe_model.hpp"
#include "engine/training/survey_model.hpp"
#include "kernels/common/pca.hpp"
#include "kernels/spin_images/feature_codes.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

constexpr std::size_t kMostModels = 16;
constexpr std::size_t kMostImages = 15'000;  // of all models together
/// Of a model's keypoints, one in so many is described: more than enough images come of it, of all
/// sides.
constexpr std::size_t kStride = 8;

}  // namespace

namespace engine {

Result<std::vector<float>> sample_images(const Cloud& cloud, const ModelSource& source,
                                         const TrainOptions& options, std::size_t wanted) {
  StageTimes times;
  const Result<SurveyedModel> model = survey_model(cloud, source, options.num_samples, times);
  if (!model) return model.error();
  const Descriptions all = describe_model(*model, {.stride = kStride});
  const std::size_t n = std::min(wanted, all.size());
  std::vector<float> images;
  for (std::size_t k = 0; k < n; ++k) {
    const auto image = std::span(all.images)
                           .subspan(k * all.size() / n * kernels::kTriSpinSize)
                           .first(kernels::kTriSpinSize);
    images.insert(images.end(), image.begin(), image.end());
  }
  return images;
}

TriSpinBasis basis_of(std::span<const float> images, const TrainOptions& options) {
  TriSpinBasis basis;
  if (images.empty()) return basis;
  basis.support = DescribeOptions{}.support;
  basis.components = kernels::find_components(images, kernels::kTriSpinSize, options.num_components,
                                              options.component_energy);
  std::vector<float> features(images.size() / kernels::kTriSpinSize * basis.components.size());
  kernels::project(basis.components, images, features);
  basis.code_step = kernels::code_step_for(features);
  return basis;
}

}  // namespace engine

Result<TriSpinBasis> find_basis(std::span<const ModelSource> sources, LengthUnit unit,
                                const TrainOptions& options, const std::stop_token& stop) {
  const std::size_t num_models = std::min(kMostModels, sources.size());
  std::vector<Result<std::vector<float>>> found(num_models, std::vector<float>{});
  engine::for_each_index(num_models, [&](std::size_t k) {
    if (stop.stop_requested()) return;
    const ModelSource& source = sources[k * sources.size() / num_models];
    const Result<Cloud> cloud = read_cloud(source.file, {.unit = unit, .keep_origin = true});
    found[k] = cloud ? engine::sample_images(*cloud, source, options, kMostImages / num_models)
                     : cloud.error();
  });
  std::vector<float> images;
  for (const Result<std::vector<float>>& some : found) {
    if (!some) return some.error();
    images.insert(images.end(), some->begin(), some->end());
  }
  return engine::basis_of(images, options);
}

}  // namespace trivet
