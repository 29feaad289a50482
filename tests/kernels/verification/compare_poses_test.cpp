#include "kernels/verification/compare_poses.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/ray_image.hpp"
#include "support/reference_comparison.hpp"
#include "support/rendered_scene.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr float kTolerance = 0.003F;
constexpr float kNoise = 0.001F;
constexpr MeasurementErrors kErrors{kNoise, 3};

/// A rod with a slightly thicker end.
test::Shape club_shape(float end) {
  return test::box({-0.08F, -0.02F, -0.02F}, {0.06F, 0.02F, 0.02F})
      .join(test::box({0.06F, -end, -end}, {0.08F, end, end}));
}

struct Part {
  explicit Part(test::Shape of) : shape(std::move(of)) {}
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  PosedModel at(const Pose& T_scene_model) const { return {surface, samples, T_scene_model}; }

  test::Shape shape;
  RayScene surface = *RayScene::from_mesh(shape.vertices, shape.triangles);
  test::SampledShape sampled = test::sample_shape(shape.vertices, shape.triangles);
  ModelSamples samples = sampled.view();
};
const Part& club() {
  static const Part one(club_shape(0.027F));
  return one;
}

ImageGeometry camera() { return {Pose::Identity(), 150, 150, 79.5F, 59.5F, 160, 120}; }

const Pose kTruth = test::pose_of({0.6F, -0.5F, 0.3F}, {0.02F, -0.01F, 0.5F});
const Pose kFlipped = kTruth * test::pose_of({0, 0, 3.1415927F}, {0, 0, 0});

/// The depth image of clubs in front of a wall.
RangeImage render(std::initializer_list<Pose> poses, float wall = 1.5F) {
  return test::measure(camera(), club().surface, poses, wall);
}

void add_noise(test::Random& random, RangeImage& image) {
  for (float& depth : image.depth) depth += random.normal(kNoise);
}

VerifyOptions options() {
  static const std::array<std::uint8_t, 1> kBackground{1};
  VerifyOptions verify;
  verify.tolerance = kTolerance;
  verify.plane_is_background = kBackground;
  return verify;
}

PoseComparison compare(const RangeImage& image, const Pose& a, const Pose& b,
                       const MeasurementErrors& errors = kErrors) {
  CompareScratch scratch;
  return compare_poses({&image, 1}, club().at(a), club().at(b), errors, options(), scratch);
}

TEST(ComparePoses, DistinguishesAClubFromItsFlip) {
  test::Random random;
  RangeImage image = render({kTruth});
  add_noise(random, image);
  const PoseComparison c = compare(image, kTruth, kFlipped);
  EXPECT_GT(c.num_votes, 10);
  EXPECT_GT(c.log_ratio, c.num_votes) << "a vote is worth more than one unit";
  EXPECT_GT(c.z, PoseComparison::kSignificant);
  EXPECT_TRUE(c.significant());
}

TEST(ComparePoses, FindsNoDifferenceOfAPoseFromItself) {
  const PoseComparison c = compare(render({kTruth}), kTruth, kTruth);
  EXPECT_EQ(c.num_votes, 0);
  EXPECT_EQ(c.log_ratio, 0);
  EXPECT_EQ(c.z, 0);
  EXPECT_FALSE(c.significant());
}

TEST(ComparePoses, CountsNoRayWhoseMeasurementHidesBothPoses) {
  RangeImage image = render({kTruth});
  EXPECT_GT(compare(image, kTruth, kFlipped).num_measured, 50U);
  image.depth.assign(image.depth.size(), 0.3F);
  EXPECT_EQ(compare(image, kTruth, kFlipped).num_measured, 0U) << "something is in front";
  image.depth.assign(image.depth.size(), 0);
  EXPECT_EQ(compare(image, kTruth, kFlipped).num_measured, 0U) << "nothing is measured";
}

