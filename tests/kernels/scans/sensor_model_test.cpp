#include "kernels/scans/sensor_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kWidth = 640, kHeight = 480;
constexpr std::size_t kColumns = kWidth / kPatchSide, kRows = kHeight / kPatchSide;
constexpr double kPrior = 1.5;

/// One value per pixel.
using Field = std::vector<float>;

template <class Value>
Field field_of(Value&& value) {
  Field field;
  for (std::size_t v = 0; v < kHeight; ++v) {
    for (std::size_t u = 0; u < kWidth; ++u)
      field.push_back(value(static_cast<float>(u), static_cast<float>(v)));
  }
  return field;
}

float flat(float, float) { return 0.8F; }
float slanted(float u, float v) { return 1 / (1.2F - 4e-4F * u + 3e-4F * v); }
/// Depth between 0.77 and 0.83, with some 100 pixels from hill to valley.
float hilly(float u, float v) { return 0.8F + 0.03F * std::sin(u / 30) * std::cos(v / 40); }
/// Depth from 1 to 3, uniform in its logarithm.
float receding(float u, float) { return std::pow(3.0F, u / static_cast<float>(kWidth - 1)); }

Field independent(test::Random& random, float sigma) {
  return field_of([&](float, float) { return random.normal(sigma); });
}

