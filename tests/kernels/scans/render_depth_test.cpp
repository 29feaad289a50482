#include "kernels/scans/render_depth.hpp"

#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_model.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Shape;

constexpr std::uint32_t kWidth = 64, kHeight = 48;
const Camera kCamera{60, 55, 30.5, 25.25, 1};

struct Image {
  std::vector<float> depth = std::vector<float>(kWidth * kHeight, -1);
  std::vector<std::uint32_t> instances = std::vector<std::uint32_t>(kWidth * kHeight, 77);
  Normals normals = Normals(kWidth * kHeight);
};

Image render(const RayScene& scene, std::uint32_t grain = kHeight) {
  Image image;
  test::for_chunks(kHeight, grain, [&](std::size_t first, std::size_t count) {
    render_depth(scene, kCamera, kWidth, static_cast<std::uint32_t>(first),
                 {std::span(image.depth).subspan(first * kWidth, count * kWidth),
                  std::span(image.instances).subspan(first * kWidth, count * kWidth),
                  image.normals.span().slice(first * kWidth, count * kWidth)});
  });
  return image;
}

Vector3f pixel_ray(std::size_t i) {
  return Eigen::Vector3d((static_cast<double>(i % kWidth) - kCamera.cx) / kCamera.fx,
                         (static_cast<double>(i / kWidth) - kCamera.cy) / kCamera.fy, 1)
      .cast<float>();
}

TEST(RenderDepth, AgreesWithASphere) {
  Points center;
  center.push_back({0, 0, 0});
  const auto sphere = RayScene::from_spheres(center, 0.5F);
  ASSERT_TRUE(sphere);
  Pose pose = Pose::Identity();
  pose.translation() << 0.2F, -0.1F, 3;
  const std::array instances{RayScene::Instance{&*sphere, pose}};
  const auto scene = RayScene::from_instances(instances);
  ASSERT_TRUE(scene);
  const Image image = render(*scene);
  int num_hits = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const double expected =
        reference::ray_sphere(Vector3f::Zero(), pixel_ray(i), {0.2F, -0.1F, 3}, 0.5);
    if (expected < reference::kInfinity) {
      ++num_hits;
      EXPECT_NEAR(image.depth[i], expected, 2e-3) << i;  // the last pixels graze the sphere
      EXPECT_EQ(image.instances[i], 0U);
    } else {
      EXPECT_EQ(image.depth[i], 0);
      EXPECT_EQ(image.instances[i], Hit::kNone);
    }
  }
  EXPECT_GT(num_hits, 200);
}

// On the plane n . p = h the depth is h / (n . ray), where the ray has z = 1.
TEST(RenderDepth, AgreesWithATiltedPlane) {
  Shape plane;
  plane.add({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
  const auto flat = RayScene::from_mesh(plane.vertices, plane.triangles);
  ASSERT_TRUE(flat);
  Pose pose = Pose::Identity();
  pose.translation() << 0, 0, 2;
  pose.linear() = Eigen::AngleAxisf(0.5F, Vector3f(1, 1, 0).normalized()).toRotationMatrix();
  const std::array instances{RayScene::Instance{&*flat, pose}};
  const auto scene = RayScene::from_instances(instances);
  ASSERT_TRUE(scene);
  const Vector3f normal = pose.linear().col(2);
  const Image image = render(*scene);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const float expected = 2 * normal.z() / normal.dot(pixel_ray(i));
    EXPECT_NEAR(image.depth[i], expected, 2e-6F * expected) << i;
    EXPECT_LT((image.normals[i] + normal).norm(), 1e-6F) << i << ": towards the camera";
  }
}

TEST(RenderDepth, NamesTheInstanceInFront) {
  const Shape cube = test::box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  const auto model = RayScene::from_mesh(cube.vertices, cube.triangles);
  ASSERT_TRUE(model);
  Pose behind = Pose::Identity(), front = Pose::Identity();
  behind.translation() << 0.25F, 0, 4;
  front.translation() << -0.25F, 0, 2;
  const std::array instances{RayScene::Instance{&*model, behind},
                             RayScene::Instance{&*model, front}};
  const auto scene = RayScene::from_instances(instances);
  ASSERT_TRUE(scene);
  const Image image = render(*scene);
  int num_behind = 0, num_front = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    if (image.instances[i] == 0) ++num_behind;
    if (image.instances[i] != 1) continue;
    ++num_front;
    EXPECT_LT(image.depth[i], 2.6F);
  }
  EXPECT_GT(num_front, 1000);
  EXPECT_GT(num_behind, 30);
}

TEST(RenderDepth, LeavesAnEmptySceneEmpty) {
  const auto scene = RayScene::from_instances({});
  ASSERT_TRUE(scene);
  const Image image = render(*scene);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    EXPECT_EQ(image.depth[i], 0);
    EXPECT_TRUE(image.normals[i].array().isNaN().all());
  }
}

TEST(RenderDepth, GivesTheSameBitsForAnyChunkOfRows) {
  const Shape shape = test::ellipsoid({0.5F, 0.8F, 0.3F}).moved([] {
    Pose pose = Pose::Identity();
    pose.translation() << 0, 0, 2;
    return pose;
  }());
  const auto scene = RayScene::from_mesh(shape.vertices, shape.triangles);
  ASSERT_TRUE(scene);
  const Image whole = render(*scene);
  for (const std::uint32_t grain : {1U, 7U, 47U}) {
    const Image split = render(*scene, grain);
    EXPECT_TRUE(test::same_bits(whole.depth, split.depth));
    EXPECT_TRUE(test::same_bits(whole.normals, split.normals));
    EXPECT_EQ(whole.instances, split.instances);
  }
}

TEST(RenderDepth, AllocatesNothing) {
  const auto scene = RayScene::from_instances({});
  ASSERT_TRUE(scene);
  Image image;
  EXPECT_EQ(
      test::allocations_in([&] {
        render_depth(*scene, kCamera, kWidth, 0, {image.depth, image.instances, image.normals});
      }),
      0U);
}

}  // namespace
}  // namespace trivet::kernels