/// A random pair of poses and a depth image: clubs, noise, holes, a labeled plane.
struct Case {
  RangeImage image;
  Pose first, second;
};
Case random_case(test::Random& random) {
  const auto between = [&](float low, float high) { return random.uniform(low, high); };
  const auto turn = [&] { return Vector3f(between(-2, 2), between(-2, 2), between(-2, 2)); };
  const auto place = [&] {
    return Vector3f(between(-0.2F, 0.2F), between(-0.15F, 0.15F), between(0.7F, 0.9F));
  };
  Case out;
  const Pose truth = test::pose_of(turn(), place());
  out.image = render({truth, test::pose_of(turn(), place())}, between(0.8F, 1.2F));
  add_noise(random, out.image);
  for (std::size_t pixel = 0; pixel < out.image.depth.size(); ++pixel) {
    if (random.uniform(0, 1) < 0.1F) out.image.depth[pixel] = 0;
    out.image.plane[pixel] = pixel % 160 > 100 ? 1 : 0;
  }
  out.first = truth * test::pose_of({0, 0, 0}, 0.004F * random.direction());
  out.second = random.below(2) == 0
                   ? truth * test::pose_of({0, 0, 3.1415927F}, 0.004F * random.direction())
                   : truth * test::pose_of(0.2F * turn(), 0.02F * random.direction());
  return out;
}

TEST(ComparePoses, IsExactlyTheNegativeOfTheOtherOrder) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    test::Random random(trial);
    const Case c = random_case(random);
    const PoseComparison ab = compare(c.image, c.first, c.second);
    const PoseComparison ba = compare(c.image, c.second, c.first);
    EXPECT_EQ(ab.log_ratio, -ba.log_ratio);
    EXPECT_EQ(ab.z, -ba.z);
    EXPECT_EQ(ab.num_votes, ba.num_votes);
    EXPECT_EQ(ab.num_measured, ba.num_measured);
  }
}

TEST(ComparePoses, AgreesWithANaiveReference) {
  int informative = 0;
  for (std::uint64_t trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    test::Random random(trial);
    const Case c = random_case(random);
    const ImageGeometry g = camera();
    const float radius = 0.5F * ball_diameter(club().samples);
    const RayCrop crop(project_ball(g, c.first * club().samples.center, radius)
                           ->joined(*project_ball(g, c.second * club().samples.center, radius)),
                       0);
    ASSERT_EQ(crop.stride, 1);
    const float correlation = trial % 2 == 0 ? 0 : random.uniform(0, 1);
    const PoseComparison found = compare(c.image, c.first, c.second, {kNoise, 3, correlation});
    const reference::Comparison naive = reference::comparison(
        c.image, club().surface, static_cast<double>(club().samples.diameter), c.first, c.second,
        static_cast<double>(kNoise), static_cast<double>(correlation),
        static_cast<double>(kTolerance), crop);
    // Rounding decides a few rays at most.
    EXPECT_NEAR(found.num_votes, naive.num_votes, 0.5);
    EXPECT_NEAR(static_cast<double>(found.num_measured), naive.num_measured, 5);
    EXPECT_NEAR(found.log_ratio, naive.log_ratio, 1.5);
    EXPECT_NEAR(found.z, naive.z, 0.3);
    informative += std::abs(naive.z) > 2;
  }
  EXPECT_GT(informative, 12);
}

TEST(ComparePoses, DoesNotDependOnTheFrameOfTheScene) {
  test::Random random;
  Case c = random_case(random);
  const PoseComparison here = compare(c.image, c.first, c.second);
  const Pose moved = random.motion(1);
  c.image.geometry.T_camera_scene = moved.inverse();
  const PoseComparison there = compare(c.image, moved * c.first, moved * c.second);
  EXPECT_NEAR(here.num_votes, there.num_votes, 0.5);
  EXPECT_NEAR(here.log_ratio, there.log_ratio, 1.5);
  EXPECT_NEAR(here.z, there.z, 0.3);
}

TEST(ComparePoses, DistinguishesModelsWhereTheyDiffer) {
  const Part thicker(club_shape(0.032F));
  test::Random random;
  RangeImage image = render({kTruth});
  add_noise(random, image);
  const auto decide = [&](const RangeImage& scan, bool swapped) {
    CompareScratch scratch;
    const PosedModel right = club().at(kTruth), wrong = thicker.at(kTruth);
    return compare_poses({&scan, 1}, swapped ? wrong : right, swapped ? right : wrong, kErrors,
                         options(), scratch);
  };
  const PoseComparison direct = decide(image, false), swapped = decide(image, true);
  EXPECT_GT(direct.z, PoseComparison::kSignificant);
  EXPECT_EQ(swapped.log_ratio, -direct.log_ratio);
  EXPECT_EQ(swapped.num_votes, direct.num_votes);

  // Behind an occluder that hides the thicker end, both poses are indistinguishable.
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const Eigen::Vector3f end = kTruth * Eigen::Vector3f(0.07F, 0, 0);
    const ImageGeometry g = camera();
    const float u = g.cx + g.fx * end.x() / end.z(), v = g.cy + g.fy * end.y() / end.z();
    const auto du = static_cast<float>(i % g.width) - u, dv = static_cast<float>(i / g.width) - v;
    if (std::hypot(du, dv) < 16) image.depth[i] = 0.3F;
  }
  const PoseComparison hidden = decide(image, false);
  EXPECT_LT(std::abs(hidden.log_ratio), 0.2 * direct.log_ratio);
}

