#include "kernels/spin_images/tri_spin_image.hpp"

namespace trivet::kernels {

LocalFrame describe_support(const Support& support, const Eigen::Vector3f& normal, float radius,
                            const FrameLimits& limits, std::span<float, kTriSpinSize> image,
                            SpinScratch& scratch) {
  if (!normal.allFinite()) return {};
  if (support.size < limits.min_points) return {};
  LocalFrame frame = local_frame(support, radius, normal);
  if (frame.axes.isZero() || frame.second_ratio < limits.min_second_ratio ||
      frame.lean > limits.max_lean)
    return {};
  aim_first_axis(support, radius, frame);
  if (frame.hold < limits.min_hold) return {};
  const auto write = [&](std::span<float, kSpinImageSize> one, int axis) {
    spin_image(support, frame.axes.row(axis), radius, one, scratch);
    normalize_spin_image(one);
    if (axis == 2) return;
    for (float& value : one) value *= kTurningWeight;
  };
  write(image.subspan<0, kSpinImageSize>(), 0);
  write(image.subspan<kSpinImageSize, kSpinImageSize>(), 1);
  write(image.subspan<2 * kSpinImageSize, kSpinImageSize>(), 2);
  return frame;
}

LocalFrame describe_keypoint(const WeightedSurface& surface, const Keypoint& keypoint, float radius,
                             const FrameLimits& limits, std::span<float, kTriSpinSize> image,
                             TriSpinScratch& scratch) {
  gather_support(surface.grid, surface.areas, keypoint.position, radius, scratch.support);
  return describe_support(scratch.support, keypoint.normal, radius, limits, image, scratch.spin);
}

}  // namespace trivet::kernels
