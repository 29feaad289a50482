/// Quantization of features to bytes.
#pragma once

#include <cstdint>
#include <span>

namespace trivet::kernels {

/// The step for which codes cover the range of the numbers; 1 if all are 0.
float code_step_for(std::span<const float> numbers) noexcept;

/// Quantize each number to the nearest code: c stands for (c - 128) step, 1 <= c <= 255. Numbers
/// beyond the range are clamped.
void encode(std::span<const float> numbers, float step, std::span<std::uint8_t> codes);

/// Convert codes back to numbers.
void decode(std::span<const std::uint8_t> codes, float step, std::span<float> numbers);

}  // namespace trivet::kernels