TEST(ComparePoses, AddsUpOverImages) {
  const std::array<RangeImage, 2> images{render({kTruth}), render({kTruth})};
  CompareScratch scratch;
  const PoseComparison both =
      compare_poses(images, club().at(kTruth), club().at(kFlipped), kErrors, options(), scratch);
  const PoseComparison one = compare(images[0], kTruth, kFlipped);
  EXPECT_NEAR(both.log_ratio, 2 * one.log_ratio, 1e-9);
  EXPECT_NEAR(both.num_votes, 2 * one.num_votes, 1e-9);
  EXPECT_NEAR(both.z, std::sqrt(2.0) * one.z, 1e-9);
}

TEST(ComparePoses, SaysNothingWhereTheDifferenceIsHiddenOrNotMeasured) {
  RangeImage hidden = render({kTruth});
  for (float& depth : hidden.depth) depth = std::min(depth, 0.3F);
  EXPECT_GT(compare(hidden, kTruth, kFlipped).num_votes, 10);
  EXPECT_EQ(compare(hidden, kTruth, kFlipped).z, 0);
  RangeImage empty = render({kTruth});
  empty.depth.assign(empty.depth.size(), 0);
  EXPECT_EQ(compare(empty, kTruth, kFlipped).z, 0);
}

// A sensor that matches windows shows nothing beside near surfaces and misses little of what it
// sees. A part that a pose puts into the shadow is therefore evidence against the pose.
TEST(ComparePoses, CountsWhatIsMissingWhereTheModelIsElsewhereMeasured) {
  const Pose aside = kTruth * test::pose_of({0, 0, 0}, {0, 0.01F, 0});
  RangeImage image = render({kTruth});
  const PoseComparison whole = compare(image, kTruth, aside);
  const RangeImage bare = render({});
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel)
    if (image.depth[pixel] == bare.depth[pixel]) image.depth[pixel] = 0;
  const PoseComparison shadowed = compare(image, kTruth, aside);
  EXPECT_EQ(shadowed.num_votes, whole.num_votes);
  EXPECT_GT(shadowed.z, PoseComparison::kSignificant);
  EXPECT_EQ(whole.of_missing, 0);
  EXPECT_GT(shadowed.of_missing, 10);
  EXPECT_LT(shadowed.of_missing, shadowed.log_ratio) << "the other end is measured";
}

/// A block that widens away from the camera along y, and by `side` along x.
test::Shape wedge(float side) {
  test::Shape shape = test::box({-0.04F, -0.03F, 0}, {0.04F, 0.03F, 0.09F});
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    Vector3f p = shape.vertices[i];
    if (p.z() > 0 && p.x() > 0) p.x() += side;
    if (p.z() > 0 && p.y() > 0) p.y() += 0.045F;
    shape.vertices.set(i, p);
  }
  return shape;
}

// Sensors lose surfaces that they see aslant: that a side is not measured speaks for a side that is
// as steep as another one that is lost, although most of the part is measured.
TEST(ComparePoses, ExpectsToMissWhatIsSeenAslant) {
  const Part with_side(wedge(0.045F)), without(wedge(0));
  const Pose pose = test::pose_of({0, 0, 0}, {0, 0, 0.5F});
  RangeImage image = test::measure(camera(), with_side.surface, {&pose, 1}, 1.5F);
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const bool is_front = std::abs(image.depth[pixel] - 0.5F) < 0.001F,
               is_shadow = image.depth[pixel] == 1.5F && pixel % 160 / 10 % 2 == 0;
    if ((image.depth[pixel] < 1 && !is_front) || is_shadow) image.depth[pixel] = 0;
  }
  CompareScratch scratch;
  const PoseComparison c =
      compare_poses({&image, 1}, with_side.at(pose), without.at(pose), kErrors, options(), scratch);
  EXPECT_GT(c.num_votes, 5);
  EXPECT_GT(c.log_ratio, 0.3 * c.num_votes);
}

