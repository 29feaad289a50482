#include "kernels/spin_images/feature_codes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

std::vector<float> decoded(std::span<const std::uint8_t> codes, float step) {
  std::vector<float> numbers(codes.size());
  decode(codes, step, numbers);
  return numbers;
}

TEST(FeatureCodes, KeepNumbersToHalfAStep) {
  test::Random random;
  std::vector<float> numbers;
  for (int i = 0; i < 1000; ++i) numbers.push_back(random.uniform(-0.7F, 0.7F));
  const float step = code_step_for(numbers);
  std::vector<std::uint8_t> codes(numbers.size());
  encode(numbers, step, codes);
  const std::vector<float> back = decoded(codes, step);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    EXPECT_LE(std::abs(back[i] - numbers[i]), 0.5001F * step) << numbers[i];
}

TEST(FeatureCodes, KeepZeroAndTheEndsAndCutWhatLiesBeyond) {
  const std::array<float, 5> numbers{0, 127, -127, 1000, -1e30F};
  std::array<std::uint8_t, 5> codes{};
  encode(numbers, 1, codes);
  EXPECT_EQ(codes, (std::array<std::uint8_t, 5>{128, 255, 1, 255, 1}));
  EXPECT_EQ(decoded(codes, 0.5F), (std::vector<float>{0, 63.5F, -63.5F, 63.5F, -63.5F}));
}

TEST(FeatureCodes, HaveAStepForAnyNumbers) {
  EXPECT_FLOAT_EQ(code_step_for(std::array{-0.2F, 0.1F}) * 127, 0.2F);
  EXPECT_EQ(code_step_for(std::array{0.0F, 0.0F}), 1);
  EXPECT_EQ(code_step_for({}), 1);
}

}  // namespace
}  // namespace trivet::kernels
