#include "kernels/verification/posed_samples.hpp"

#include <gtest/gtest.h>

#include "kernels/surfaces/visibility.hpp"
#include "support/allocations.hpp"
#include "support/analytic_scene.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

// A pose so close that some samples fall outside the image and some behind the camera.
struct Close {
  test::SampledModel ball = test::sampled_sphere(3 * kSampleBlock + 17, 0.5F);
  ImageGeometry geometry{
      test::placed({0.2F, 0.1F, 0.3F}, {0.2F, -0.1F, 0.4F}), 200, 210, 79.5F, 59.5F, 160, 120};
  Pose T_scene_model = geometry.T_camera_scene.inverse() * test::placed({0.1F, 0, 0.3F});
};

TEST(PosedSamples, PlacesThemToTheBitAsOneByOne) {
  const Close close;
  const ModelSamples samples = close.ball.view();
  const PosedSamples posed(close.geometry, samples, close.T_scene_model);
  const Pose pose = posed.T_camera_model();
  const Eigen::Matrix3f R = pose.linear();
  const Vector3f t = pose.translation();
  SampleBlock block;
  std::size_t inside = 0, next = 0;
  for (std::size_t first = 0; first < samples.points.size(); first += kSampleBlock) {
    posed.place(first, samples.points.size(), block);
    ASSERT_EQ(block.first, next);
    next += block.count;
    for (std::size_t k = 0; k < block.count; ++k) {
      const std::size_t i = first + k;
      const Vector3f m = samples.points[i], mn = samples.normals[i];
      Vector3f p, n;
      for (int row = 0; row < 3; ++row) {
        p[row] = R(row, 0) * m.x() + R(row, 1) * m.y() + R(row, 2) * m.z() + t[row];
        n[row] = R(row, 0) * mn.x() + (R(row, 1) * mn.y() + R(row, 2) * mn.z());
      }
      ASSERT_EQ(Vector3f(block.x[k], block.y[k], block.z[k]), p) << i;
      ASSERT_EQ(Vector3f(block.normal_x[k], block.normal_y[k], block.normal_z[k]), n) << i;
      const std::int64_t pixel = close.geometry.pixel_of(p);
      inside += pixel >= 0;
      ASSERT_EQ(block.column[k], pixel < 0 ? -1 : pixel % 160) << i;
      ASSERT_EQ(block.row[k], pixel < 0 ? -1 : pixel / 160) << i;
    }
  }
  EXPECT_EQ(next, samples.points.size());
  EXPECT_GT(inside, 50U);
  EXPECT_LT(inside, samples.points.size() - 100);
}

TEST(PosedSamples, DecidesVisibilityByTheViewTowardsTheCamera) {
  const Close close;
  const ModelSamples samples = close.ball.view();
  const Pose pose = close.geometry.T_camera_scene.inverse() * test::placed({0.3F, -0.4F, 5});
  const PosedSamples posed(close.geometry, samples, pose);
  const Vector3f to_camera = (close.geometry.T_camera_scene * pose).inverse().translation();
  const std::size_t view = nearest_view(to_camera);
  for (std::size_t i = 0; i < samples.points.size(); ++i)
    ASSERT_EQ(posed.is_visible(i), is_visible(samples.views[i], view)) << i;
}

TEST(PosedSamples, AllocatesNothing) {
  const Close close;
  const ModelSamples samples = close.ball.view();
  SampleBlock block;
  EXPECT_EQ(test::allocations_in([&] {
              PosedSamples(close.geometry, samples, close.T_scene_model).place(0, 10, block);
            }),
            0U);
  EXPECT_EQ(block.count, 10U);
}

}  // namespace
}  // namespace trivet::kernels
