#include "kernels/verification/pose_errors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

const Camera kCamera{60, 55, 30.5, 25.25, 1};
const std::vector<Isometry3d> kNoSymmetry{Isometry3d::Identity()};

Isometry3d turn_about(const Vector3d& point, const Vector3d& axis, double degrees) {
  const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, axis.normalized());
  return Isometry3d(Eigen::Translation3d(point) * turn * Eigen::Translation3d(-point));
}
Isometry3d shift_by(const Vector3d& shift) { return Isometry3d(Eigen::Translation3d(shift)); }

Symmetry round_about(const Vector3f& point, const Vector3f& axis) {
  return {{}, Symmetry::Axis{axis, point}, true};
}

TEST(DiscretizeSymmetry, GivesTheIdentityAlone) {
  const auto poses = discretize_symmetry({});
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_TRUE(poses[0].isApprox(Isometry3d::Identity()));
}

TEST(DiscretizeSymmetry, ListsDiscreteOnesAfterTheIdentity) {
  Symmetry symmetry;
  symmetry.poses.emplace_back(turn_about({1, 2, 3}, Vector3d::UnitX(), 180).cast<float>());
  const auto poses = discretize_symmetry(symmetry);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_TRUE(poses[0].isApprox(Isometry3d::Identity()));
  EXPECT_TRUE(poses[1].isApprox(symmetry.poses[0].cast<double>()));
}

TEST(DiscretizeSymmetry, TurnsAboutTheAxisByAtMostAHundredthOfTheDiameter) {
  const Vector3f point(4, 5, 6);
  const auto poses = discretize_symmetry(round_about(point, Vector3f(1, 2, 2) / 3));
  ASSERT_EQ(poses.size(), 315U);
  EXPECT_TRUE(poses[0].isApprox(Isometry3d::Identity()));
  const Vector3d axis = Vector3d(1, 2, 2) / 3, far = point.cast<double>() + Vector3d(0, 0.5, -0.5);
  const double diameter = std::numbers::sqrt2;  // of a disc about the axis with `far` on its rim
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector3d on_axis = point.cast<double>() + 7 * axis;
    EXPECT_LT((poses[i] * on_axis - on_axis).norm(), 1e-6);
    const Isometry3d& next = poses[(i + 1) % poses.size()];
    EXPECT_LE((poses[i] * far - next * far).norm(), 0.01 * diameter);
    EXPECT_GE((poses[i] * far - next * far).norm(), 0.00995 * diameter);
  }
}

TEST(DiscretizeSymmetry, LetsEveryTurnFollowEachDiscreteOne) {
  Symmetry symmetry = round_about(Vector3f::Zero(), Vector3f::UnitZ());
  symmetry.poses.emplace_back(turn_about({0, 0, 1}, Vector3d::UnitX(), 180).cast<float>());
  const auto poses = discretize_symmetry(symmetry);
  ASSERT_EQ(poses.size(), 630U);
  EXPECT_TRUE(poses[315].isApprox(symmetry.poses[0].cast<double>()));
  // The flip moves (0, 0, 0) to (0, 0, 2), and no rotation about z moves it from there.
  for (std::size_t i = 315; i < poses.size(); ++i)
    EXPECT_LT((poses[i] * Vector3d::Zero() - Vector3d(0, 0, 2)).norm(), 1e-6);
}

TEST(Mssd, IsTheShift) {
  const Points box = test::box({-1, -2, -3}, {1, 2, 3}).vertices;
  const Isometry3d truth = turn_about({1, 1, 1}, {1, 2, 3}, 40);
  EXPECT_NEAR(mssd(box, truth, truth, kNoSymmetry), 0, 1e-12);
  EXPECT_NEAR(mssd(box, shift_by({3, 0, 4}) * truth, truth, kNoSymmetry), 5, 1e-12);
}

// A half turn about z moves the corners (1, 2) of the base to the other side.
TEST(Mssd, IsThatOfTheFarthestVertex) {
  const Points box = test::box({-1, -2, -3}, {1, 2, 3}).vertices;
  const Isometry3d half = turn_about(Vector3d::Zero(), Vector3d::UnitZ(), 180);
  EXPECT_NEAR(mssd(box, half, Isometry3d::Identity(), kNoSymmetry), 2 * std::sqrt(5.0), 1e-12);
  const std::vector<Isometry3d> symmetries{Isometry3d::Identity(), half};
  EXPECT_NEAR(mssd(box, half, Isometry3d::Identity(), symmetries), 0, 1e-12);
}

