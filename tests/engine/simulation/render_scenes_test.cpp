#include "engine/simulation/render_scenes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "engine/common/thread_limit.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/shapes.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;

const Vector3d kLow(-0.03, -0.05, -0.02), kHigh(0.04, 0.05, 0.06);

Cloud cloud_of(const test::Shape& shape) {
  Cloud cloud;
  cloud.points = shape.vertices;
  cloud.triangles = shape.triangles;
  return cloud;
}

Cloud box_mesh() { return cloud_of(test::box(kLow.cast<float>(), kHigh.cast<float>())); }

ScanModel model_of(const std::string& name, const test::Shape& shape) {
  return {name, shape.vertices, shape.triangles, {}, false};
}

ScanModel box_model() {
  return model_of("box", test::box(kLow.cast<float>(), kHigh.cast<float>()));
}

ScanOptions exact(std::uint32_t num_instances, Sensor sensor = Sensor::structured_light) {
  ScanOptions options;
  options.num_instances = num_instances;
  options.sensor = {sensor, 0, {}};
  return options;
}

Result<RenderedScene> scan(const std::vector<ScanModel>& models, const ScanOptions& options,
                           std::uint32_t index, LengthUnit unit = LengthUnit::meter) {
  const Result<VirtualScanner> scanner = VirtualScanner::create(models, unit, options);
  if (!scanner) return scanner.error();
  return scanner->scan(index);
}

/// Depth at which the ray through a pixel enters the box; infinite where it misses. Slab method, in
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

TEST(VirtualScanner, GivesTheSameVisibilityAtAnyResolution) {
  const std::vector<ScanModel> models{box_model()};
  const Result<RenderedScene> usual = scan(models, exact(3), 5);
  ASSERT_TRUE(usual) << usual.error().message;
  for (const double resolution : {0.25, 2.0}) {
    ScanOptions options = exact(3);
    options.resolution = resolution;
    const Result<RenderedScene> scene = scan(models, options, 5);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->width, resolution * kScanWidth);
    EXPECT_EQ(scene->height, resolution * kScanHeight);
    ASSERT_EQ(scene->depths.size(), std::size_t{scene->width} * scene->height);
    EXPECT_DOUBLE_EQ(scene->camera.fx, resolution * usual->camera.fx);
    EXPECT_NEAR(scene->camera.cx / scene->width, 0.5, 0.01);
    ASSERT_EQ(scene->truth.size(), usual->truth.size());
    for (std::size_t k = 0; k < scene->truth.size(); ++k) {
      EXPECT_NEAR(*scene->truth[k].visible_fraction, *usual->truth[k].visible_fraction, 0.03);
      EXPECT_TRUE(scene->truth[k].T_scene_model.linear().isApprox(
          usual->truth[k].T_scene_model.linear(), 1e-5F));
    }
  }
}

TEST(VirtualScanner, MeasuresBoxesWhereTheTruthSaysTheyAre) {
  const std::vector<ScanModel> models{box_model()};
  const Result<RenderedScene> scene = scan(models, exact(3), 5);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->depths.size(), std::size_t{kScanWidth} * kScanHeight);
  ASSERT_EQ(scene->truth.size(), 3U);

  std::vector<int> own(3), nearest(3);
  std::size_t measured = 0;
  for (std::size_t i = 0; i < scene->depths.size(); ++i) {
    double depth = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    for (std::size_t t = 0; t < 3; ++t) {
      const double z = box_depth(scene->camera, i, scene->truth[t].T_scene_model);
      if (!std::isfinite(z)) continue;
      ++own[t];
      if (z < depth) {
        depth = z;
        first = t;
      }
    }
    if (!std::isfinite(depth)) continue;  // the ground
    ++nearest[first];
    if (scene->depths[i] == 0) continue;  // an edge or a shadow
    ++measured;
    EXPECT_NEAR(scene->exact.depth[i], depth, 2e-6) << "pixel " << i;
    // Half a step of 0.1 mm.
    EXPECT_NEAR(scene->depths[i] * scene->camera.depth_scale, depth, 0.52e-4) << "pixel " << i;
  }
  EXPECT_GT(measured, 5000U);
  for (std::size_t t = 0; t < 3; ++t) {
    const BopInstance& bop = scene->bop.instances[t];
    EXPECT_NEAR(*scene->truth[t].visible_fraction, static_cast<double>(nearest[t]) / own[t],
                6.0 / own[t])
        << "but for pixels on an outline";
    EXPECT_EQ(bop.object_id, 1);
    EXPECT_TRUE(bop.T_camera_model.translation().isApprox(
        1000 * scene->truth[t].T_scene_model.translation(), 1e-6F));
  }
}

