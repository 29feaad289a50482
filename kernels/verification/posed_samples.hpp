/// Model samples in a camera's view, in blocks so that loops over them vectorize.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Number of samples of a block: few enough that all its columns stay in the first-level cache.
inline constexpr std::size_t kSampleBlock = 256;

template <class T>
using BlockColumn = std::array<T, kSampleBlock>;

/// Consecutive samples in the camera's frame.
struct SampleBlock {
  std::size_t first = 0, count = 0;
  alignas(64) BlockColumn<float> x, y, z;
  alignas(64) BlockColumn<float> normal_x, normal_y, normal_z;
  alignas(64) BlockColumn<std::int32_t> column, row;  ///< pixel coordinates; -1 outside or behind

  PointsSpan points() noexcept { return {{x.data(), count}, {y.data(), count}, {z.data(), count}}; }
  NormalsSpan normals() noexcept {
    return {{normal_x.data(), count}, {normal_y.data(), count}, {normal_z.data(), count}};
  }
};

/// A model at a pose before the camera of one image. References model and image.
class PosedSamples {
 public:
  PosedSamples(const ImageGeometry& geometry, const ModelSamples& samples,
               const Pose& T_scene_model) noexcept;

  const Pose& T_camera_model() const noexcept { return T_camera_model_; }

  /// Whether sample i is not hidden by the model itself.
  bool is_visible(std::size_t i) const noexcept {
    return (samples_.views[i][view_word_] >> view_bit_ & 1U) != 0;
  }

  /// Transform samples from `first` to below `end`, no more than a block. No allocation. Each
  /// sample gets the same bits in any block: points are summed as in move_points, normals as c0 x +
  /// (c1 y + c2 z), both without fused products, as Eigen on x86-64 (on arm64 it fuses); pixels as
  /// ImageGeometry::pixel_of.
  void place(std::size_t first, std::size_t end, SampleBlock& block) const noexcept;

 private:
  const ImageGeometry& geometry_;
  const ModelSamples& samples_;
  Pose T_camera_model_;
  std::size_t view_word_, view_bit_;
};

/// Transform points: ((c0 x + c1 y) + c2 z) + t, c the rotation's columns. `out` has as many points
/// and does not overlap them.
void move_points(const Pose& pose, const PointsView& points, const PointsSpan& out) noexcept;

}  // namespace trivet::kernels
