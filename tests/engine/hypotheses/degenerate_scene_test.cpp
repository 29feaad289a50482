// Any scene that a client sends is prepared or refused with a specific error, within bounds.
#include <gtest/gtest.h>

#include "engine/common/thread_limit.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/scene/read_scene.hpp"
#include "support/allocations.hpp"
#include "support/degenerate_geometry.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

/// Prepares in one thread, whose allocations are counted.
Result<engine::PreparedScene> prepare_alone(const Cloud& cloud, const SceneInput& input,
                                            std::size_t* bytes = nullptr) {
  const ThreadLimit alone(1);
  StageTimes times;
  std::optional<Result<engine::PreparedScene>> scene;
  const std::size_t used =
      test::bytes_in([&] { scene = engine::prepare_scene(cloud, input, times); });
  if (bytes) *bytes = used;
  return *std::move(scene);
}

void expect_usable(const Result<engine::PreparedScene>& scene, const std::string& name) {
  if (!scene) {
    EXPECT_EQ(scene.error().code, ErrorCode::bad_data) << name;
    EXPECT_TRUE(scene.error().message.starts_with("a.ply: expected")) << scene.error().message;
    return;
  }
  EXPECT_GE(scene->points.size(), 50U) << name;
  EXPECT_FALSE(scene->images.empty()) << name;
  EXPECT_TRUE(scene->spacing > 0 && std::isfinite(scene->spacing)) << name << scene->spacing;
  EXPECT_TRUE(std::isfinite(scene->window)) << name;
  for (const kernels::RangeImage& image : scene->images) {
    EXPECT_LE(image.geometry.fx, kernels::kLargestFocalLength) << name;
    EXPECT_EQ(image.depth.size(), std::size_t{image.geometry.width} * image.geometry.height);
  }
}

constexpr std::size_t kMebibyte = std::size_t{1} << 20;

TEST(DegenerateScene, IsPreparedOrRefusedWhateverItsVertices) {
  for (const test::DegenerateMesh& mesh : test::degenerate_meshes()) {
    for (const bool closed : {true, false}) {
      SceneInput input{.file = "a.ply", .closed_surface = closed};
      if (!closed) input.viewpoint = Eigen::Vector3d(0, 0, 0);
      std::size_t bytes = 0;
      expect_usable(prepare_alone(mesh.cloud, input, &bytes), mesh.name);
      EXPECT_LT(bytes, 64 * kMebibyte) << mesh.name;
    }
  }
}

TEST(DegenerateScene, IsPreparedOrRefusedWhateverItsPoints) {
  for (const test::DegenerateMesh& mesh : test::degenerate_meshes()) {
    Cloud cloud;  // as many points as a scan, at few positions
    for (std::size_t i = 0; i < 600; ++i)
      cloud.points.push_back(mesh.cloud.points[i % mesh.cloud.points.size()]);
    for (const Eigen::Vector3d& viewpoint :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, 1e10)}) {
      const SceneInput input{.file = "a.ply", .viewpoint = viewpoint};
      std::size_t bytes = 0;
      expect_usable(prepare_alone(cloud, input, &bytes), mesh.name);
      EXPECT_LT(bytes, 1024 * kMebibyte) << mesh.name;
    }
  }
}

/// The number of point pairs visited when normals are fitted to windows of this radius [spacings].
std::size_t num_neighbors(const engine::PreparedScene& scene, float radius) {
  const kernels::VoxelHash grid(scene.points, radius * scene.spacing);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    pairs += grid.count_within(scene.points[i], radius * scene.spacing);
  return pairs;
}

// Coincident faces were once sampled separately, and every sample had as many neighbors as there
// were faces.
TEST(DegenerateScene, OfManyLayersIsNoMoreWorkThanItsFile) {
  for (const auto& make : {test::layered_tetrahedron, test::shifted_tetrahedra}) {
    std::size_t bytes_of_few = 0, bytes_of_many = 0;
    const auto check = [&](std::size_t layers, std::size_t& bytes) {
      const Result<engine::PreparedScene> scene =
          prepare_alone(make(layers), {.file = "a.ply", .closed_surface = true}, &bytes);
      ASSERT_TRUE(scene) << scene.error().message;
      EXPECT_GT(scene->points.size(), 1000U) << layers;
      EXPECT_LT(scene->points.size(), 300'000U) << layers;
      EXPECT_LT(num_neighbors(*scene, 2), 250 * scene->points.size()) << layers;
    };
    check(16, bytes_of_few);
    check(4096, bytes_of_many);
    EXPECT_LE(bytes_of_many, 2 * bytes_of_few);
  }
}

/// Both sides of squares that cross one another, and a spike that makes their extent four times as
/// wide.
Cloud crossing_squares(std::size_t count) {
  test::Random random;
  Cloud cloud;
  for (std::size_t k = 0; k < count; ++k) {
    const Pose pose = random.motion(20);
    const auto first = static_cast<std::uint32_t>(cloud.points.size());
    for (const auto& [x, y] : {std::pair(-50, -50), {50, -50}, {50, 50}, {-50, 50}})
      cloud.points.push_back(pose *
                             Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0));
    cloud.triangles.push_back(first, first + 1, first + 2);
    cloud.triangles.push_back(first, first + 2, first + 3);
    cloud.triangles.push_back(first, first + 2, first + 1);
    cloud.triangles.push_back(first, first + 3, first + 2);
  }
  cloud.points.push_back({400, 0, 0});
  const auto spike = static_cast<std::uint32_t>(cloud.points.size() - 1);
  cloud.triangles.push_back(0, 1, spike);
  cloud.triangles.push_back(1, 0, spike);
  return cloud;
}

