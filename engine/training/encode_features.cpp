#include "engine/training/encode_features.hpp"

#include <algorithm>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/common/pca.hpp"
#include "kernels/spin_images/feature_codes.hpp"

namespace trivet::engine {

TriSpinFeatures encode_features(const Descriptions& descriptions, const TriSpinBasis& basis,
                                float resolution) {
  const std::size_t n = descriptions.size(), k = basis.components.size();
  TriSpinFeatures out;
  out.resolution = resolution;
  out.keypoints = descriptions.keypoints;
  out.num_components = k;
  Column<FrameRows> frames(n);
  Column<std::uint8_t> codes(n * k);
  PerThread<Column<float>> numbers;
  for_chunks(n, 256, [&](std::size_t first, std::size_t count) {
    Column<float>& projected = numbers.local();
    projected.resize(count * k);
    kernels::project(basis.components,
                     std::span(descriptions.images)
                         .subspan(first * kernels::kTriSpinSize, count * kernels::kTriSpinSize),
                     projected);
    kernels::encode(projected, basis.code_step, std::span(codes).subspan(first * k, count * k));
    for (std::size_t i = first; i < first + count; ++i) {
      Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(frames[i].data()) =
          descriptions.frames[i];
    }
  });
  out.frames = std::move(frames);
  out.codes = std::move(codes);
  return out;
}

}  // namespace trivet::engine
