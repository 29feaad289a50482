#include "kernels/scans/depth_quantization.hpp"

#include <algorithm>
#include <cstddef>

#include "kernels/common/median.hpp"
#include "storage/common/columns.hpp"

namespace trivet::kernels {
namespace {

// Of the median depth. Equal depths differ by the rounding of a change of frames.
constexpr float kNearMedian = 0.1F, kEqual = 1e-5F;
constexpr std::size_t kFewestDepthSteps = 10;
constexpr std::size_t kMeasurementsOfADepth = 2;  // at least, on average

}  // namespace

float quantization_step(std::span<float> depths) {
  const float middle = median(depths);
  const auto end = std::partition(depths.begin(), depths.end(), [&](float d) {
    return std::abs(d - middle) < kNearMedian * middle;
  });
  std::sort(depths.begin(), end);
  const auto count = static_cast<std::size_t>(end - depths.begin());
  Column<float> steps;
  for (std::size_t i = 1; i < count; ++i) {
    if (depths[i] - depths[i - 1] > kEqual * middle) steps.push_back(depths[i] - depths[i - 1]);
  }
  if (steps.size() < kFewestDepthSteps || count < kMeasurementsOfADepth * steps.size()) return 0;
  return median(std::span(steps));
}

}  // namespace trivet::kernels
