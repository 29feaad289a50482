#include "kernels/spin_images/feature_codes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr float kZero = 128, kFarthest = 127;

}  // namespace

float code_step_for(std::span<const float> numbers) noexcept {
  float largest = 0;
  for (const float number : numbers) largest = std::max(largest, std::abs(number));
  return largest > 0 ? largest / kFarthest : 1;
}

void encode(std::span<const float> numbers, float step, std::span<std::uint8_t> codes) {
  TRIVET_REQUIRE(codes.size() == numbers.size() && step > 0, "one code a number");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const float code = std::clamp(std::round(numbers[i] / step), -kFarthest, kFarthest);
    codes[i] = static_cast<std::uint8_t>(code + kZero);
  }
}

void decode(std::span<const std::uint8_t> codes, float step, std::span<float> numbers) {
  TRIVET_REQUIRE(codes.size() == numbers.size(), "one code a number");
  for (std::size_t i = 0; i < codes.size(); ++i)
    numbers[i] = (static_cast<float>(codes[i]) - kZero) * step;
}

}  // namespace trivet::kernels
