#include "engine/scene/prepare_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/results/stage_times.hpp"
#include "engine/scene/read_scene.hpp"
#include "engine/scene/sample_scene.hpp"
#include "kernels/common/median.hpp"
#include "kernels/simulation/add_noise.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

constexpr float kStep = 0.008F;
constexpr float kDiameter = 0.2F;

/// Two parts side by side: a sensor's scan has one depth image, a closed surface has six.
Cloud two_parts() {
  static const test::Shape bracket = test::bracket(), lever = test::lever();
  return test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0, 0.9F})},
                            {&lever, test::pose_of({-0.6F, 0.5F, 1.9F}, {0.15F, 0, 0.95F})}});
}

engine::PreparedScene prepare(const Cloud& cloud, const SceneInput& input,
                              const engine::PrepareOptions& options = {}) {
  StageTimes times;
  Result<engine::PreparedScene> scene = engine::prepare_scene(cloud, input, times, options);
  EXPECT_TRUE(scene) << scene.error().message;
  return std::move(*scene);
}

std::size_t num_pixels(const engine::PreparedScene& scene) {
  std::size_t sum = 0;
  for (const kernels::RangeImage& image : scene.images) sum += image.depth.size();
  return sum;
}

/// The depths measured by the images at the projection of a point, minus the point's depth.
std::vector<float> depth_differences(const engine::PreparedScene& scene,
                                     std::span<const std::uint8_t> marked,
                                     const Eigen::Vector3f& point) {
  std::vector<float> differences;
  std::size_t first = 0;
  for (const kernels::RangeImage& image : scene.images) {
    const kernels::ImageGeometry& g = image.geometry;
    const Eigen::Vector3f p = g.T_camera_scene * point;
    const float u = std::floor(g.fx * p.x() / p.z() + g.cx + 0.5F),
                v = std::floor(g.fy * p.y() / p.z() + g.cy + 0.5F);
    if (p.z() > 0 && u >= 0 && v >= 0 && u < static_cast<float>(g.width) &&
        v < static_cast<float>(g.height)) {
      const std::size_t pixel = static_cast<std::size_t>(v) * g.width + static_cast<std::size_t>(u);
      if (marked[first + pixel] != 0) differences.push_back(image.depth[pixel] - p.z());
    }
    first += image.depth.size();
  }
  return differences;
}

/// Indices of the points of `whole` missing in `part`; `part` keeps the order of `whole`.
std::vector<std::size_t> missing(PointsView whole, PointsView part) {
  std::vector<std::size_t> lacking;
  std::size_t k = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (k < part.size() && part[k] == whole[i]) {
      ++k;
    } else {
      lacking.push_back(i);
    }
  }
  EXPECT_EQ(k, part.size()) << "points that were not there before";
  return lacking;
}

engine::SceneLevel choose_voters(const engine::PreparedScene& scene,
                                 std::span<const std::uint8_t> marked) {
  return engine::choose_voters(scene, engine::sample_scene(scene, kStep, kDiameter), {}, marked);
}

void expect_unexplained_points_only(const engine::PreparedScene& scene,
                                    std::span<const std::uint8_t> marked) {
  const engine::SceneLevel whole = choose_voters(scene, {});
  const engine::SceneLevel rest = choose_voters(scene, marked);
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    const std::vector<float> differences = depth_differences(scene, marked, whole.points[i]);
    if (std::ranges::any_of(differences, [](float d) { return std::abs(d) <= kStep; })) {
      expected.push_back(i);
    }
  }
  EXPECT_FALSE(expected.empty());
  EXPECT_LT(expected.size(), whole.points.size());
  EXPECT_EQ(missing(whole.points, rest.points), expected);
  EXPECT_LT(rest.references.size(), whole.references.size());
}

/// The parts as scanned by a noisy sensor.
Cloud noisy_parts() {
  Cloud cloud = two_parts();
  kernels::add_gaussian_noise(cloud.points, 0.001F, 1, 0, cloud.points);
  return cloud;
}

/// The mean of 1 minus the cosine between the normals of adjacent pixels.
float mean_roughness(const engine::PreparedScene& scene) {
  const kernels::RangeImage& image = scene.images[0];
  double sum = 0, count = 0;
  for (std::size_t pixel = 0; pixel + 1 < image.depth.size(); ++pixel) {
    const float turn = 1 - image.normals[pixel].dot(image.normals[pixel + 1]);
    if (!std::isfinite(turn)) continue;
    sum += static_cast<double>(turn);
    ++count;
  }
  return static_cast<float>(sum / count);
}

