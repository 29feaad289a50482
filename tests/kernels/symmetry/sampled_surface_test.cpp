#include "kernels/symmetry/sampled_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/common/pose_math.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;

constexpr double kMinCosine = SampledSurface::kMinCosine;
constexpr double kMaxSlack = SampledSurface::kMaxSlack;
constexpr double kThickness = 0.01;  // of a single sheet

/// The definition in double: every sample is compared with all others.
class NaiveSurface {
 public:
  explicit NaiveSurface(const SampledSurface& surface) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      points_.push_back(surface.points()[i].cast<double>());
      normals_.push_back(surface.normals()[i].cast<double>());
    }
    double sum = 0;
    std::vector<double> second;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::vector<double> all{kMaxSlack}, on_sheet{kMaxSlack, kMaxSlack};
      for (std::size_t k = 0; k < points_.size(); ++k) {
        if (k == i) continue;
        const Vector3d to = points_[k] - points_[i];
        all.push_back(to.norm());
        if (normals_[k].dot(normals_[i]) >= kMinCosine &&
            std::abs(normals_[k].dot(to)) <= kThickness)
          on_sheet.push_back(to.norm());
      }
      sum += *std::ranges::min_element(all);
      std::ranges::nth_element(on_sheet, on_sheet.begin() + 1);
      second.push_back(on_sheet[1]);
    }
    const double slack = std::min(kMaxSlack, 2 * sum / static_cast<double>(points_.size()));
    for (const double gap : second) slacks_.push_back(std::clamp(1.5 * gap, slack, kMaxSlack));
  }

  /// The distance of a moved sample from the surface.
  double distance(std::size_t sample, const Pose& motion) const {
    const Vector3d q = motion.cast<double>() * points_[sample];
    const Vector3d m = motion.linear().cast<double>() * normals_[sample];
    double nearest = SampledSurface::kCap;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (normals_[k].dot(m) < kMinCosine) continue;
      const Vector3d d = q - points_[k];
      const double height = d.dot((normals_[k] + m).normalized());
      const double along = std::sqrt(std::max(0.0, d.squaredNorm() - height * height));
      nearest = std::min(nearest, std::hypot(height, std::max(0.0, along - slacks_[sample])));
    }
    return nearest;
  }

 private:
  std::vector<Vector3d> points_, normals_;
  std::vector<double> slacks_;
};

/// A part with wide faces, a narrow rim and a bore.
test::SampledShape ring() {
  const test::Shape shape = test::prism(24, test::polygon(6), -0.02, 0.02, 0.6);
  return test::sample_shape(shape.vertices, shape.triangles, 3, 700);
}

TEST(SampledSurface, MatchesWhatANaiveReferenceMatches) {
  const test::SampledShape shape = ring();
  const SampledSurface surface(shape.points, shape.normals, shape.diameter);
  const NaiveSurface naive(surface);
  test::Random random;
  constexpr float kDistance = 0.02F;
  std::vector<std::uint8_t> matched(surface.size());
  std::size_t num_matched = 0, num_apart = 0;
  for (const float turn : {0.0F, 0.05F, 0.3F, 1.2F}) {
    Pose motion(Eigen::AngleAxisf(turn, Eigen::Vector3f(1, 2, 3).normalized()));
    motion.translation() = Eigen::Vector3f(0.01F, 0, -0.02F);
    surface.mark_matched(motion, kDistance, matched);
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const double distance = naive.distance(i, motion);
      if (std::abs(distance - static_cast<double>(kDistance)) < 1e-5)
        continue;  // decided by rounding
      EXPECT_EQ(matched[i] == 1, distance < static_cast<double>(kDistance)) << i << " " << distance;
      ++(matched[i] == 1 ? num_matched : num_apart);
    }
  }
  EXPECT_GT(num_matched, 500U);
  EXPECT_GT(num_apart, 500U);
}

TEST(SampledSurface, BringsASmallMotionBack) {
  const test::SampledShape shape = ring();
  const SampledSurface surface(shape.points, shape.normals, shape.diameter);
  Pose motion(Eigen::AngleAxisf(0.05F, Eigen::Vector3f::UnitX()));
  motion.translation() = Eigen::Vector3f(0, 0, 0.02F);
  const Pose back = surface.refine(motion, 300, 5);
  EXPECT_GT(back.linear().col(2).z(), 0.9999F);
  EXPECT_LT(std::abs(back.translation().z()), 0.002F);
}

TEST(SampledSurface, AllocatesNothingWhenAsked) {
  const test::SampledShape shape = ring();
  const SampledSurface surface(shape.points, shape.normals, shape.diameter);
  std::vector<std::uint8_t> matched(surface.size());
  EXPECT_EQ(test::allocations_in([&] {
              surface.mark_matched(Pose::Identity(), 0.02F, matched);
              (void)surface.misfit(Pose::Identity(), 0.01F, 1, surface.size());
              (void)surface.refine(Pose::Identity(), 200, 2);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