// Up to 15 layers were once kept, and crossing faces whatever their number: 50 million pairs of
// neighbors of a file of 61 faces.
TEST(DegenerateScene, HasAsManyNeighborsAsOneSurface) {
  constexpr float kNoiseWindow = 2;
  const auto count = [&](const Cloud& cloud) {
    const Result<engine::PreparedScene> scene =
        prepare_alone(cloud, {.file = "a.ply", .closed_surface = true});
    EXPECT_TRUE(scene) << scene.error().message;
    if (!scene) return std::size_t{0};
    EXPECT_GE(scene->window, kNoiseWindow);
    return num_neighbors(*scene, kNoiseWindow) + num_neighbors(*scene, scene->window);
  };
  for (const std::size_t layers : {1U, 2U, 4U, 6U, 8U, 12U, 15U, 16U, 20U}) {
    EXPECT_LT(count(test::layered_tetrahedron(layers)), 20'000'000U) << layers;
    EXPECT_LT(count(test::shifted_tetrahedra(layers)), 20'000'000U) << layers;
  }
  for (const std::size_t squares : {20U, 80U, 320U})
    EXPECT_LT(count(crossing_squares(squares)), 100'000'000U) << squares;
}

TEST(DegenerateScene, OfOneLayerHasAllItsSamples) {
  const Result<engine::PreparedScene> once =
      prepare_alone(test::layered_tetrahedron(1), {.file = "a.ply", .closed_surface = true});
  ASSERT_TRUE(once) << once.error().message;
  EXPECT_NEAR(once->spacing, 0.00707F * Eigen::Vector3f(200, 200, 150).norm(), 0.01F);
}

TEST(DegenerateScene, MeasuresNothingByVerticesOfNoFace) {
  const test::Shape bracket = test::bracket();
  Cloud cloud = test::cloud_of(bracket);
  const SceneInput input{.file = "a.ply", .closed_surface = true};
  const Result<engine::PreparedScene> before = prepare_alone(cloud, input);
  cloud.points.push_back({100, 0, 0});
  const Result<engine::PreparedScene> after = prepare_alone(cloud, input);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->spacing, before->spacing);
  EXPECT_EQ(after->points.size(), before->points.size());
}

// Scans of both halves of a sensor's exposure, or joined with themselves, contain all points twice.
TEST(DegenerateScene, OfAllPointsTwiceIsAsOfAllPointsOnce) {
  static const test::Shape bracket = test::bracket();
  Cloud scan =
      test::render_scan({{&bracket, test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0, 0.9F})}});
  Cloud once;
  once.points = scan.points;
  const SceneInput input{.file = "a.ply", .viewpoint = Eigen::Vector3d(0, 0, 0)};
  const Result<engine::PreparedScene> single = prepare_alone(once, input);
  ASSERT_TRUE(single);
  test::Random random;
  for (const float jitter : {0.0F, 1e-6F}) {
    for (const int copies : {2, 3}) {
      Cloud many;
      for (int k = 0; k < copies; ++k) {
        for (std::size_t i = 0; i < once.points.size(); ++i) {
          const float shift = k == 0 || jitter == 0 ? 0 : random.normal(jitter);
          many.points.push_back(once.points[i] + Eigen::Vector3f::Constant(shift));
        }
      }
      const Result<engine::PreparedScene> scene = prepare_alone(many, input);
      ASSERT_TRUE(scene);
      const float tolerance = jitter > 0 ? 0.25F : 0.01F;
      EXPECT_NEAR(scene->images[0].geometry.fx, single->images[0].geometry.fx,
                  tolerance * single->images[0].geometry.fx)
          << copies << " copies, jitter " << jitter;
      const auto num_known = [](const engine::PreparedScene& prepared) {
        return static_cast<double>(std::ranges::count_if(prepared.normals.view().x,
                                                         [](float x) { return std::isfinite(x); }));
      };
      EXPECT_GE(num_known(*scene), 0.9 * num_known(*single)) << copies << ", " << jitter;
    }
  }
}

}  // namespace
}  // namespace trivet