/// The mean distance of the pixels' depths from a slanted plane that scattered points cover.
float mean_depth_error(float noise) {
  test::Random random;
  const Eigen::Vector3f normal = Eigen::Vector3f(0.8F, 0.1F, -0.6F).normalized();
  const auto depth_of = [&](const Eigen::Vector3f& ray) { return normal.z() / normal.dot(ray); };
  Cloud cloud;
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3f ray(random.uniform(-0.3F, 0.3F), random.uniform(-0.3F, 0.3F), 1);
    cloud.points.push_back((depth_of(ray) + random.normal(noise)) * ray);
  }
  const engine::PreparedScene scene = prepare(cloud, {});
  const kernels::RangeImage& image = scene.images[0];
  const Pose T_scene_camera = image.geometry.T_camera_scene.inverse();
  double sum = 0, count = 0;
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    if (!(image.depth[pixel] > 0) || !std::isfinite(image.normals[pixel].x())) continue;
    const Eigen::Vector3f p =
        T_scene_camera * image.geometry.back_project(pixel, image.depth[pixel]);
    sum += static_cast<double>(normal.dot(p - Eigen::Vector3f(0, 0, 1)));
    ++count;
  }
  EXPECT_GT(count, 5000);
  return static_cast<float>(sum / count);
}

TEST(PrepareScene, MeasuresScatteredPointsWhereTheyAre) {
  EXPECT_NEAR(mean_depth_error(0), 0, 2e-5F);
  EXPECT_NEAR(mean_depth_error(0.003F), 0, 1e-4F);
}

TEST(PrepareScene, MeasuresAMovedOrganizedScanAsTheSensorDid) {
  Cloud cloud = two_parts();
  const engine::PreparedScene before = prepare(cloud, {});
  cloud.camera.reset();
  const Pose motion = test::pose_of({0.4F, -1.2F, 2}, {0.85F, -0.22F, 1.1F});
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points.set(i, motion * cloud.points[i]);
  const engine::PreparedScene after = prepare(cloud, {});
  EXPECT_EQ(name_of(after.view.source), "grid");
  ASSERT_EQ(after.images[0].depth.size(), before.images[0].depth.size());
  for (std::size_t pixel = 0; pixel < before.images[0].depth.size(); ++pixel)
    ASSERT_NEAR(after.images[0].depth[pixel], before.images[0].depth[pixel], 1e-4F);
}

TEST(PrepareScene, MeasuresAListOfThePixelsAsTheSensorDid) {
  const Cloud image = two_parts();
  const kernels::RangeImage before = prepare(image, {}).images[0];
  Cloud list;
  for (std::size_t i = image.points.size(); i-- > 0;) list.points.push_back(image.points[i]);
  const engine::PreparedScene scene = prepare(list, {});
  EXPECT_EQ(name_of(scene.view.kind), "image");
  EXPECT_EQ(name_of(scene.view.source), "grid");
  const kernels::RangeImage& after = scene.images[0];
  std::size_t num_measured = 0;
  for (std::size_t pixel = 0; pixel < after.depth.size(); ++pixel) {
    if (!(after.depth[pixel] > 0)) continue;
    ++num_measured;
    const std::int64_t same =
        before.geometry.pixel_of(after.geometry.back_project(pixel, after.depth[pixel]));
    ASSERT_GE(same, 0);
    ASSERT_EQ(before.depth[static_cast<std::size_t>(same)], after.depth[pixel]);
  }
  EXPECT_EQ(num_measured, image.points.size());
}

// The pixels of noisy_parts() have independent errors.
TEST(PrepareScene, MeasuresTheSensorUnlessThatIsLeftOut) {
  const engine::PreparedScene scene = prepare(noisy_parts(), {});
  std::vector<float> ranges;
  for (const float depth : scene.images[0].depth) {
    if (depth > 0) ranges.push_back(depth);
  }
  EXPECT_EQ(scene.sensor.range, kernels::median(std::span(ranges)));
  EXPECT_NEAR(scene.sensor.noise, 0.001F, 3e-4F);
  EXPECT_LT(scene.sensor.correlation, 0.3F);
  const engine::PreparedScene left_out = prepare(noisy_parts(), {}, {.correlated_noise = false});
  EXPECT_EQ(left_out.sensor.range, scene.sensor.range);
  EXPECT_EQ(left_out.sensor.exponent, 0);
  EXPECT_EQ(left_out.sensor.correlation, 0);
  EXPECT_EQ(left_out.sensor.error_at(2 * scene.sensor.range), scene.sensor.noise);
}

