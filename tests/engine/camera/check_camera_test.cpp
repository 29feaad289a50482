#include "engine/camera/check_camera.hpp"

#include <gtest/gtest.h>

#include <array>

#include "engine/common/thread_limit.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/formats/keep_points.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

/// Two instances of each of two parts in front of a wall, and one library of both parts.
class CheckCamera : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bracket_ = test::bracket();
    lever_ = test::lever();
    recognizer_ = Recognizer(test::trained_library({{"bracket", &bracket_}, {"lever", &lever_}},
                                                   {.tri_spin_images = false}));
  }

  /// The scan of a camera with a focal length of 570 pixels, written with its focal length
  /// multiplied by `focal` and its depths by `depth`.
  static Cloud scan(float focal, float depth = 1) {
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    Cloud cloud =
        test::render_scan({{&wall, Pose::Identity()},
                           {&bracket_, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0.1F, 0.85F})},
                           {&bracket_, test::pose_of({-0.5F, 2.2F, 0.6F}, {0.16F, 0.12F, 0.9F})},
                           {&lever_, test::pose_of({-0.6F, 0.5F, 1.9F}, {0.12F, -0.12F, 0.8F})},
                           {&lever_, test::pose_of({1.6F, -0.4F, 0.3F}, {-0.14F, -0.14F, 0.9F})}});
    cloud.camera->fx *= static_cast<double>(focal);
    cloud.camera->fy *= static_cast<double>(focal);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Eigen::Vector3f p = depth * cloud.points[i];
      cloud.points.set(i, {p.x() / focal, p.y() / focal, p.z()});
    }
    return cloud;
  }
  static SceneResult recognized(const Cloud& cloud) {
    const Result<SceneResult> result = recognize(recognizer_, cloud, {}, {.method = Method::ppf});
    EXPECT_TRUE(result) << result.error().message;
    return *result;
  }
  static CameraCheck check(const Cloud& cloud) {
    const SceneResult result = recognized(cloud);
    EXPECT_TRUE(result.stats.camera_check);
    return result.stats.camera_check.value_or(CameraCheck{});
  }

  static inline test::Shape bracket_, lever_;
  static inline Recognizer recognizer_{Library{}};
};

TEST_F(CheckCamera, FindsNothingWrongWithTheRightCamera) {
  const CameraCheck found = check(scan(1));
  ASSERT_TRUE(found.scale);
  EXPECT_GE(found.objects.size(), 3U);
  EXPECT_NEAR(found.scale->focal.value, 1, 0.004);
  EXPECT_FALSE(found.focal_is_off());
  EXPECT_FALSE(found.depth_is_off());
  EXPECT_FALSE(corrected_camera(found));
}

TEST_F(CheckCamera, DetectsAFocalLengthThatIsFourPercentOff) {
  for (const float wrong : {0.96F, 1.04F}) {
    const CameraCheck found = check(scan(wrong));
    EXPECT_TRUE(found.focal_is_off());
    EXPECT_FALSE(found.depth_is_off());
    const std::optional<Camera> corrected = corrected_camera(found);
    ASSERT_TRUE(corrected);
    EXPECT_NEAR(corrected->fx, 570, 570 * 0.005);
    EXPECT_NEAR(corrected->fy, 570, 570 * 0.005);
    EXPECT_EQ(corrected->cx, 319.5);
  }
}

TEST_F(CheckCamera, DetectsDepthsThatAreOnePercentAndAHalfOff) {
  const CameraCheck found = check(scan(1, 1.015F));
  EXPECT_FALSE(found.focal_is_off());
  EXPECT_TRUE(found.depth_is_off());
  EXPECT_NEAR(corrected_camera(found)->depth_scale, 1 / 1.015, 0.003);
}

/// The same values, measured as one kind of depth, read as the other.
Cloud read_as(DepthKind kind, Cloud cloud) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    const float cosine = p.z() / p.norm();
    cloud.points.set(i, (kind == DepthKind::z ? 1 / cosine : cosine) * p);
  }
  cloud.camera->depth = kind;
  return cloud;
}

// The wall is flat only for the right kind of depth.
TEST_F(CheckCamera, DetectsDepthsAlongTheRay) {
  const Cloud right = scan(1);
  const CameraCheck as_it_is = check(right);
  EXPECT_EQ(as_it_is.depth.num_as_said, 1U);
  EXPECT_FALSE(as_it_is.depth_kind_is_off());

  const CameraCheck read_as_z = check(read_as(DepthKind::z, right));
  EXPECT_TRUE(read_as_z.depth_kind_is_off());
  EXPECT_GT(read_as_z.depth.curved, 10 * read_as_z.depth.flat);
  EXPECT_TRUE(check(read_as(DepthKind::ray, right)).depth_kind_is_off()) << "and the reverse";

  const std::vector<CameraCheck> joined = join_checks(std::array{read_as_z, read_as_z});
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].depth.num_otherwise, 2U);
}

TEST_F(CheckCamera, SaysNothingOfDepthsWithoutALargePlane) {
  Cloud cloud = scan(1);
  std::vector<std::uint8_t> keep(cloud.points.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = cloud.points[i].z() < 1.3F;
  keep_points(keep, cloud);
  for (const Cloud& parts : {cloud, read_as(DepthKind::z, cloud)}) {
    const CameraCheck found = check(parts);
    EXPECT_EQ(found.depth, DepthReading{});
  }
}

TEST_F(CheckCamera, JoinsTheScenesOfACamera) {
  const CameraCheck wrong = check(scan(1.04F)), right = check(scan(1));
  const std::vector<CameraCheck> joined = join_checks(std::array{wrong, right, wrong});
  ASSERT_EQ(joined.size(), 2U);
  EXPECT_EQ(joined[0].objects.size(), 2 * wrong.objects.size());
  EXPECT_NEAR(joined[0].scale->focal.value, wrong.scale->focal.value, 1e-3);
  EXPECT_EQ(joined[1].camera, right.camera);
}

TEST_F(CheckCamera, ShootsFourTimesTheRaysOfAnExamination) {
  const SceneResult result = recognized(scan(1));
  EXPECT_LE(result.stats.camera_check->num_rays, 4 * 2500 * result.detections.size());
}

TEST_F(CheckCamera, KnowsNoCameraOfAScanThatNamesNone) {
  Cloud cloud = scan(1);
  cloud.camera.reset();
  EXPECT_FALSE(recognized(cloud).stats.camera_check);
}

TEST_F(CheckCamera, GivesTheSameBitsForAnyNumberOfThreads) {
  const Cloud cloud = scan(1.04F);
  const CameraCheck many = check(cloud);
  const ThreadLimit one(1);
  const CameraCheck few = check(cloud);
  ASSERT_TRUE(many.scale && few.scale);
  EXPECT_EQ(many.scale->focal.value, few.scale->focal.value);
  EXPECT_EQ(many.scale->focal.error, few.scale->focal.error);
}

}  // namespace
}  // namespace trivet
