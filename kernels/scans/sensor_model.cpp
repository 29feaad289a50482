#include "kernels/scans/sensor_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/common/median.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kPixels = kPatchSide * kPatchSide;
constexpr std::size_t kTerms = 6;
// A patch lies on one surface if its residuals stay within this share of its range.
constexpr double kMostRest = 0.1;

// Correlation of residuals for independent noise after subtracting a quadratic, and for correlated
// noise; real cameras have 0.09 to 0.7.
constexpr double kIndependent = -0.05, kDependent = 0.15;
// Relative to the range. Smaller residuals are shape: cameras that match windows have errors of at
// least a twentieth of a pixel of disparity, 2e-4 of the range at 0.2 m.
constexpr double kFinest = 1e-4;
constexpr std::size_t kFewest = 8;      // patches needed
constexpr double kSmoothest = 1.0 / 3;  // share of the patches
constexpr std::size_t kRangeBins = 8;
constexpr std::size_t kFewestInBin = 15;
// The exponents of the available cameras are 1.3 to 2; the weight is relative to a bin's spread in
// log range.
constexpr double kPriorExponent = 1.5, kPriorWeight = 5, kMostExponent = 2;
// Ratio of correlated noise to noise for scans without planes: the median of ten real scans.
constexpr float kPriorCorrelated = 1.3F;
constexpr float kPriorSlopeRad = 0.17F;

// A scan may be smoothed if fewer of its steps are abrupt. Filtered scans have 0 to 1.5 %, but
// for one of 3.6 %, made scans that lose pixels at edges 3 to 80 %, those of PrimeSense and Kinect 3
// to 30 % (docs/verification.md).
constexpr double kFewAbrupt = 0.02;
constexpr std::size_t kFewestSteps = 50;
// Poses of this probability tell how a scan was smoothed, and their mean log odds rise by so much.
constexpr float kLikely = 0.8F;
constexpr double kClearGain = 0.5, kLeastProbability = 1e-3;

/// Orthonormal quadratics over a patch.
using Basis = std::array<std::array<double, kPixels>, kTerms>;

Basis make_basis() {
  Basis basis{};
  for (std::size_t k = 0; k < kPixels; ++k) {
    const double x = (static_cast<double>(k % kPatchSide) - 5) / 5;
    const double y = (static_cast<double>(k / kPatchSide) - 5) / 5;  // NOLINT: whole rows
    const std::array<double, kTerms> terms{1, x, y, x * x, x * y, y * y};
    for (std::size_t t = 0; t < kTerms; ++t) basis[t][k] = terms[t];
  }
  // Gram-Schmidt orthonormalization.
  for (std::size_t t = 0; t < kTerms; ++t) {
    for (std::size_t before = 0; before < t; ++before) {
      double dot = 0;
      for (std::size_t k = 0; k < kPixels; ++k) dot += basis[t][k] * basis[before][k];
      for (std::size_t k = 0; k < kPixels; ++k) basis[t][k] -= dot * basis[before][k];
    }
    double squares = 0;
    for (const double value : basis[t]) squares += value * value;
    for (double& value : basis[t]) value /= std::sqrt(squares);
  }
  return basis;
}

double quantile_of(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Growth of deviations with range: weighted least squares over bins of log range, with a prior.
double fit_exponent(std::span<const SmoothPatch> patches) {
  std::vector<double> ranges;
  for (const SmoothPatch& patch : patches)
    ranges.push_back(std::log(static_cast<double>(patch.range)));
  const double low = quantile_of(ranges, 0.02), high = quantile_of(ranges, 0.98);
  if (!(high > low)) return kPriorExponent;
  std::array<std::vector<double>, kRangeBins> bins;
  std::array<double, kRangeBins> middles{};
  for (const SmoothPatch& patch : patches) {
    const double range = std::log(static_cast<double>(patch.range));
    const double place = (range - low) / (high - low) * kRangeBins;
    if (!(place >= 0 && place < kRangeBins)) continue;
    const auto bin = static_cast<std::size_t>(place);
    bins[bin].push_back(std::log(static_cast<double>(patch.deviation)));
    middles[bin] += range;
  }
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t bin = 0; bin < kRangeBins; ++bin) {
    if (bins[bin].size() < kFewestInBin) continue;
    const double weight = std::sqrt(static_cast<double>(bins[bin].size()));
    const double range = middles[bin] / static_cast<double>(bins[bin].size());
    const double deviation = quantile_of(bins[bin], 0.25);
    n += weight;
    x += weight * range;
    y += weight * deviation;
    xx += weight * range * range;
    xy += weight * range * deviation;
  }
  if (!(n > 0)) return kPriorExponent;
  const double spread = xx - x * x / n, along = xy - x * y / n;
  return std::clamp((along + kPriorWeight * kPriorExponent) / (spread + kPriorWeight), 0.0,
                    kMostExponent);
}

}  // namespace

float SensorModel::growth(float at_range) const noexcept {
  return at_range > 0 && exponent > 0 ? std::pow(at_range / range, exponent) : 1;
}

