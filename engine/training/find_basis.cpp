#include "engine/training/find_basis.hpp"

#include <algorithm>
#include <vector>

#include "engine/training/describe_model.hpp"
#include "engine/training/survey_model.hpp"
#include "kernels/common/pca.hpp"
#include "kernels/common/projector.hpp"
#include "kernels/spin_images/feature_codes.hpp"

namespace trivet::engine {
namespace {

/// Interval of described keypoints of a model. It gives more than enough images, from all sides.
constexpr std::size_t kStride = 8;

}  // namespace

Result<std::vector<float>> sample_images(const Cloud& cloud, const ModelSource& source,
                                         std::size_t wanted) {
  StageTimes times;
  TRIVET_TRY_ASSIGN(const SurveyedModel model,
                    survey_model(cloud, source, TrainOptions{}.num_samples, times));
  Column<float> all;
  for (const std::uint32_t above : kFeatureScales) {
    const Descriptions some = describe_model(model, {.half_octaves = above, .stride = kStride});
    all.insert(all.end(), some.images.begin(), some.images.end());
  }
  const std::size_t num_images = all.size() / kernels::kTriSpinSize;
  const std::size_t n = std::min(wanted, num_images);
  std::vector<float> images;
  for (std::size_t k = 0; k < n; ++k) {
    const auto image = std::span(all)
                           .subspan(k * num_images / n * kernels::kTriSpinSize)
                           .first(kernels::kTriSpinSize);
    images.insert(images.end(), image.begin(), image.end());
  }
  return images;
}

TriSpinBasis basis_of(std::span<const float> images, std::size_t num_components) {
  TriSpinBasis basis;
  if (images.empty()) return basis;
  basis.support = DescribeOptions{}.support;
  basis.components = kernels::find_components(images, kernels::kTriSpinSize, num_components);
  std::vector<float> features(images.size() / kernels::kTriSpinSize * basis.components.size());
  kernels::Projector(basis.components).project(images, features);
  basis.code_step = kernels::code_step_for(features);
  return basis;
}

}  // namespace trivet::engine