TEST(VirtualScanner, StandsOnTheGround) {
  const std::vector<ScanModel> models{box_model()};
  const Result<RenderedScene> scene = scan(models, exact(1), 0);
  ASSERT_TRUE(scene);
  const auto point = [&](std::size_t u, std::size_t v) {
    const auto z = static_cast<double>(scene->exact.depth[v * kScanWidth + u]);
    return Vector3d((static_cast<double>(u) - scene->camera.cx) * z / scene->camera.fx,
                    (static_cast<double>(v) - scene->camera.cy) * z / scene->camera.fy, z);
  };
  const Vector3d a = point(5, 470), b = point(630, 470), c = point(5, 5);
  const Vector3d up =
      (b - a).cross(c - a).normalized() * (a.dot((b - a).cross(c - a)) > 0 ? -1 : 1);
  double lowest = 1;
  for (std::size_t i = 0; i < models[0].vertices.size(); ++i) {
    lowest = std::min(
        lowest, up.dot((scene->truth[0].T_scene_model * models[0].vertices[i]).cast<double>() - a));
  }
  EXPECT_NEAR(lowest, 0, 1e-5);
}

// A camera at distance d from the center of a sphere of radius r sees it where the ray's angle to
// the normal is below 80 degrees. By the law of sines, the angle at the center is then below 80
// degrees - asin(r sin(80 degrees) / d). That cap has the area 2 pi r^2 (1 - cos).
TEST(VirtualScanner, FindsTheAreaOfASphereThatASensorMeasures) {
  const float r = 0.05F;
  const std::vector<ScanModel> models{model_of("ball", test::ellipsoid({r, r, r}, 90))};
  const Result<RenderedScene> scene = scan(models, exact(1, Sensor::time_of_flight), 2);
  ASSERT_TRUE(scene) << scene.error().message;
  const double d = static_cast<double>(scene->truth[0].T_scene_model.translation().norm());
  const double right = 80 * std::numbers::pi / 180;
  const double angle = right - std::asin(static_cast<double>(r) * std::sin(right) / d);
  const double cap = (1 - std::cos(angle)) / 2;
  EXPECT_NEAR(1 - *scene->truth[0].occlusion, cap, 0.005 * cap) << "light at the lens: no shadow";
  EXPECT_EQ(scene->truth[0].visible_fraction, 1);

  const Result<RenderedScene> lit = scan(models, exact(1), 2);
  ASSERT_TRUE(lit);
  EXPECT_LT(1 - *lit->truth[0].occlusion, 0.99 * cap) << "the side away from the light is lost";
  EXPECT_GT(1 - *lit->truth[0].occlusion, 0.85 * cap);

  // Clutter is the area of all other measured surfaces, by the same patches.
  const auto pose = scene->truth[0].T_scene_model.cast<double>();
  double whole = 0, own = 0;
  for (std::size_t i = 0; i < scene->depths.size(); ++i) {
    if (scene->depths[i] == 0) continue;
    const double z = scene->exact.depth[i];
    const Vector3d ray((static_cast<double>(i % kScanWidth) - scene->camera.cx) / scene->camera.fx,
                       (static_cast<double>(i / kScanWidth) - scene->camera.cy) / scene->camera.fy,
                       1);
    const bool ball = (z * ray - pose.translation()).norm() < 1.01 * static_cast<double>(r) &&
                      scene->exact.instance[i] == 0;
    const Vector3d normal = scene->exact.normals[i].cast<double>();
    if (std::abs(normal.dot(ray)) <= std::cos(right) * ray.norm()) continue;
    const double patch = z * z / (scene->camera.fx * scene->camera.fy * std::abs(normal.dot(ray)));
    whole += patch;
    if (ball) own += patch;
  }
  EXPECT_NEAR(*scene->truth[0].clutter, 1 - own / whole, 1e-4);
}

TEST(VirtualScanner, GivesLengthsInTheRequestedUnit) {
  const std::vector<ScanModel> models{box_model()};
  const Result<RenderedScene> m = scan(models, exact(2), 1),
                              mm = scan(models, exact(2), 1, LengthUnit::millimeter);
  ASSERT_TRUE(m && mm);
  EXPECT_EQ(m->depths, mm->depths);
  EXPECT_NEAR(mm->camera.depth_scale, 1000 * m->camera.depth_scale, 1e-12);
  EXPECT_TRUE(mm->truth[1].T_scene_model.translation().isApprox(
      1000 * m->truth[1].T_scene_model.translation(), 1e-6F));
  EXPECT_EQ(m->bop.camera, mm->bop.camera) << "always mm";
}

