#include "kernels/simulation/add_noise.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kMany = 20000;

/// Moments of a sample. Tolerances are 5 standard errors: a correct kernel fails once in 2 million.
struct Moments {
  double n, mean, sigma, kurtosis;

  explicit Moments(const std::vector<double>& values)
      : n(static_cast<double>(values.size())), mean(0), sigma(0), kurtosis(0) {
    for (const double v : values) mean += v / n;
    for (const double v : values) sigma += (v - mean) * (v - mean) / n;
    for (const double v : values) kurtosis += std::pow(v - mean, 4) / (n * sigma * sigma);
    sigma = std::sqrt(sigma);
  }
  /// Standard errors of a normal sample: sigma / sqrt(n), sigma / sqrt(2 n), sqrt(24 / n).
  void expect_normal(double expected_sigma) const {
    EXPECT_NEAR(mean, 0, 5 * expected_sigma / std::sqrt(n));
    EXPECT_NEAR(sigma, expected_sigma, 5 * expected_sigma / std::sqrt(2 * n));
    EXPECT_NEAR(kurtosis, 3, 5 * std::sqrt(24 / n));
  }
};

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const Moments of_a(a), of_b(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - of_a.mean) * (b[i] - of_b.mean);
  return sum / (of_a.n * of_a.sigma * of_b.sigma);
}

std::vector<double> differences(std::span<const float> a, std::span<const float> b) {
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i)
    out.push_back(static_cast<double>(a[i]) - static_cast<double>(b[i]));
  return out;
}

/// All noise kernels, for properties common to them.
using Kernel = std::function<void(PointsView, std::uint64_t, std::size_t, PointsSpan)>;
const std::vector<Kernel> kKernels{
    [](PointsView points, std::uint64_t seed, std::size_t first, PointsSpan out) {
      add_gaussian_noise(points, 0.25F, seed, first, out);
    },
    [](PointsView points, std::uint64_t seed, std::size_t first, PointsSpan out) {
      add_ray_noise(points, {0.5F, 0.25F, -3}, 0.25F, seed, first, out);
    },
    [](PointsView points, std::uint64_t seed, std::size_t first, PointsSpan out) {
      add_shot_noise(points, {Vector3f(-2, -2, -2), Vector3f(2, 2, 2)}, 0.5, seed, first, out);
    }};

Points disturbed(const Kernel& kernel, PointsView points, std::uint64_t seed = 1) {
  Points out(points.size());
  kernel(points, seed, 0, out);
  return out;
}

TEST(AddNoise, GivesTheSameBitsForAnyChunkingAndInPlace) {
  for (const Kernel& kernel : kKernels) {
    for (const std::size_t n : test::kSmallSizes) {
      const Points points = test::Random(n).dyadic_cloud(n);
      const Points whole = disturbed(kernel, points);
      for (const std::size_t grain : {1, 7, 64}) {
        Points out(n);
        test::for_chunks(n, grain, [&](std::size_t first, std::size_t count) {
          kernel(points.view().slice(first, count), 1, first, out.span().slice(first, count));
        });
        EXPECT_TRUE(test::same_bits(out, whole)) << n << " points by " << grain;
      }
      Points in_place = points;
      kernel(in_place, 1, 0, in_place);
      EXPECT_TRUE(test::same_bits(in_place, whole));
    }
  }
}

TEST(AddNoise, DiffersBySeed) {
  const Points points = test::Random().dyadic_cloud(kMany);
  for (const Kernel& kernel : kKernels) {
    const Points a = disturbed(kernel, points, 1), b = disturbed(kernel, points, 2);
    const double r = correlation(differences(a.view().x, points.view().x),
                                 differences(b.view().x, points.view().x));
    // Shot noise shifts each point towards the middle, so its shifts are correlated by design.
    if (&kernel != &kKernels[2]) {
      EXPECT_NEAR(r, 0, 5 / std::sqrt(kMany));
    }
    EXPECT_FALSE(test::same_bits(a, b));
  }
}

TEST(AddNoise, AllocatesNothing) {
  const Points points = test::Random().dyadic_cloud(100);
  Points out(points.size());
  const Vector3f low(-1, -1, -1), high(1, 1, 1);
  EXPECT_EQ(test::allocations_in([&] {
              add_gaussian_noise(points, 1, 0, 0, out);
              add_ray_noise(points, low, 1, 0, 0, out);
              add_shot_noise(points, {low, high}, 0.5, 0, 0, out);
            }),
            0U);
}

TEST(AddNoise, LeavesWhatIsNotFinite) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  Points points(2);
  points.set(0, {kNaN, 0, 0});
  points.set(1, {1, 1, std::numeric_limits<float>::infinity()});
  for (const Kernel& kernel : {kKernels[0], kKernels[1]}) {
    const Points out = disturbed(kernel, points);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_FALSE(out[i].allFinite());
  }
}