// Smoothed over the width of a thin part, the depth has an error of many times the noise.
TEST(ComparePoses, ForgivesBlendedDepthWhereNeighborsErrAlike) {
  RangeImage image = render({kTruth});
  const RangeImage bare = render({});
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel)
    if (image.depth[pixel] != bare.depth[pixel]) image.depth[pixel] += 12 * kNoise;
  const Pose away = test::pose_of({0, 0, 0}, {0, 0, -1});  // behind the camera: no ray meets it
  EXPECT_LT(compare(image, kTruth, away).log_ratio,
            compare(image, kTruth, away, {kNoise, 3, 1}).log_ratio);
}

TEST(ComparePoses, CountsMeasurementsBehindTheModelAndPartsThatReachThroughATable) {
  const Pose aside = kTruth * test::pose_of({0, 0, 0}, {0, 0.01F, 0});
  const RangeImage image = render({kTruth});
  EXPECT_GT(compare(image, kTruth, aside).z, PoseComparison::kSignificant);

  // Both poses are hidden, but by a background plane, which cannot hide a pose.
  const Pose away = test::pose_of({0, 0, 0}, {0, 0, -1});  // behind the camera: no ray meets it
  RangeImage table = render({}, 0.3F);
  EXPECT_EQ(compare(table, kTruth, away).z, 0);
  table.plane.assign(table.plane.size(), 1);
  EXPECT_LT(compare(table, kTruth, away).z, -PoseComparison::kSignificant);

  // The poses bear on the plane, and may be let into it.
  VerifyOptions bears = options();
  bears.bearing_plane = 1;
  CompareScratch scratch;
  EXPECT_EQ(
      compare_poses({&table, 1}, club().at(kTruth), club().at(away), kErrors, bears, scratch).z, 0);
}

// Halfway between two poses neither is better; noise must not decide.
TEST(ComparePoses, IsRarelySureWhereOnlyNoiseDiffers) {
  const Pose near = test::pose_of({0, 0, 0}, {0, 0, -0.0008F}) * kTruth;
  const Pose far = test::pose_of({0, 0, 0}, {0, 0, 0.0008F}) * kTruth;
  const RangeImage exact = render({kTruth});
  double sum = 0, squares = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    test::Random random(static_cast<std::uint64_t>(trial));
    RangeImage image = exact;
    for (float& depth : image.depth)
      if (depth < 1) depth += random.normal(kNoise);
    // Outline pixels, where only one pose meets the model, are excluded.
    CompareScratch scratch;
    const PoseComparison c =
        compare_poses({&image, 1}, club().at(near), club().at(far), kErrors,
                      {.tolerance = 0.0015F, .plane_is_background = {}}, scratch);
    ASSERT_GT(c.num_votes, 20);
    sum += c.z;
    squares += c.z * c.z;
  }
  EXPECT_NEAR(squares / kTrials, 1, 0.6) << "z is in standard deviations";
  EXPECT_NEAR(sum / kTrials, 0, 0.8);
}

// Waves over many pixels are one correlated error, not many independent ones.
TEST(ComparePoses, IsNoSurerOfErrorsThatPixelsShare) {
  const Pose aside = kTruth * test::pose_of({0, 0, 0}, {0, 0.004F, 0});
  const RangeImage image = render({kTruth});
  CompareScratch scratch;
  const auto decide = [&](int together) {
    return compare_poses({&image, 1}, club().at(kTruth), club().at(aside), {kNoise, together},
                         options(), scratch);
  };
  const PoseComparison alone = decide(1), blocks = decide(12);
  EXPECT_GT(blocks.z, 0);
  EXPECT_LT(blocks.z, 0.5 * alone.z);
  EXPECT_LT(blocks.num_votes, 0.1 * alone.num_votes);
}

TEST(ComparePoses, AllocatesNothingOnceItsMemoryIsThere) {
  const RangeImage image = render({kTruth});
  CompareScratch scratch;
  const VerifyOptions verify = options();
  const auto run = [&] {
    compare_poses({&image, 1}, club().at(kTruth), club().at(kFlipped), kErrors, verify, scratch);
  };
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels
