#include "engine/render_scenes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/pile_up.hpp"
#include "engine/progress.hpp"
#include "kernels/diameter.hpp"
#include "storage/read_cloud.hpp"
#include "support/shapes.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3d kLow(-0.03, -0.05, -0.02), kHigh(0.04, 0.05, 0.06);

Cloud box_mesh() {
  const test::Shape shape = test::box(kLow.cast<float>(), kHigh.cast<float>());
  Cloud cloud;
  cloud.points = shape.vertices;
  cloud.triangles = shape.triangles;
  return cloud;
}

Model box_model() {
  Result<TrainedModel> trained =
      train_model(box_mesh(), {"box", "box.ply", 1, {}}, {.relative_step = 0.1F});
  EXPECT_TRUE(trained) << trained.error().message;
  return std::move(trained->model);
}

/// Depth at which the ray through a pixel enters the box; infinite where it misses. By slabs, in
/// double.
double box_depth(const Camera& camera, std::size_t pixel, const Pose& T_camera_box) {
  const Vector3d ray((static_cast<double>(pixel % kScanWidth) - camera.cx) / camera.fx,
                     (static_cast<double>(pixel / kScanWidth) - camera.cy) / camera.fy, 1);
  const Eigen::Isometry3d into = T_camera_box.cast<double>().inverse();
  const Vector3d origin = into.translation(), direction = into.linear() * ray;
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double a = (kLow[axis] - origin[axis]) / direction[axis],
                 b = (kHigh[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

TEST(RenderScene, MeasuresBoxesWhereTheTruthSaysTheyAre) {
  const std::vector<Model> models{box_model()};
  ScanOptions options;
  options.noise = 0;
  options.num_instances = 3;
  const Result<RenderedScene> scene = render_scene(models, LengthUnit::metre, options, 5);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->depths.size(), std::size_t{kScanWidth} * kScanHeight);
  ASSERT_EQ(scene->truth.size(), 3U);

  std::vector<std::size_t> own(3), nearest(3);
  std::size_t measured = 0;
  for (std::size_t i = 0; i < scene->depths.size(); ++i) {
    double depth = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    for (std::size_t t = 0; t < 3; ++t) {
      const double z = box_depth(scene->camera, i, scene->truth[t].T_scene_model);
      own[t] += std::isfinite(z) ? 1 : 0;
      if (z < depth) {
        depth = z;
        first = t;
      }
    }
    if (!std::isfinite(depth)) continue;  // the ground
    ++nearest[first];
    if (scene->depths[i] == 0) continue;  // an edge
    ++measured;
    // Half a step of 0.1 mm, and float rays.
    EXPECT_NEAR(scene->depths[i] * scene->camera.depth_scale, depth, 0.6e-4) << "pixel " << i;
  }
  EXPECT_GT(measured, 5000U);
  for (std::size_t t = 0; t < 3; ++t) {
    const double covered = 1 - static_cast<double>(nearest[t]) / static_cast<double>(own[t]);
    EXPECT_NEAR(*scene->truth[t].occlusion, covered, 0.01) << "but for pixels on an outline";
  }
}

TEST(RenderScene, StandsOnTheGround) {
  const std::vector<Model> models{box_model()};
  ScanOptions options;
  options.noise = 0;
  options.num_instances = 1;
  const Result<RenderedScene> scene = render_scene(models, LengthUnit::metre, options, 0);
  ASSERT_TRUE(scene);
  // The ground fills the lower corners; a third point of it is in the lower middle.
  const auto point = [&](std::size_t u, std::size_t v) {
    const double z = scene->depths[v * kScanWidth + u] * scene->camera.depth_scale;
    return Vector3d((static_cast<double>(u) - scene->camera.cx) * z / scene->camera.fx,
                    (static_cast<double>(v) - scene->camera.cy) * z / scene->camera.fy, z);
  };
  const Vector3d a = point(5, 470), b = point(630, 470), c = point(5, 5);
  const Vector3d up =
      (b - a).cross(c - a).normalized() * (a.dot((b - a).cross(c - a)) > 0 ? -1 : 1);
  double lowest = 1;
  const test::Shape shape = test::box(kLow.cast<float>(), kHigh.cast<float>());
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    lowest = std::min(
        lowest, up.dot((scene->truth[0].T_scene_model * shape.vertices[i]).cast<double>() - a));
  }
  EXPECT_NEAR(lowest, 0, 0.004) << "samples of the box come that near to its corner";
}

TEST(RenderScene, AddsNoiseOfTheSensorsSize) {
  const std::vector<Model> models{box_model()};
  ScanOptions options;
  options.num_instances = 2;
  const Result<RenderedScene> noisy = render_scene(models, LengthUnit::metre, options, 1);
  options.noise = 0;
  const Result<RenderedScene> clean = render_scene(models, LengthUnit::metre, options, 1);
  ASSERT_TRUE(noisy && clean);
  double sum = 0, squares = 0, n = 0;
  for (std::size_t i = 0; i < clean->depths.size(); ++i) {
    EXPECT_EQ(clean->depths[i] == 0, noisy->depths[i] == 0);
    if (clean->depths[i] == 0) continue;
    const double z = clean->depths[i] * 1e-4;
    const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    const double error = (noisy->depths[i] * 1e-4 - z) / sigma;
    sum += error;
    squares += error * error;
    n += 1;
  }
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 1, 0.01);
}