// On each step a surface is flat, and shows no noise.
TEST(PrepareScene, ErrsByTheStepsInWhichDepthIsMeasured) {
  constexpr float kDepthStep = 0.005F;
  Cloud cloud = two_parts();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    if (p.z() > 0) cloud.points.set(i, p * (std::round(p.z() / kDepthStep) * kDepthStep / p.z()));
  }
  const engine::PreparedScene scene = prepare(cloud, {});
  EXPECT_NEAR(scene.sensor.noise, kDepthStep / std::sqrt(12.0F), 0.1F * kDepthStep);
  EXPECT_GT(scene.window, 3) << "normals of single steps face the sensor";
}

TEST(PrepareScene, WidensTheWindowsOfNormalsWithTheNoise) {
  EXPECT_LT(prepare(two_parts(), {}).window, 2.5F);
  const float window = prepare(noisy_parts(), {}).window;
  EXPECT_GT(window, 3);
  EXPECT_LE(window, 7);
}

TEST(PrepareScene, FitsNormalsToTheWindowThatIsAskedFor) {
  float rougher = 2;
  for (const float window : {1.0F, 2.0F, 5.0F}) {
    const engine::PreparedScene scene = prepare(noisy_parts(), {}, {.normal_window = window});
    EXPECT_EQ(scene.window, window);
    EXPECT_LT(mean_roughness(scene), rougher) << "wider windows are smoother";
    rougher = mean_roughness(scene);
  }
}

TEST(PrepareScene, FitsNormalsOfAClosedSurfaceToTheWindowThatIsAskedFor) {
  const SceneInput whole{.closed_surface = true};
  const engine::PreparedScene by_noise = prepare(test::cloud_of(test::lever()), whole);
  const auto fixed = [&](float window) {
    return prepare(test::cloud_of(test::lever()), whole, {.normal_window = window});
  };
  EXPECT_TRUE(test::same_bits(fixed(by_noise.window).normals, by_noise.normals));
  for (const float window : {1.0F, 6.0F}) {
    const engine::PreparedScene scene = fixed(window);
    EXPECT_EQ(scene.window, window);
    EXPECT_FALSE(test::same_bits(scene.normals, by_noise.normals));
  }
}

TEST(PrepareScene, GivesTheSameByTheWindowThatTheNoiseAsksFor) {
  const engine::PreparedScene by_noise = prepare(noisy_parts(), {});
  const engine::PreparedScene fixed =
      prepare(noisy_parts(), {}, {.normal_window = by_noise.window});
  EXPECT_TRUE(test::same_bits(fixed.normals, by_noise.normals));
  EXPECT_EQ(fixed.sensor.noise, by_noise.sensor.noise) << "is measured in a window of its own";
}

TEST(ChooseVoters, AppendsEdgesThatAreNoReferences) {
  const engine::PreparedScene scene = prepare(two_parts(), {});
  const engine::SceneSample sample = engine::sample_scene(scene, kStep, kDiameter);
  const engine::SceneLevel level = choose_voters(scene, {});
  EXPECT_GT(sample.edges.size(), 10U);
  ASSERT_EQ(level.points.size(), sample.points.size() + sample.edges.size());
  EXPECT_LT(level.references.back(), sample.points.size());
  EXPECT_EQ(level.points[sample.points.size()], sample.edges[0]);
  EXPECT_EQ(level.normals[sample.points.size()], sample.edge_directions[0]);
}

TEST(ChooseVoters, LeavesOutWhatTheMarkedPixelsMeasured) {
  const engine::PreparedScene scene = prepare(two_parts(), {});
  ASSERT_EQ(scene.images.size(), 1U);
  const kernels::RangeImage& image = scene.images[0];
  std::vector<std::uint8_t> marked(num_pixels(scene), 0);
  for (std::size_t v = 0; v < image.geometry.height; ++v) {  // the left half of the image
    for (std::size_t u = 0; u < image.geometry.width / 2; ++u) {
      marked[v * image.geometry.width + u] = 1;
    }
  }
  expect_unexplained_points_only(scene, marked);
}

