/// Common constants of all sensor models.
#pragma once

#include <cstddef>
#include <numbers>

namespace trivet::engine {

inline constexpr std::size_t kRowGrain = 16;  // rows of an image per task
inline constexpr double kDegree = std::numbers::pi / 180;
inline constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace trivet::engine