// The symmetry acts in the model frame: first S, then the ground-truth pose.
TEST(Mssd, AppliesSymmetriesInTheModelsFrame) {
  const Points box = test::box({9, 8, 7}, {11, 12, 13}).vertices;
  const Isometry3d half = turn_about({10, 10, 10}, Vector3d::UnitZ(), 180);
  const Isometry3d truth = shift_by({5, 6, 7}) * turn_about({1, 1, 1}, {1, 2, 3}, 40);
  const std::vector<Isometry3d> symmetries{Isometry3d::Identity(), half};
  EXPECT_NEAR(mssd(box, truth * half, truth, symmetries), 0, 1e-12);
  EXPECT_GT(mssd(box, half * truth, truth, symmetries), 1);
}

// The remaining error is half a step between two of 315 rotations: 2 r sin(pi / 630).
TEST(Mssd, OfARoundModelIsAtMostHalfAStep) {
  Points rim;
  for (int i = 0; i < 100; ++i)
    rim.push_back({std::cos(static_cast<float>(i)), std::sin(static_cast<float>(i)), 1});
  const auto symmetries = discretize_symmetry(round_about(Vector3f::Zero(), Vector3f::UnitZ()));
  test::Random random;
  for (int i = 0; i < 20; ++i) {
    const Isometry3d turned = turn_about(Vector3d::Zero(), Vector3d::UnitZ(),
                                         static_cast<double>(random.uniform(-180, 180)));
    EXPECT_LE(mssd(rim, turned, Isometry3d::Identity(), symmetries),
              2 * std::sin(std::numbers::pi / 630) + 1e-6);
  }
}

/// The error from its definition, in nested loops.
double naive(PointsView vertices, const Isometry3d& estimate, const Isometry3d& truth,
             const std::vector<Isometry3d>& symmetries, const Camera* camera) {
  const auto image = [&](const Vector3d& p) -> Vector3d {
    if (!camera) return p;
    return {camera->fx * p.x() / p.z() + camera->cx, camera->fy * p.y() / p.z() + camera->cy, 0};
  };
  double least = std::numeric_limits<double>::infinity();
  for (const Isometry3d& S : symmetries) {
    double greatest = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Vector3d x = vertices[i].cast<double>();
      const Vector3d there = truth * Vector3d(S * x);
      greatest = std::max(greatest, (image(estimate * x) - image(there)).norm());
    }
    least = std::min(least, greatest);
  }
  return least;
}

TEST(MssdAndMspd, AgreeWithTheirDefinitionsOnRandomPoses) {
  test::Random random;
  for (const std::size_t n : {1U, 2U, 3U, 50U, 300U}) {
    const Points vertices = random.surface(n, 0.3F);
    Symmetry symmetry = round_about(Vector3f(0.1F, 0, 0), Vector3f::UnitY());
    symmetry.poses.push_back(random.motion(0.1F));
    const auto symmetries = discretize_symmetry(symmetry);
    for (int i = 0; i < 10; ++i) {
      Pose truth = random.motion(1);
      truth.translation().z() += 6;
      const Isometry3d b(truth.cast<double>()), a(b * random.motion(0.3F).cast<double>());
      EXPECT_NEAR(mssd(vertices, a, b, symmetries), naive(vertices, a, b, symmetries, nullptr),
                  1e-9);
      EXPECT_NEAR(mspd(vertices, kCamera, a, b, symmetries),
                  naive(vertices, a, b, symmetries, &kCamera), 1e-9);
    }
  }
}

// A shift of 0.2 across the axis moves the image of the nearest corner, at z = 4, by 60 * 0.2 / 4.
TEST(Mspd, IsTheShiftInTheImageOfTheNearestVertex) {
  const Points box = test::box({-1, -1, 4}, {1, 1, 6}).vertices;
  const Isometry3d truth = Isometry3d::Identity();
  EXPECT_NEAR(mspd(box, kCamera, shift_by({0.2, 0, 0}), truth, kNoSymmetry), 3, 1e-12);
  EXPECT_NEAR(mspd(box, kCamera, shift_by({0, 0.2, 0}), truth, kNoSymmetry), 2.75, 1e-12);
}