TEST(VirtualScanner, UsesEveryModelBeforeOneComesAgain) {
  const std::vector<ScanModel> models{box_model(),
                                      model_of("b", test::box({0, 0, 0}, {0.1F, 0.1F, 0.05F})),
                                      model_of("c", test::box({0, 0, 0}, {0.1F, 0.05F, 0.05F}))};
  const auto count = [&](std::uint32_t num_instances, std::uint32_t of_a_kind) {
    ScanOptions options = exact(num_instances);
    options.of_a_kind = of_a_kind;
    const Result<RenderedScene> scene = scan(models, options, 4);
    std::map<std::string, int> counts;
    for (const TruthInstance& truth : scene->truth) ++counts[truth.model];
    std::vector<int> sorted;
    for (const auto& [name, n] : counts) sorted.push_back(n);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  EXPECT_EQ(count(6, 1), (std::vector<int>{2, 2, 2}));
  EXPECT_EQ(count(6, 3), (std::vector<int>{3, 3}));
  EXPECT_EQ(count(4, 4), (std::vector<int>{4}));
}

// The walls of a bin and of a room are visible, but the truth does not list them.
TEST(VirtualScanner, PutsBinsAndWallsAround) {
  const std::vector<ScanModel> models{box_model()};
  const auto upright_pixels = [&](bool bin, bool walls) {
    ScanOptions options = exact(4);
    options.bin = bin;
    options.walls = walls;
    const Result<RenderedScene> scene = scan(models, options, 0);
    EXPECT_EQ(scene->truth.size(), 4U);
    const std::size_t corner = 470 * kScanWidth + 5;  // sees the ground
    const Eigen::Vector3f up = scene->exact.normals[corner];
    std::size_t upright = 0;
    for (std::size_t i = 0; i < scene->depths.size(); ++i) {
      if (scene->exact.instance[i] >= 4 && std::abs(up.dot(scene->exact.normals[i])) < 1e-3F)
        ++upright;
    }
    return upright;
  };
  EXPECT_EQ(upright_pixels(false, false), 0U);
  EXPECT_GT(upright_pixels(true, false), 5000U);
  EXPECT_GT(upright_pixels(false, true), 5000U);
}

TEST(VirtualScanner, PutsUnknownPartsAmongTheModels) {
  const std::vector<ScanModel> models{box_model()};
  ScanOptions options = exact(3);
  options.num_clutter = 4;
  const Result<RenderedScene> scene = scan(models, options, 0);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->truth.size(), 3U);
  EXPECT_EQ(scene->bop.instances.size(), 3U);
  std::vector<int> pixels(8);  // of the models, the clutter, the ground
  for (std::size_t i = 0; i < scene->depths.size(); ++i) {
    ASSERT_LT(scene->exact.instance[i], 8U);
    ++pixels[scene->exact.instance[i]];
  }
  EXPECT_GE(std::count_if(pixels.begin() + 3, pixels.end() - 1, [](int n) { return n > 300; }), 2);
  for (std::size_t t = 0; t < 3; ++t)
    EXPECT_EQ(*scene->truth[t].visible_fraction > 0, pixels[t] > 0) << t;
}

TEST(VirtualScanner, RefusesPilesBeyondTheSensorsRange) {
  test::Shape large = test::box({0, 0, 0}, {8, 8, 8});
  const Result<RenderedScene> refused = scan({model_of("house", large)}, {}, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_NE(refused.error().message.find("--diameter"), std::string::npos);
}

TEST(VirtualScanner, RefusesModelsWithoutExtent) {
  const test::Shape point = test::box({1, 1, 1}, {1, 1, 1});
  const Result<RenderedScene> refused = scan({model_of("point", point)}, {}, 0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_data);
  EXPECT_NE(refused.error().message.find("point"), std::string::npos);
  EXPECT_FALSE(scan({}, {}, 0));
}

using Files = std::map<std::string, std::string>;

Files rendered_files(unsigned num_threads, std::uint32_t num_scenes) {
  const test::TempDir folder;
  std::vector<ScanModel> models{box_model()};
  models[0].metal = true;
  ScanOptions options;
  options.num_scenes = num_scenes;
  const ThreadLimit limit(num_threads);
  const Result<Manifest> manifest =
      render_scenes(models, LengthUnit::meter, options, folder / "scan", {});
  EXPECT_TRUE(manifest) << manifest.error().message;
  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "scan")) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(folder / "scan").generic_string()] =
        test::read_bytes(entry.path());
  }
  return files;
}

TEST(RenderScenes, GivesTheSameBytesForAnyNumberOfThreads) {
  EXPECT_EQ(rendered_files(1, 3), rendered_files(2, 3));
}