/// Means over windows of 5 x 5 pixels, like the errors of a camera that matches windows.
Field averaged(const Field& field) {
  return field_of([&](float u, float v) {
    float sum = 0, n = 0;
    for (int y = static_cast<int>(v) - 2; y <= static_cast<int>(v) + 2; ++y) {
      for (int x = static_cast<int>(u) - 2; x <= static_cast<int>(u) + 2; ++x) {
        if (x < 0 || y < 0 || x >= static_cast<int>(kWidth) || y >= static_cast<int>(kHeight))
          continue;
        sum += field[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
        n += 1;
      }
    }
    return sum / n;
  });
}

RangeImage image_of(const Field& depth) {
  RangeImage image;
  image.geometry = {Pose::Identity(), 600, 600, 319.5F, 239.5F, kWidth, kHeight};
  image.depth.assign(depth.begin(), depth.end());
  return image;
}

TEST(SensorModel, MayBeSmoothedIfHardlyAStepIsAbrupt) {
  EXPECT_TRUE(may_be_smoothed({.steps = 1000, .abrupt = 15}));
  EXPECT_FALSE(may_be_smoothed({.steps = 1000, .abrupt = 25}));
  EXPECT_FALSE(may_be_smoothed({.steps = 20, .abrupt = 0})) << "too few to tell";
}

TEST(SensorModel, IsSmoothedAsLikelyPosesClearlySay) {
  using Pose = std::array<float, kSmoothingLengths.size()>;
  const Pose better{0.2F, 0.5F, 0.95F, 0.9F}, worse{0.95F, 0.9F, 0.3F, 0.1F},
      alike{0.85F, 0.86F, 0.87F, 0.8F}, unlikely{0.01F, 0.1F, 0.3F, 0.79F};
  const auto choose = [](const std::vector<Pose>& poses) { return choose_smoothing(poses); };
  EXPECT_EQ(choose({better, better}), kSmoothingLengths[2]);
  EXPECT_EQ(choose({better, unlikely, unlikely}), kSmoothingLengths[2]);
  EXPECT_EQ(choose({worse, better, worse}), 0);
  EXPECT_EQ(choose({alike, alike}), 0) << "no clear gain";
  EXPECT_FALSE(choose({unlikely}));
  EXPECT_FALSE(choose({}));
}

TEST(SensorModel, ErrsAlikeInNeighborsIfItIsSmoothed) {
  SensorModel model;
  model.correlation = 0.2F;
  EXPECT_EQ(model.smoothed_by(3).correlation, 1);
  EXPECT_EQ(model.smoothed_by(3).smoothing, 3);
  EXPECT_EQ(model.smoothed_by(0).correlation, 0.2F);
}

Field sum_of(Field a, const Field& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

std::vector<SmoothPatch> patches_of(const RangeImage& image) {
  std::vector<SmoothPatch> patches;
  measure_patches(image, 0, image.geometry.height, patches);
  return patches;
}

SensorModel model_of(const Field& depth, float range = 0.8F) {
  SensorModel model;
  model.range = range;
  fit_sensor_model(patches_of(image_of(depth)), model);
  return model;
}

TEST(SensorModel, MeasuresIndependentNoiseOnPlanesAndOnCurvedSurfaces) {
  test::Random random;
  for (const auto surface : {flat, slanted, hilly}) {
    const SensorModel model = model_of(sum_of(field_of(surface), independent(random, 1e-3F)));
    // 800 correlations with a spread of 1 / sqrt(220): their median has an error of 0.003, and 0.2
    // maps to 1.
    EXPECT_LT(model.correlation, 0.05F);
    EXPECT_LT(model.edge_pixels(), 0.25F);
    EXPECT_LT(model.correlated_noise.height, 0.1F * 1e-3F);
  }
}

TEST(SensorModel, MeasuresNoiseThatWindowsShare) {
  test::Random random;
  for (const auto surface : {flat, slanted, hilly}) {
    const Field shared = averaged(independent(random, 3e-3F));
    const SensorModel model = model_of(sum_of(field_of(surface), shared));
    EXPECT_EQ(model.correlation, 1);
    EXPECT_EQ(model.edge_pixels(), SensorModel::kEdgePixels);
  }
}

TEST(SensorModel, DetectsMixturesByWhatIsShared) {
  test::Random random;
  float before = 0;
  // Independent noise of 1e-3 and the listed noise shared by neighboring pixels.
  for (const float sigma : {1e-3F, 2e-3F, 5e-3F}) {
    const Field shared = averaged(independent(random, sigma));
    const SensorModel model =
        model_of(sum_of(sum_of(field_of(slanted), independent(random, 1e-3F)), shared));
    EXPECT_GT(model.correlation, before) << sigma;
    before = model.correlation;
  }
  EXPECT_GT(before, 0.5F);
}

TEST(SensorModel, MeasuresHowNoiseGrowsWithRange) {
  test::Random random;
  for (const float exponent : {0.0F, 1.0F, 2.0F}) {
    const Field depth = field_of([&](float u, float v) {
      const float range = receding(u, v);
      return range + random.normal(5e-4F * std::pow(range, exponent));
    });
    // Eight bins 0.13 apart in log range, with 311 patches each: their weight is sqrt(311) * 0.13^2
    // * 42 = 12.5, that of the prior 5.
    constexpr double kPull = 5 / (12.5 + 5);
    const double truth = static_cast<double>(exponent);
    EXPECT_NEAR(model_of(depth, 1.7F).exponent, truth + kPull * (kPrior - truth), 0.08) << truth;
  }
}

TEST(SensorModel, KeepsThePriorAtOneRange) {
  test::Random random;
  EXPECT_NEAR(model_of(sum_of(field_of(flat), independent(random, 1e-3F))).exponent, kPrior, 0.02);
  const std::vector<SmoothPatch> alike(50, {0.8F, 1e-3F, 0});
  SensorModel model;
  fit_sensor_model(alike, model);
  EXPECT_EQ(model.exponent, static_cast<float>(kPrior));
}

TEST(SensorModel, AssumesIndependentErrorsWithTooFewPatches) {
  const std::vector<SmoothPatch> patches(8, {0.8F, 1e-3F, 0.6F});
  SensorModel model;
  model.noise = 1e-3F;
  model.exponent = model.correlation = 0.5F;  // of another scan
  fit_sensor_model(std::span(patches).first(7), model);
  EXPECT_EQ(model.exponent, 0);
  EXPECT_EQ(model.correlation, 0);
  EXPECT_EQ(model.correlated_noise.height, 0);
  EXPECT_EQ(model.error_at(5), model.noise) << "at any range";
  fit_sensor_model(patches, model);
  EXPECT_GT(model.exponent, 0);
  EXPECT_EQ(model.correlation, 1);
}

TEST(SensorModel, SuspectsShapeInAllButTheSmoothestPatches) {
  std::vector<SmoothPatch> patches(40, {0.8F, 1e-3F, -0.05F});
  patches.resize(100, {0.8F, 2e-3F, 0.8F});
  SensorModel model;
  fit_sensor_model(patches, model);
  EXPECT_NEAR(model.correlation, 0, 1e-6F);
}

TEST(SensorModel, LaysNoPatchOverAStepOrAHole) {
  test::Random random;
  // Column 14 of the patches covers pixels 154 to 164.
  const Field noise = independent(random, 1e-3F);
  Field depth = sum_of(field_of([](float u, float) { return u < 160 ? 1.0F : 2.0F; }), noise);
  std::vector<SmoothPatch> patches = patches_of(image_of(depth));
  EXPECT_EQ(patches.size(), kRows * (kColumns - 1));
  for (const SmoothPatch& patch : patches) {
    EXPECT_NEAR(patch.deviation, 1e-3F, 4e-4F);
    EXPECT_TRUE(std::abs(patch.range - 1) < 0.01F || std::abs(patch.range - 2) < 0.01F);
  }

  depth = sum_of(field_of(flat), noise);
  depth[5 * kWidth + 5] = 0;
  depth[5 * kWidth + 16] = std::numeric_limits<float>::quiet_NaN();
  patches = patches_of(image_of(depth));
  EXPECT_EQ(patches.size(), kRows * kColumns - 2);
}

TEST(SensorModel, GivesTheSamePatchesForAnySplitIntoRows) {
  test::Random random;
  const RangeImage image = image_of(sum_of(field_of(hilly), independent(random, 1e-3F)));
  const std::vector<SmoothPatch> whole = patches_of(image);
  ASSERT_EQ(whole.size(), kRows * kColumns);
  for (const std::size_t grain : {1, 7, 11, 16, 100}) {
    std::vector<SmoothPatch> parts;
    test::for_chunks(kHeight, grain, [&](std::size_t first, std::size_t count) {
      measure_patches(image, first, count, parts);
    });
    ASSERT_EQ(parts.size(), whole.size()) << grain;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(parts[i].range, whole[i].range);
      EXPECT_EQ(parts[i].deviation, whole[i].deviation);
      EXPECT_EQ(parts[i].correlation, whole[i].correlation);
    }
  }
}

/// The patch with the upper left pixel (u, v), by normal equations over 1 / depth.
SmoothPatch naive_patch(const RangeImage& image, std::size_t u, std::size_t v) {
  constexpr auto kSide = static_cast<Eigen::Index>(kPatchSide);
  Eigen::MatrixXd terms(kSide * kSide, 6);
  Eigen::VectorXd values(kSide * kSide);
  double range = 0;
  for (Eigen::Index y = 0; y < kSide; ++y) {
    for (Eigen::Index x = 0; x < kSide; ++x) {
      const std::size_t pixel =
          (v + static_cast<std::size_t>(y)) * kWidth + u + static_cast<std::size_t>(x);
      const double a = static_cast<double>(x), b = static_cast<double>(y);
      terms.row(y * kSide + x) << 1, a, b, a * a, a * b, b * b;
      values(y * kSide + x) = 1 / static_cast<double>(image.depth[pixel]);
      range += static_cast<double>(image.depth[pixel]) / (kSide * kSide);
    }
  }
  const Eigen::VectorXd fitted =
      (terms.transpose() * terms).ldlt().solve(terms.transpose() * values);
  const Eigen::VectorXd rest = values - terms * fitted;
  double products = 0, pairs = 0;
  for (Eigen::Index y = 0; y < kSide; ++y) {
    for (Eigen::Index x = 0; x < kSide; ++x) {
      const Eigen::Index at = y * kSide + x;
      if (x > 0) products += rest(at) * rest(at - 1), pairs += 1;
      if (y > 0) products += rest(at) * rest(at - kSide), pairs += 1;
    }
  }
  const double squares = rest.squaredNorm();
  return {static_cast<float>(range),
          static_cast<float>(range * range * std::sqrt(squares / (kSide * kSide - 6))),
          static_cast<float>(products / pairs / (squares / (kSide * kSide)))};
}

TEST(SensorModel, AgreesWithANaiveReferenceOfAPatch) {
  test::Random random;
  const Field noise = independent(random, 1e-3F);
  for (const Field& errors : {noise, averaged(noise)}) {
    const RangeImage image = image_of(sum_of(field_of(receding), errors));
    const std::vector<SmoothPatch> patches = patches_of(image);
    ASSERT_EQ(patches.size(), kRows * kColumns);
    for (std::size_t i = 0; i < patches.size(); i += 37) {
      const SmoothPatch naive =
          naive_patch(image, i % kColumns * kPatchSide, i / kColumns * kPatchSide);
      EXPECT_NEAR(patches[i].range, naive.range, 1e-6F * naive.range);
      EXPECT_NEAR(patches[i].deviation, naive.deviation, 1e-5F * naive.deviation);
      EXPECT_NEAR(patches[i].correlation, naive.correlation, 1e-5F);
    }
  }
}

TEST(SensorModel, IsTheSameInMetersAndMillimeters) {
  test::Random random;
  const Field errors = sum_of(independent(random, 1e-3F), averaged(independent(random, 2e-3F)));
  Field depth = sum_of(field_of(receding), errors);
  const SensorModel meters = model_of(depth, 1.7F);
  for (float& value : depth) value *= 1000;
  const SensorModel millimeters = model_of(depth, 1700);
  EXPECT_GT(meters.correlation, 0.1F);
  EXPECT_LT(meters.correlation, 0.99F);
  EXPECT_NEAR(millimeters.correlation, meters.correlation, 1e-3F);
  EXPECT_NEAR(millimeters.exponent, meters.exponent, 1e-3F);
}

TEST(SensorModel, DetectsWavesByItsNoiseOnlyWhereNoPlaneDid) {
  const std::vector<SmoothPatch> patches(20, {0.8F, 1e-3F, 0.6F});
  SensorModel known;
  known.noise = 1e-3F;
  known.correlated_noise = {5e-4F, 0.05F};
  SensorModel fitted = known;
  fitted.correlated_noise = {};
  fit_sensor_model(patches, known);
  fit_sensor_model(patches, fitted);
  EXPECT_EQ(known.correlated_noise.height, 5e-4F);
  EXPECT_EQ(known.correlated_noise.slope_rad, 0.05F);
  EXPECT_GT(fitted.correlated_noise.height, fitted.noise);
  EXPECT_GT(fitted.correlated_noise.slope_rad, 0);
}

TEST(SensorModel, GrowsWithItsPowerOfRange) {
  SensorModel model;
  model.range = 0.5F;
  model.noise = 3e-3F;
  model.correlated_noise = {4e-3F, 0.1F};
  model.exponent = 2;
  EXPECT_FLOAT_EQ(model.noise_at(0.5F), 3e-3F);
  EXPECT_FLOAT_EQ(model.noise_at(1), 4 * 3e-3F);
  EXPECT_FLOAT_EQ(model.correlated_noise_at(1).height, 4 * 4e-3F);
  EXPECT_FLOAT_EQ(model.correlated_noise_at(1).slope_rad, 0.1F);
  EXPECT_FLOAT_EQ(model.error_at(1), 4 * 5e-3F);
  EXPECT_FLOAT_EQ(model.error_at(-1), 5e-3F) << "nothing is seen there";
  EXPECT_FLOAT_EQ(model.range_of_growth(4), 1);
  EXPECT_FLOAT_EQ(model.noise_at(model.range_of_growth(0.3F)), 0.3F * 3e-3F);
  model.exponent = 0;
  EXPECT_EQ(model.range_of_growth(0.9F), 0) << "errors are larger at any range";
  EXPECT_EQ(model.range_of_growth(1.1F), std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace trivet::kernels