TEST(Mspd, IsInfiniteForAVertexInTheCamerasPlane) {
  Points point;
  point.push_back({0, 0, 4});
  EXPECT_EQ(mspd(point, kCamera, shift_by({1, 0, -4}), Isometry3d::Identity(), kNoSymmetry),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(mspd(point, kCamera, shift_by({0, 0, -4}), Isometry3d::Identity(), kNoSymmetry),
            std::numeric_limits<double>::infinity());
}

TEST(DepthsToDistances, MultipliesByTheLengthOfTheRay) {
  const Camera camera{2, 4, 1, 1, 1};
  std::vector<float> depths{2, 2, 2, 0, 3, 3};
  depths_to_distances(camera, 3, depths);
  const double corner = 2 * std::sqrt(1 + 0.25 + 0.0625);
  EXPECT_FLOAT_EQ(depths[0], static_cast<float>(corner));
  EXPECT_FLOAT_EQ(depths[1], static_cast<float>(2 * std::sqrt(1 + 0.0625)));
  EXPECT_FLOAT_EQ(depths[2], static_cast<float>(corner));
  EXPECT_EQ(depths[3], 0);
  EXPECT_EQ(depths[4], 3);
  EXPECT_FLOAT_EQ(depths[5], static_cast<float>(3 * std::sqrt(1.25)));
}

/// Images of 8 x 6 pixels with surfaces that fill rectangles at constant distance.
class Vsd : public testing::Test {
 protected:
  static constexpr std::uint32_t kWidth = 8, kHeight = 6;
  using Image = std::vector<float>;

  static Image image(float distance = 0) { return Image(kWidth * kHeight, distance); }
  static void fill(Image& image, const PixelWindow& where, float distance) {
    for (std::uint32_t v = where.top; v < where.top + where.height; ++v) {
      for (std::uint32_t u = where.left; u < where.left + where.width; ++u)
        image[v * kWidth + u] = distance;
    }
  }
  static Image with(const PixelWindow& where, float distance) {
    Image out = image();
    fill(out, where, distance);
    return out;
  }
  /// The errors with delta 0.5, diameter 2 and tolerances of 0.1, 0.2 and 0.4 diameters.
  std::array<double, 3> errors(const Image& estimate, const Image& truth) const {
    const PixelWindow whole{0, 0, kWidth, kHeight};
    std::array<double, 3> out{-1, -1, -1};
    vsd({whole, measured}, {whole, estimate}, {whole, truth}, {0.5, 2, kTaus}, out);
    return out;
  }
  static std::array<double, 3> all(double value) { return {value, value, value}; }

  static constexpr std::array<double, 3> kTaus{0.1, 0.2, 0.4};
  static constexpr PixelWindow kLeft{0, 0, 4, 6}, kRight{4, 0, 4, 6};
  Image measured = image(10);
};

TEST_F(Vsd, IsZeroForOnePose) {
  const Image shown = with({2, 1, 3, 4}, 10);
  EXPECT_EQ(errors(shown, shown), all(0));
}

TEST_F(Vsd, IsOneForPosesWithoutACommonPixel) {
  EXPECT_EQ(errors(with(kLeft, 10), with(kRight, 10)), all(1));
}

TEST_F(Vsd, IsOneWhereNothingIsVisible) {
  EXPECT_EQ(errors(image(), image()), all(1));
  EXPECT_EQ(errors(with(kLeft, 11), with(kLeft, 11)), all(1)) << "behind what was measured";
}

// 0.5 of 2 is 0.25 diameters: beyond 0.1 and 0.2, within 0.4.
TEST_F(Vsd, CountsPixelsThatAreApartByTheTolerance) {
  const std::array<double, 3> expected{1, 1, 0};
  EXPECT_EQ(errors(with(kLeft, 9.5F), with(kLeft, 10)), expected);
  EXPECT_EQ(errors(with(kLeft, 10), with(kLeft, 9.5F)), expected);
}

// 0.375 and 0.5 are exact in float.
TEST_F(Vsd, TreatsPixelsApartByJustTheToleranceAsWrong) {
  const PixelWindow whole{0, 0, kWidth, kHeight};
  const Image a = with(kLeft, 10), b = with(kLeft, 9.5F);
  constexpr std::array<double, 2> taus{0.25, 0.2501};
  std::array<double, 2> out{};
  vsd({whole, measured}, {whole, b}, {whole, a}, {0.5, 2, taus}, out);
  EXPECT_EQ(out, (std::array<double, 2>{1, 0}));
}

// 24 pixels each, 12 of them common: 24 of 36 are visible in one pose only.
TEST_F(Vsd, CountsPixelsOfOnePoseOnly) {
  EXPECT_EQ(errors(with({2, 0, 4, 6}, 10), with(kLeft, 10)), all(24.0 / 36));
}

// Of 12 common pixels, 6 agree at 0.1; the 24 others are wrong at any tolerance.
TEST_F(Vsd, AddsBothKindsOfWrongPixels) {
  Image estimate = with({2, 0, 4, 6}, 10);
  fill(estimate, {2, 0, 2, 3}, 9.25F);  // 0.375 diameters
  const std::array<double, 3> expected{30.0 / 36, 30.0 / 36, 24.0 / 36};
  EXPECT_EQ(errors(estimate, with(kLeft, 10)), expected);
}

TEST_F(Vsd, TreatsSurfacesAsVisibleWhereNothingWasMeasured) {
  measured = image(0);
  EXPECT_EQ(errors(with(kLeft, 20), with(kLeft, 20)), all(0));
  EXPECT_EQ(errors(with(kLeft, 20), with(kRight, 20)), all(1));
}

// An object at 5 occludes the left half of the truth: only the visible half counts.
TEST_F(Vsd, LeavesOutWhatAnotherObjectHides) {
  fill(measured, kLeft, 5);
  const PixelWindow whole{0, 0, kWidth, kHeight};
  EXPECT_EQ(errors(with(whole, 10), with(whole, 10)), all(0));
  EXPECT_EQ(errors(with(kRight, 10), with(whole, 10)), all(0)) << "the hidden half is not missed";
  EXPECT_EQ(errors(with(whole, 4.5F), with(whole, 10)), all(1)) << "before the object it is seen";
}

TEST_F(Vsd, HidesASurfaceMoreThanDeltaBehindTheMeasurement) {
  const Image at = with(kLeft, 10.5F), beyond = with(kLeft, 10.625F);
  EXPECT_EQ(errors(at, at), all(0)) << "just delta";
  EXPECT_EQ(errors(beyond, beyond), all(1)) << "nothing of it is visible";
}

// The estimate lies 0.75 behind the measurement, invisible by itself, but the truth is visible
// there: the pixels are common, and 0.375 diameters apart.
TEST_F(Vsd, CountsTheEstimateAsVisibleWhereTheTruthIs) {
  const std::array<double, 3> expected{1, 1, 0};
  EXPECT_EQ(errors(with(kLeft, 10.75F), with(kLeft, 10)), expected);
  Image wide = with({0, 0, 8, 6}, 11);  // its right half is hidden, and does not count as an error
  fill(wide, kLeft, 10);
  EXPECT_EQ(errors(wide, with(kLeft, 10)), all(0));
  // In the opposite case the truth is hidden: the estimate's pixels are all wrong.
  EXPECT_EQ(errors(with(kLeft, 10), with(kLeft, 11)), all(1));
}

TEST_F(Vsd, GivesTheSameForWindowsAsForFullImages) {
  test::Random random;
  for (int round = 0; round < 200; ++round) {
    const auto window = [&] {
      const std::uint32_t left = random.below(8), top = random.below(6);
      return PixelWindow{left, top, random.below(9 - left), random.below(7 - top)};
    };
    const auto distance = [&] {
      return random.below(3) == 0 ? 0 : 9 + 0.125F * static_cast<float>(random.below(20));
    };
    for (float& value : measured) value = distance();
    const PixelWindow a = window(), b = window();
    Image small_a(a.size()), small_b(b.size()), large_a = image(), large_b = image();
    const auto draw = [&](const PixelWindow& where, Image& small, Image& large) {
      for (std::size_t i = 0; i < small.size(); ++i) {
        small[i] = distance();
        large[(where.top + i / where.width) * kWidth + where.left + i % where.width] = small[i];
      }
    };
    draw(a, small_a, large_a);
    draw(b, small_b, large_b);
    std::array<double, 3> out{};
    vsd({{0, 0, kWidth, kHeight}, measured}, {a, small_a}, {b, small_b}, {0.5, 2, kTaus}, out);
    EXPECT_EQ(out, errors(large_a, large_b));
  }
}

TEST(PoseErrors, AllocateNothing) {
  const Points box = test::box({-1, -1, 4}, {1, 1, 6}).vertices;
  const Isometry3d truth = Isometry3d::Identity(), estimate = shift_by({0.2, 0, 0});
  std::vector<float> distance(48, 5);
  const DistanceMap map{{0, 0, 8, 6}, distance};
  constexpr std::array<double, 2> taus{0.1, 0.2};
  std::array<double, 2> errors{};
  EXPECT_EQ(test::allocations_in([&] {
              mssd(box, estimate, truth, kNoSymmetry);
              mspd(box, kCamera, estimate, truth, kNoSymmetry);
              depths_to_distances(kCamera, 8, distance);
              vsd(map, map, map, {0.1, 1, taus}, errors);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
