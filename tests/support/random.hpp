/// Random test data that is the same on every run: the name of the test gives the seed.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::test {

inline const std::vector<std::size_t> kSmallSizes{0, 1, 2, 3, 7, 63, 64, 65, 500};

class Random {
 public:
  /// Seeds from the running test and a number of the case within it.
  explicit Random(std::uint64_t test_case = 0) : engine_(seed(test_case)) {}

  float uniform(float low, float high) {
    return low + (high - low) * std::uniform_real_distribution<float>(0, 1)(engine_);
  }
  float normal(float sigma) { return sigma * std::normal_distribution<float>()(engine_); }
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(engine_() % limit); }

  Eigen::Vector3f direction() {
    Eigen::Vector3f v{normal(1), normal(1), normal(1)};
    return v.norm() > 1e-3F ? v.normalized() : direction();
  }

  /// A cloud whose coordinates are multiples of 1/64 in [-extent, extent): float arithmetic on them
  /// is exact.
  Points dyadic_cloud(std::size_t n, int extent = 2) {
    Points points(n);
    const auto coordinate = [&] {
      return static_cast<float>(below(static_cast<std::uint32_t>(extent) * 128)) / 64 -
             static_cast<float>(extent);
    };
    for (std::size_t i = 0; i < n; ++i) points.set(i, {coordinate(), coordinate(), coordinate()});
    return points;
  }

  /// A gently curved sheet over [-1, 1]^2 with normal noise of this standard deviation.
  Points surface(std::size_t n, float noise = 0) {
    Points points(n);
    for (std::size_t i = 0; i < n; ++i) {
      const float x = uniform(-1, 1), y = uniform(-1, 1);
      points.set(i, {x, y, 0.2F * std::sin(2 * x) * std::cos(y) + normal(noise)});
    }
    return points;
  }

  Pose motion(float extent = 1) {
    Pose pose = Pose::Identity();
    const Eigen::Vector3f axis = direction();
    pose.linear() = Eigen::AngleAxisf(uniform(-3, 3), axis).toRotationMatrix();
    pose.translation() << uniform(-extent, extent), uniform(-extent, extent),
        uniform(-extent, extent);
    return pose;
  }

  std::vector<std::uint32_t> permutation(std::size_t n) {
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    for (std::size_t i = n; i > 1; --i) {
      std::swap(order[i - 1], order[below(static_cast<std::uint32_t>(i))]);
    }
    return order;
  }

 private:
  // FNV-1a over the test's name; printed with every failure of the test.
  static std::uint64_t seed(std::uint64_t test_case) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::uint64_t hash = 14695981039346656037U;
    for (const char c : std::string(test->test_suite_name()) + '.' + test->name()) {
      hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    }
    hash += test_case;
    testing::Test::RecordProperty("seed", std::to_string(hash));
    return hash;
  }

  std::mt19937_64 engine_;
};

inline Points transformed(PointsView points, const Eigen::Matrix3f& linear,
                          const Eigen::Vector3f& offset) {
  Points out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out.set(i, linear * points[i] + offset);
  return out;
}

/// out[i] = points[order[i]]
inline Points permuted(PointsView points, const std::vector<std::uint32_t>& order) {
  Points out(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) out.set(i, points[order[i]]);
  return out;
}

/// Whether all bits are equal, including those of NaN.
inline bool same_bits(std::span<const float> a, std::span<const float> b) {
  return std::ranges::equal(
      a, b, {}, [](float v) { return std::bit_cast<std::uint32_t>(v); },
      [](float v) { return std::bit_cast<std::uint32_t>(v); });
}
inline bool same_bits(PointsView a, PointsView b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// Calls body(first, count) for chunks of this size over [0, n).
template <class Body>
void for_chunks(std::size_t n, std::size_t grain, Body&& body) {
  for (std::size_t first = 0; first < n; first += grain) body(first, std::min(grain, n - first));
}

}  // namespace trivet::test