TEST(RenderScene, RefusesHeapsBeyondTheSensorsRange) {
  const std::vector<Model> models{box_model()};
  const Result<RenderedScene> scene = render_scene(models, LengthUnit::millimetre, {}, 0);
  ASSERT_TRUE(scene) << "0.1 mm small, seen from the nearest range";
  std::vector<Model> large = models;
  large[0].diameter *= 100;
  for (const std::span<float> column :
       {large[0].samples.span().x, large[0].samples.span().y, large[0].samples.span().z}) {
    for (float& value : column) value *= 100;
  }
  const Result<RenderedScene> refused = render_scene(large, LengthUnit::metre, {}, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_NE(refused.error().message.find("--diameter"), std::string::npos);
}

TEST(PileUp, TakesEveryModelOnceBeforeOneComesAgain) {
  const std::vector<Model> models(4, box_model());
  const auto placed = engine::pile_up(models, 10, 7, 3);
  ASSERT_EQ(placed.size(), 10U);
  std::vector<int> count(4);
  for (std::size_t i = 0; i < 8; ++i) ++count[placed[i].model];
  EXPECT_EQ(count, std::vector<int>(4, 2));
}

// Separating axes: of two disjoint boxes, a face normal or a cross product of edges parts them.
TEST(PileUp, LetsNothingEnterAnything) {
  const std::vector<Model> models{box_model()};
  const auto placed = engine::pile_up(models, 12, 1, 0);
  const auto extent = [](const Pose& pose, const Vector3f& axis) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    const test::Shape shape = test::box(kLow.cast<float>(), kHigh.cast<float>());
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
      const float along = axis.dot(pose * shape.vertices[i]);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    return std::pair(low, high);
  };
  for (std::size_t i = 0; i < placed.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Pose &a = placed[i].T_world_model, &b = placed[j].T_world_model;
      std::vector<Vector3f> axes;
      for (Eigen::Index k = 0; k < 3; ++k) {
        axes.push_back(a.linear().col(k));
        axes.push_back(b.linear().col(k));
        for (Eigen::Index l = 0; l < 3; ++l) {
          const Vector3f across = a.linear().col(k).cross(b.linear().col(l));
          if (across.norm() > 1e-3F) axes.push_back(across.normalized());
        }
      }
      float gap = -1;
      for (const Vector3f& axis : axes) {
        const auto [low_a, high_a] = extent(a, axis);
        const auto [low_b, high_b] = extent(b, axis);
        gap = std::max(gap, std::max(low_a - high_b, low_b - high_a));
      }
      EXPECT_GT(gap, -0.001F) << i << " and " << j << ": 1 mm is less than the samples are apart";
    }
  }
}

std::vector<std::string> rendered_files(unsigned num_threads) {
  const test::TempDir folder;
  Cloud mesh = box_mesh();
  EXPECT_TRUE(write_ply(folder / "box.ply", mesh));
  const std::vector<ModelSource> sources{{"box", folder / "box.ply", 1, {}}};
  ScanOptions options;
  options.num_scenes = 3;
  options.diameter = 0.2F;
  const ThreadLimit limit(num_threads);
  const Result<Manifest> manifest =
      render_scenes(sources, LengthUnit::metre, options, folder / "scan", {});
  EXPECT_TRUE(manifest) << manifest.error().message;
  std::vector<std::string> files;
  for (const char* name :
       {"manifest.json", "models/box.ply", "scene_0000.png", "scene_0001.png", "scene_0002.png"}) {
    files.push_back(test::read_bytes(folder / "scan" / name));
    EXPECT_FALSE(files.back().empty()) << name;
  }
  return files;
}

TEST(RenderScenes, GivesTheSameBytesForAnyNumberOfThreads) {
  EXPECT_EQ(rendered_files(1), rendered_files(2));
}

TEST(RenderScenes, ScalesModelsAndDeclaresTheirSymmetries) {
  const test::TempDir folder;
  ASSERT_TRUE(write_ply(folder / "box.ply", box_mesh()));
  ScanOptions options;
  options.num_scenes = 1;
  options.diameter = 0.2F;
  const std::vector<ModelSource> sources{{"box", folder / "box.ply", 1, {}}};
  ASSERT_TRUE(render_scenes(sources, LengthUnit::metre, options, folder / "scan", {}));
  const Result<Manifest> manifest = read_manifest(folder / "scan/manifest.json");
  ASSERT_TRUE(manifest) << manifest.error().message;
  ASSERT_TRUE(manifest->models[0].symmetry);
  EXPECT_EQ(manifest->models[0].symmetry->poses.size(), 3U) << "half turns about the axes of a box";
  const Result<Cloud> mesh = read_cloud(manifest->models[0].file);
  ASSERT_TRUE(mesh);
  EXPECT_NEAR(kernels::find_diameter(mesh->points), 0.2, 1e-6);
  EXPECT_TRUE(manifest->scenes[0].camera);
  EXPECT_EQ(manifest->scenes[0].truth.size(), options.num_instances);
}

TEST(RenderScenes, RefusesCloudsWithoutFaces) {
  const test::TempDir folder;
  Cloud cloud = box_mesh();
  cloud.triangles = {};
  ASSERT_TRUE(write_ply(folder / "cloud.ply", cloud));
  const std::vector<ModelSource> sources{{"cloud", folder / "cloud.ply", 1, {}}};
  const Result<Manifest> manifest =
      render_scenes(sources, LengthUnit::metre, {}, folder / "scan", {});
  ASSERT_FALSE(manifest);
  EXPECT_EQ(manifest.error().code, ErrorCode::bad_data);
  EXPECT_NE(manifest.error().message.find("cloud.ply"), std::string::npos);
}

}  // namespace
}  // namespace trivet
