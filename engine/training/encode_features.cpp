#include "engine/training/encode_features.hpp"

#include <utility>

#include "kernels/spin_images/feature_codes.hpp"

namespace trivet::engine {

FeatureRows encode_features(const Descriptions& descriptions, const kernels::Projector& projector,
                            float code_step) {
  const std::size_t n = descriptions.size(), k = projector.size();
  FeatureRows rows{descriptions.keypoints, Column<FrameRows>(n), Column<std::uint8_t>(n * k)};
  Column<float> projected(n * k);
  projector.project(descriptions.images, projected);
  kernels::encode(projected, code_step, rows.codes);
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(rows.frames[i].data()) =
        descriptions.frames[i];
  }
  return rows;
}

TriSpinFeatures join_features(std::span<const FeatureRows> parts, const TriSpinBasis& basis,
                              float resolution) {
  FeatureRows all;
  for (const FeatureRows& part : parts) {
    for (std::size_t i = 0; i < part.frames.size(); ++i) all.keypoints.push_back(part.keypoints[i]);
    all.frames.insert(all.frames.end(), part.frames.begin(), part.frames.end());
    all.codes.insert(all.codes.end(), part.codes.begin(), part.codes.end());
  }
  TriSpinFeatures features;
  features.resolution = resolution;
  features.keypoints = std::move(all.keypoints);
  features.frames = std::move(all.frames);
  features.codes = std::move(all.codes);
  features.num_components = basis.components.size();
  return features;
}

}  // namespace trivet::engine