TEST(ChooseVoters, ReadsMarksOfSeveralImagesOneAfterTheOther) {
  const engine::PreparedScene scene =
      prepare(test::cloud_of(test::lever()), {.closed_surface = true});
  ASSERT_EQ(scene.images.size(), 6U);
  std::vector<std::uint8_t> marked(num_pixels(scene), 0);
  std::size_t first = 0;
  for (std::size_t k = 0; k < 6; ++k) {  // the views of the second and the sixth camera
    const std::size_t size = scene.images[k].depth.size();
    if (k == 1 || k == 5) std::fill_n(marked.begin() + static_cast<std::ptrdiff_t>(first), size, 1);
    first += size;
  }
  expect_unexplained_points_only(scene, marked);
}

/// A point every 0.1 m from 0.1 to 4 m of range, in a depth image.
engine::PreparedScene receding_points() {
  engine::PreparedScene scene;
  scene.view.kind = SceneKind::image;
  kernels::RangeImage& image = scene.images.emplace_back();
  image.geometry = {Pose::Identity(), 500, 500, 319.5F, 239.5F, 640, 480};
  for (int k = 0; k < 40; ++k) {
    scene.points.push_back({0.02F * static_cast<float>(k), 0, 0.1F * static_cast<float>(k + 1)});
    scene.normals.push_back({0, 0, -1});
  }
  return scene;
}

/// The range of the farthest point in a sample of such a scene; 0: none.
float farthest_sampled(const engine::PreparedScene& scene, float step, float diameter) {
  const engine::SceneSample sample = engine::sample_scene(scene, step, diameter);
  return sample.points.size() == 0 ? 0 : sample.points[sample.points.size() - 1].z();
}

// What is far away for its size cannot be tested there.
TEST(SampleScene, LeavesOutWhereModelsAreTooFewPixelsOrErrorsWide) {
  engine::PreparedScene scene = receding_points();
  const auto farthest = [&](float diameter) { return farthest_sampled(scene, 0.01F, diameter); };
  scene.sensor = {.range = 1, .noise = 0};
  EXPECT_FLOAT_EQ(farthest(0.05F), 0.9F) << "beyond 1 m it is less than 25 pixels wide";
  EXPECT_FLOAT_EQ(farthest(0.5F), 4);
  scene.sensor.noise = 0.001F;  // 25 mm are 25 errors
  scene.sensor.exponent = 2;
  EXPECT_FLOAT_EQ(farthest(0.1F), 1.9F) << "its error is 4 mm at 2 m";
  scene.view.kind = SceneKind::surface;
  EXPECT_FLOAT_EQ(farthest(0.05F), 4) << "a closed surface has no sensor";
}

// Normals of points that close together would be those of the error, not of the surface.
TEST(SampleScene, LeavesOutWhereNeighborsErrTogetherByAThirdOfTheStep) {
  engine::PreparedScene scene = receding_points();
  scene.sensor = {.range = 1, .correlated_noise = {.height = 0.001F}, .exponent = 2};
  EXPECT_FLOAT_EQ(farthest_sampled(scene, 0.01F, 10), 1.8F)
      << "its neighbors err by 3.3 mm together at 1.83 m";
  EXPECT_FLOAT_EQ(farthest_sampled(scene, 0.03F, 10), 3.1F);
}

// Points in front of or behind an explained surface are not explained by it.
TEST(ChooseVoters, KeepsPointsAtOtherDepthsThanTheMarkedPixels) {
  engine::PreparedScene scene = prepare(two_parts(), {});
  const engine::SceneLevel whole = choose_voters(scene, {});
  for (float& depth : scene.images[0].depth) depth += 2 * kStep;
  const std::vector<std::uint8_t> marked(num_pixels(scene), 1);
  const engine::SceneLevel rest = choose_voters(scene, marked);
  EXPECT_GT(rest.points.size(), whole.points.size() * 9 / 10);
}

TEST(ChooseVoters, IsLeftNothingWhereAllIsExplained) {
  const engine::PreparedScene scene =
      prepare(test::cloud_of(test::lever()), {.closed_surface = true});
  const std::vector<std::uint8_t> marked(num_pixels(scene), 1);
  const engine::SceneLevel rest =
      engine::choose_voters(scene, engine::sample_scene(scene, 0.05F, kDiameter), {}, marked);
  EXPECT_EQ(rest.points.size(), 0U);
  EXPECT_TRUE(rest.references.empty());
}

}  // namespace
}  // namespace trivet