TEST(AddGaussianNoise, HasTheStandardDeviationOnEveryAxis) {
  const Points points(kMany);  // all at the origin: only the noise is rounded
  for (const float sigma : {1e-3F, 1.0F, 250.0F}) {
    Points out(kMany);
    add_gaussian_noise(points, sigma, 5, 0, out);
    const auto x = differences(out.view().x, points.view().x);
    const auto y = differences(out.view().y, points.view().y);
    const auto z = differences(out.view().z, points.view().z);
    for (const auto& axis : {x, y, z}) Moments(axis).expect_normal(static_cast<double>(sigma));
    const double tolerance = 5 / std::sqrt(kMany);  // of a correlation of independent numbers
    EXPECT_NEAR(correlation(x, y), 0, tolerance);
    EXPECT_NEAR(correlation(y, z), 0, tolerance);
    EXPECT_NEAR(correlation(z, x), 0, tolerance);
    std::vector<double> next(x.begin() + 1, x.end());
    next.push_back(x[0]);
    EXPECT_NEAR(correlation(x, next), 0, tolerance) << "from point to point";
  }
}

TEST(AddGaussianNoise, DoesNothingWithoutNoise) {
  const Points points = test::Random().dyadic_cloud(100);
  Points out(100);
  add_gaussian_noise(points, 0, 5, 0, out);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(out[i], points[i]);
}

TEST(AddRayNoise, MovesAlongTheRayByTheStandardDeviation) {
  const Points points = test::Random().dyadic_cloud(kMany);
  const Vector3f viewpoint(0.5F, -0.25F, -6);
  Points out(kMany);
  add_ray_noise(points, viewpoint, 0.5F, 5, 0, out);
  std::vector<double> along;
  for (std::size_t i = 0; i < kMany; ++i) {
    const Vector3d ray = (points[i] - viewpoint).cast<double>().normalized();
    const Vector3d moved = (out[i] - points[i]).cast<double>();
    along.push_back(ray.dot(moved));
    // Coordinates below 16 are rounded to 2^-21 or less, and their differences once more.
    ASSERT_LT((moved - along.back() * ray).norm(), 1e-5);
  }
  Moments(along).expect_normal(0.5);
}

TEST(AddRayNoise, KeepsAPointAtTheViewpoint) {
  Points points(1), out(1);
  points.set(0, {1, 2, 3});
  add_ray_noise(points, {1, 2, 3}, 0.5F, 5, 0, out);
  EXPECT_EQ(out[0], points[0]);
}

TEST(AddRayNoise, TurnsWithTheCloud) {
  const Points points = test::Random().dyadic_cloud(500);
  Eigen::Matrix3f quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Vector3f viewpoint(0.5F, -0.25F, -6);
  Points out(500), turned(500);
  add_ray_noise(points, viewpoint, 0.5F, 5, 0, out);
  add_ray_noise(test::transformed(points, quarter, Vector3f::Zero()), quarter * viewpoint, 0.5F, 5,
                0, turned);
  // The order of a sum of three squares may change the last bit.
  for (std::size_t i = 0; i < 500; ++i) EXPECT_LT((turned[i] - quarter * out[i]).norm(), 1e-5F);
}

TEST(AddShotNoise, MovesTheShareUniformlyIntoTheBox) {
  const Points points = [] {  // outside the box, so that moved points are detected
    Points out(kMany);
    for (std::size_t i = 0; i < kMany; ++i) out.set(i, {50, 50, 50});
    return out;
  }();
  const Vector3f low(-1, 2, 10), high(1, 2.5F, 40);
  Points before;
  for (const double share : {0.002, 0.05, 0.5}) {
    Points out(kMany);
    add_shot_noise(points, {low, high}, share, 5, 0, out);
    std::vector<std::vector<double>> place(3);
    for (std::size_t i = 0; i < kMany; ++i) {
      if (out[i] == points[i]) continue;
      ASSERT_TRUE((out[i].array() >= low.array()).all() && (out[i].array() <= high.array()).all());
      if (!before.empty()) {
        EXPECT_TRUE(before[i] == points[i] || before[i] == out[i]);
      }
      for (int axis = 0; axis < 3; ++axis) {
        const double from = static_cast<double>(low[axis]), to = static_cast<double>(high[axis]);
        place[static_cast<std::size_t>(axis)].push_back((static_cast<double>(out[i][axis]) - from) /
                                                        (to - from));
      }
    }
    // Binomial: variance n p (1 - p). Uniform on 0..1: variance 1/12, fourth moment 1/80.
    const double n = kMany, k = static_cast<double>(place[0].size());
    EXPECT_NEAR(k, n * share, 5 * std::sqrt(n * share * (1 - share)));
    for (const auto& axis : place) {
      const Moments moments(axis);
      EXPECT_NEAR(moments.mean, 0.5, 5 * std::sqrt(1 / (12 * k)));
      EXPECT_NEAR(moments.sigma * moments.sigma, 1.0 / 12,
                  5 * std::sqrt((1.0 / 80 - 1.0 / 144) / k) + 1 / (12 * k));
    }
    EXPECT_NEAR(correlation(place[0], place[1]), 0, 5 / std::sqrt(k));
    before = out;
  }
}

TEST(AddShotNoise, MovesNoneOrAll) {
  const Points points = test::Random().dyadic_cloud(500);
  Points out(500);
  const Eigen::AlignedBox3f box(Vector3f(10, 10, 10), Vector3f(11, 11, 11));
  add_shot_noise(points, box, 0, 5, 0, out);
  EXPECT_TRUE(test::same_bits(out, points));
  add_shot_noise(points, box, 1, 5, 0, out);
  for (std::size_t i = 0; i < 500; ++i) EXPECT_GE(out[i].minCoeff(), 10);
}

}  // namespace
}  // namespace trivet::kernels
