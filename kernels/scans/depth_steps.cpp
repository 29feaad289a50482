#include "kernels/scans/depth_steps.hpp"

#include <algorithm>
#include <cmath>

namespace trivet::kernels {
namespace {

constexpr std::ptrdiff_t kAway = 12, kFlat = 4;  // [pixel]
// What sensors that do not filter lose of a step, or blend into it [pixel].
constexpr std::ptrdiff_t kMostGap = 2;
// Of the range. Smaller steps are those of coarse depths; filters keep larger ones.
constexpr float kLeastStep = 0.012F, kMostStep = 0.06F;
constexpr float kMostRange = 0.2F;  // of depths in a flat piece [height of the step]
// Slope of both pieces in that from one to the other: a slanted surface has 1, and hides how abrupt a
// step is.
constexpr float kMostSlope = 0.4F;
constexpr float kPieceToPiece = 2 * kAway + kFlat;  // middles of the pieces [pixel]
constexpr float kAbrupt = 0.5F;                     // of a step's height

/// A row or column of depths.
struct ScanLine {
  const float* first;
  std::ptrdiff_t stride, count;

  float operator[](std::ptrdiff_t i) const noexcept { return first[i * stride]; }
};

/// Depths of a flat piece.
struct Piece {
  float mean, range, rise;
};

Piece piece_at(const ScanLine& line, std::ptrdiff_t first) noexcept {
  float sum = 0, least = line[first], most = least;
  for (std::ptrdiff_t i = first; i < first + kFlat; ++i) {
    sum += line[i];
    least = std::min(least, line[i]);
    most = std::max(most, line[i]);
  }
  return {sum / kFlat, most - least, line[first + kFlat - 1] - line[first]};
}

bool is_measured(const ScanLine& line, std::ptrdiff_t first) noexcept {
  for (std::ptrdiff_t i = first; i < first + kFlat; ++i) {
    if (!(line[i] > 0)) return false;
  }
  return true;
}

/// Depth of a pixel relative to the next measured one before it; 0 without any within a gap.
float jump_to(const ScanLine& line, std::ptrdiff_t i) noexcept {
  if (!(line[i] > 0)) return 0;
  for (std::ptrdiff_t before = i - 1; before >= i - 1 - kMostGap; --before) {
    if (line[before] > 0) return line[i] - line[before];
  }
  return 0;
}

void count_steps(const ScanLine& line, StepCounts& counts) noexcept {
  std::ptrdiff_t gap = 0;    // pixels in a row without a measurement
  std::ptrdiff_t first = 0;  // pixel after the last wide gap
  for (std::ptrdiff_t last = 0; last < line.count; ++last) {
    gap = line[last] > 0 ? 0 : gap + 1;
    if (gap > kMostGap) first = last + 1;
    const std::ptrdiff_t before_at = last + 1 - 2 * (kAway + kFlat), after_at = last + 1 - kFlat;
    if (before_at < first) continue;
    const std::ptrdiff_t i = before_at + kFlat + kAway;  // the jump is to this pixel
    const float jump = jump_to(line, i);
    if (jump == 0 || !is_measured(line, before_at) || !is_measured(line, after_at)) continue;
    const Piece before = piece_at(line, before_at), after = piece_at(line, after_at);
    const float step = after.mean - before.mean, height = std::abs(step);
    if (!(height >= kLeastStep * line[i] && height <= kMostStep * line[i] && step * jump > 0))
      continue;
    if (std::max(before.range, after.range) > kMostRange * height) continue;
    const float slope = (before.rise + after.rise) / (2 * (kFlat - 1));
    if (slope / (step / kPieceToPiece) > kMostSlope) continue;
    bool is_largest = true;
    for (std::ptrdiff_t k = i - kAway; k <= i + kAway && is_largest; ++k)
      is_largest = !(std::abs(jump_to(line, k)) > std::abs(jump));
    if (!is_largest) continue;
    ++counts.steps;
    counts.abrupt += std::abs(jump) > kAbrupt * height ? 1 : 0;
  }
}

}  // namespace

StepCounts count_steps_of_rows(const RangeImage& image, std::size_t first_row,
                               std::size_t num_rows) {
  StepCounts counts;
  const std::ptrdiff_t width = image.geometry.width;
  for (std::size_t v = first_row; v < first_row + num_rows; ++v)
    count_steps({&image.depth[v * image.geometry.width], 1, width}, counts);
  return counts;
}

StepCounts count_steps_of_columns(const RangeImage& image, std::size_t first_column,
                                  std::size_t num_columns) {
  StepCounts counts;
  const std::ptrdiff_t width = image.geometry.width, height = image.geometry.height;
  for (std::size_t u = first_column; u < first_column + num_columns; ++u)
    count_steps({&image.depth[u], width, height}, counts);
  return counts;
}

}  // namespace trivet::kernels
