/// Features as bytes.
#pragma once

#include <cstdint>
#include <span>

namespace trivet::kernels {

/// The step with which codes reach as far as the numbers do; 1 where all are 0.
float code_step_for(std::span<const float> numbers) noexcept;

/// Write each number as the nearest code: c stands for (c - 128) step, 1 <= c <= 255. Numbers
/// beyond these become the last.
void encode(std::span<const float> numbers, float step, std::span<std::uint8_t> codes);

/// Write what codes stand for.
void decode(std::span<const std::uint8_t> codes, float step, std::span<float> numbers);

}  // namespace trivet::kernels