TEST(RenderScenes, GivesTheSameSceneWhicheverOthersAreRendered) {
  const Files few = rendered_files(2, 2), more = rendered_files(2, 3);
  for (const char* name : {"test/000001/depth/000000.png", "test/000001/depth/000001.png",
                           "models/obj_000001.ply", "models/models_info.json", "camera.json"}) {
    ASSERT_TRUE(few.contains(name)) << name;
    EXPECT_EQ(few.at(name), more.at(name)) << name;
  }
}

TEST(RenderScenes, WritesABopDataSetAndAManifestOverTheSameFiles) {
  const Files files = rendered_files(2, 1);
  for (const char* name :
       {"manifest.json", "camera.json", "models/obj_000001.ply", "models/models_info.json",
        "test/000001/depth/000000.png", "test/000001/scene_camera.json",
        "test/000001/scene_gt.json", "test/000001/scene_gt_info.json",
        "test/000001/scene_gt_coco.json", "test/000001/mask/000000_000000.png",
        "test/000001/mask_visib/000000_000007.png", "test_targets_bop19.json",
        "test_targets_bop24.json"}) {
    ASSERT_TRUE(files.contains(name)) << name;
    EXPECT_FALSE(files.at(name).empty()) << name;
  }
  for (const char* name : {"obj_000001.ply", "models_info.json"})
    EXPECT_EQ(files.at(std::string("models_eval/") + name),
              files.at(std::string("models/") + name));
  EXPECT_EQ(files.size(), 11U + 2 + 2 * 8) << "two masks an instance";
}

TEST(RenderScenes, ScalesModelsAndDeclaresTheirSymmetries) {
  const test::TempDir folder;
  ASSERT_TRUE(write_ply(folder / "box.ply", box_mesh()));
  ScanOptions options;
  options.num_scenes = 1;
  const std::vector<ModelSource> sources{{"box", folder / "box.ply", 1, {}}};
  const Result<std::vector<ScanModel>> models =
      read_scan_models(sources, LengthUnit::millimeter, {.diameter = 200});
  ASSERT_TRUE(models) << models.error().message;
  ASSERT_TRUE(render_scenes(*models, LengthUnit::millimeter, options, folder / "scan", {}));
  const Result<Manifest> manifest = read_manifest(folder / "scan/manifest.json");
  ASSERT_TRUE(manifest) << manifest.error().message;
  ASSERT_TRUE(manifest->models[0].symmetry);
  EXPECT_EQ(manifest->models[0].name, "box") << "its own name";
  EXPECT_EQ(manifest->models[0].scale, 1) << "the file is in mm";
  EXPECT_EQ(manifest->models[0].symmetry->poses.size(), 3U) << "half turns about the axes of a box";
  // About the center of the box, in the requested unit.
  for (const Pose& pose : manifest->models[0].symmetry->poses) {
    const float scale = 200 / kernels::find_diameter(box_mesh().points);
    const Eigen::Vector3f middle = scale * (0.5 * (kLow + kHigh)).cast<float>();
    EXPECT_LT((pose * middle - middle).norm(), 0.5F);
  }
  const Result<Cloud> mesh = read_cloud(manifest->models[0].file);
  ASSERT_TRUE(mesh);
  EXPECT_NEAR(kernels::find_diameter(mesh->points), 200, 1e-3);
  EXPECT_TRUE(manifest->scenes[0].camera);
  EXPECT_EQ(manifest->scenes[0].truth.size(), options.num_instances);
}

TEST(RenderScenes, RefusesCloudsWithoutFaces) {
  const test::TempDir folder;
  Cloud cloud = box_mesh();
  cloud.triangles = {};
  ASSERT_TRUE(write_ply(folder / "cloud.ply", cloud));
  const std::vector<ModelSource> sources{{"cloud", folder / "cloud.ply", 1, {}}};
  const Result<std::vector<ScanModel>> models = read_scan_models(sources, LengthUnit::meter, {});
  ASSERT_FALSE(models);
  EXPECT_EQ(models.error().code, ErrorCode::bad_data);
  EXPECT_NE(models.error().message.find("cloud.ply"), std::string::npos);
}

TEST(RenderScenes, ReportsThatItWasStopped) {
  const test::TempDir folder;
  const std::vector<ScanModel> models{box_model()};
  std::stop_source stop;
  stop.request_stop();
  const Result<Manifest> manifest =
      render_scenes(models, LengthUnit::meter, {}, folder / "scan", {{}, stop.get_token()});
  ASSERT_FALSE(manifest);
  EXPECT_EQ(manifest.error().code, ErrorCode::resumable);
  EXPECT_FALSE(std::filesystem::exists(folder / "scan/manifest.json"));
}

}  // namespace
}  // namespace trivet