float SensorModel::range_of_growth(float factor) const noexcept {
  if (exponent > 0) return range * std::pow(factor, 1 / exponent);
  return factor < 1 ? 0 : std::numeric_limits<float>::infinity();
}

float SensorModel::error_at(float at_range) const noexcept {
  return growth(at_range) * std::hypot(noise, correlated_noise.height);
}

SensorModel SensorModel::smoothed_by(float length) const noexcept {
  SensorModel model = *this;
  model.smoothing = length;
  if (length > 0) model.correlation = 1;
  return model;
}

void measure_patches(const RangeImage& image, std::size_t first_row, std::size_t num_rows,
                     std::vector<SmoothPatch>& out) {
  static const Basis basis = make_basis();
  const std::size_t width = image.geometry.width, height = image.geometry.height;
  std::array<double, kPixels> rest;
  for (std::size_t v = first_row; v < first_row + num_rows; ++v) {
    if (v % kPatchSide != 0 || v + kPatchSide > height) continue;
    for (std::size_t u = 0; u + kPatchSide <= width; u += kPatchSide) {
      bool is_complete = true;
      double sum = 0;
      for (std::size_t k = 0; k < kPixels && is_complete; ++k) {
        const float d = image.depth[(v + k / kPatchSide) * width + u + k % kPatchSide];
        is_complete = d > 0;
        sum += static_cast<double>(d);
        rest[k] = 1 / static_cast<double>(d);
      }
      if (!is_complete) continue;
      const double range = sum / kPixels;
      for (const auto& term : basis) {
        double dot = 0;
        for (std::size_t k = 0; k < kPixels; ++k) dot += term[k] * rest[k];
        for (std::size_t k = 0; k < kPixels; ++k) rest[k] -= dot * term[k];
      }
      double squares = 0, along = 0, most = 0;
      for (std::size_t k = 0; k < kPixels; ++k) {
        squares += rest[k] * rest[k];
        most = std::max(most, std::abs(rest[k]));
        if (k % kPatchSide + 1 < kPatchSide) along += rest[k] * rest[k + 1];
        if (k + kPatchSide < kPixels) along += rest[k] * rest[k + kPatchSide];
      }
      if (!(squares > 0) || most * range > kMostRest) continue;
      constexpr double kPairs = 2.0 * kPatchSide * (kPatchSide - 1);
      out.push_back({static_cast<float>(range),
                     static_cast<float>(range * range * std::sqrt(squares / (kPixels - kTerms))),
                     static_cast<float>(along / kPairs / (squares / kPixels))});
    }
  }
}

void fit_sensor_model(std::span<const SmoothPatch> patches, SensorModel& model) {
  model.exponent = model.correlation = 0;
  if (patches.size() < kFewest) return;
  model.exponent = static_cast<float>(fit_exponent(patches));
  std::vector<double> deviations;
  const auto at_reference = [&](const SmoothPatch& patch) {
    return static_cast<double>(patch.deviation) *
           std::pow(static_cast<double>(model.range / patch.range),
                    static_cast<double>(model.exponent));
  };
  for (const SmoothPatch& patch : patches) deviations.push_back(at_reference(patch));
  const double limit = quantile_of(deviations, kSmoothest);
  std::vector<double> correlations;
  for (const SmoothPatch& patch : patches) {
    if (at_reference(patch) <= limit)
      correlations.push_back(static_cast<double>(patch.correlation));
  }
  const double correlation = median(std::span(correlations));
  const double relative = limit / static_cast<double>(model.range);
  model.correlation = static_cast<float>(
      std::clamp((correlation - kIndependent) / (kDependent - kIndependent), 0.0, 1.0) *
      std::clamp((relative - kFinest) / kFinest, 0.0, 1.0));
  if (!(model.correlated_noise.height > 0) && model.correlation > 0) {
    model.correlated_noise.height = kPriorCorrelated * model.correlation * model.noise;
    model.correlated_noise.slope_rad = kPriorSlopeRad * model.correlation;
  }
}

bool may_be_smoothed(const StepCounts& counts) noexcept {
  return counts.steps >= kFewestSteps &&
         static_cast<double>(counts.abrupt) < kFewAbrupt * static_cast<double>(counts.steps);
}

std::optional<float> choose_smoothing(
    std::span<const std::array<float, kSmoothingLengths.size()>> probabilities) noexcept {
  std::array<double, kSmoothingLengths.size()> sums{};
  double num_likely = 0;
  for (const auto& of_pose : probabilities) {
    if (!(std::ranges::max(of_pose) > kLikely)) continue;
    num_likely += 1;
    for (std::size_t k = 0; k < of_pose.size(); ++k) {
      const double p =
          std::clamp(static_cast<double>(of_pose[k]), kLeastProbability, 1 - kLeastProbability);
      sums[k] += std::log(p / (1 - p));
    }
  }
  if (!(num_likely > 0)) return std::nullopt;
  const auto best = static_cast<std::size_t>(std::ranges::max_element(sums) - sums.begin());
  return sums[best] - sums[0] > kClearGain * num_likely ? kSmoothingLengths[best] : 0;
}

}  // namespace trivet::kernels
