#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/parallel.hpp"
#include "engine/pile_up.hpp"
#include "engine/render_scenes.hpp"
#include "kernels/counter_random.hpp"
#include "kernels/pixel_window.hpp"
#include "kernels/ray_scene.hpp"
#include "kernels/render_depth.hpp"
#include "kernels/visibility.hpp"

namespace trivet {
namespace {

using engine::PlacedModel;
using kernels::CounterRandom;
using kernels::PixelWindow;
using kernels::RayScene;

constexpr double kFocal = 572;  // [pixel], as of a Kinect or PrimeSense
constexpr double kDepthStepMetres = 1e-4;
constexpr double kNearestMetres = 0.45;  // nearer, such sensors measure nothing
constexpr double kFarthestMetres = 6;    // 16 bits end at 6.5
constexpr double kFilledShare = 0.85;    // of the image's width or height, by the heap
constexpr double kMinVisible = 0.15;     // instances of which less is seen are ignored
constexpr std::size_t kMinVisiblePixels = 300;
constexpr std::size_t kRowGrain = 16;

struct DepthImage {
  std::vector<float> depth = std::vector<float>(std::size_t{kScanWidth} * kScanHeight);
  std::vector<std::uint32_t> instance =
      std::vector<std::uint32_t>(depth.size(), kernels::Hit::kNone);
};

/// Whole rows, those of the window.
void render(const RayScene& rays, const Camera& camera, const PixelWindow& window,
            DepthImage& image) {
  engine::for_chunks(window.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    const std::size_t begin = (window.top + first) * kScanWidth, size = count * kScanWidth;
    kernels::render_depth(rays, camera, kScanWidth, static_cast<std::uint32_t>(window.top + first),
                          std::span(image.depth).subspan(begin, size),
                          std::span(image.instance).subspan(begin, size));
  });
}

/// A square on z = 0 under everything that the camera sees.
Result<RayScene> make_ground(float half_side) {
  Points corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    corners.push_back({half_side * static_cast<float>(x), half_side * static_cast<float>(y), 0});
  }
  Triangles faces;
  faces.push_back(0, 1, 2);
  faces.push_back(0, 2, 3);
  return RayScene::from_mesh(corners, faces);
}

/// The corners of the heap: every sample of every instance, in the world.
Points surface_points(std::span<const Model> models, std::span<const PlacedModel> placed) {
  Points points;
  for (const PlacedModel& instance : placed) {
    const PointsView samples = models[instance.model].samples;
    for (std::size_t i = 0; i < samples.size(); ++i)
      points.push_back(instance.T_world_model * samples[i]);
  }
  return points;
}

/// A camera that looks down on the points from a random side, 40 to 75 degrees above the ground, as
/// near as it sees them all with some room around them, and not nearer than `nearest`.
Pose place_camera(const Points& points, const Camera& camera, double nearest,
                  CounterRandom& random) {
  const double elevation = random.uniform(40, 75) * std::numbers::pi / 180;
  const double azimuth = random.uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d away(std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Eigen::Matrix3d axes;  // rows: the camera's x, y and z in the world
  axes.row(2) = -away;
  axes.row(0) = Eigen::Vector3d::UnitZ().cross(away).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));

  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) box.extend(axes * points[i].cast<double>());
  const Eigen::Vector3d middle = box.center();
  const double width = kFilledShare * camera.cx / camera.fx,
               height = kFilledShare * camera.cy / camera.fy;
  double distance = 0;  // from the camera to the middle
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = axes * points[i].cast<double>() - middle;
    distance = std::max({distance, nearest - p.z(), std::abs(p.x()) / width - p.z(),
                         std::abs(p.y()) / height - p.z()});
  }
  Pose T_camera_world = Pose::Identity();
  T_camera_world.linear() = axes.cast<float>();
  T_camera_world.translation() = (distance * Eigen::Vector3d::UnitZ() - middle).cast<float>();
  return T_camera_world;
}

/// What the sensor makes of the exact depths.
std::vector<std::uint16_t> measure(const std::vector<float>& depth, const Camera& camera,
                                   double metres, const ScanOptions& options, std::uint32_t index) {
  // Between neighbouring pixels, depth on a surface that steep changes by so many times their
  // distance.
  const double min_cosine = static_cast<double>(kernels::kMinViewCosine);
  const double steepest = std::sqrt(1 - min_cosine * min_cosine) / min_cosine;
  std::vector<std::uint16_t> out(depth.size());
  engine::for_chunks(kScanHeight, kRowGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first * kScanWidth; i < (first + count) * kScanWidth; ++i) {
      const auto z = static_cast<double>(depth[i]);
      const std::size_t u = i % kScanWidth, v = i / kScanWidth;
      const auto steep = [&](std::size_t neighbour) {
        return std::abs(static_cast<double>(depth[neighbour]) - z) > steepest * z / camera.fx;
      };
      if (z == 0 || (u > 0 && steep(i - 1)) || (u + 1 < kScanWidth && steep(i + 1)) ||
          (v > 0 && steep(i - kScanWidth)) || (v + 1 < kScanHeight && steep(i + kScanWidth))) {
        continue;
      }
      CounterRandom random(options.seed, index, i + 2);  // 0: the heap, 1: the camera
      const double range = z * metres - 0.4;
      const double sigma = static_cast<double>(options.noise) * (0.0012 + 0.0019 * range * range);
      const double steps = std::round((z * metres + sigma * random.normal()) / kDepthStepMetres);
      if (steps >= 1 && steps <= 65535) out[i] = static_cast<std::uint16_t>(steps);
    }
  });
  return out;
}

}  // namespace

Result<RenderedScene> render_scene(std::span<const Model> models, LengthUnit unit,
                                   const ScanOptions& options, std::uint32_t index) {
  assert(!models.empty() && "something to lay down");
  const double metres = unit_scale(unit, LengthUnit::metre);
  const std::vector<PlacedModel> placed =
      engine::pile_up(models, options.num_instances, options.seed, index);
  RenderedScene scene;
  scene.camera = {kFocal, kFocal, 0.5 * (kScanWidth - 1), 0.5 * (kScanHeight - 1),
                  kDepthStepMetres / metres};
  CounterRandom random(options.seed, index, 1);
  const Points points = surface_points(models, placed);
  const Pose T_camera_world = place_camera(points, scene.camera, kNearestMetres / metres, random);
  float farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    farthest = std::max(farthest, (T_camera_world * points[i]).z());
  if (static_cast<double>(farthest) * metres > kFarthestMetres) {
    return Error{
        ErrorCode::usage,
        fmt::format("scene {}: expected a heap that a depth camera sees from within {} m, found "
                    "one that it takes "
                    "{:.3g} m to see; give the models' unit with --unit, or a size with --diameter",
                    index, kFarthestMetres, static_cast<double>(farthest) * metres)};
  }

  // Surfaces: instance i is placed[i], the ground comes last.
  std::vector<std::optional<RayScene>> meshes(models.size());
  std::vector<RayScene::Instance> instances;
  for (const PlacedModel& instance : placed) {
    std::optional<RayScene>& mesh = meshes[instance.model];
    if (!mesh) {
      Result<RayScene> made =
          RayScene::from_mesh(models[instance.model].vertices, models[instance.model].triangles);
      if (!made) return made.error();
      mesh.emplace(std::move(*made));
    }
    instances.push_back({&*mesh, T_camera_world * instance.T_world_model});
  }
  const Result<RayScene> ground = make_ground(20 * farthest);
  if (!ground) return ground.error();
  instances.push_back({&*ground, T_camera_world});
  const Result<RayScene> rays = RayScene::from_instances(instances);
  if (!rays) return rays.error();
  DepthImage image;
  render(*rays, scene.camera, {0, 0, kScanWidth, kScanHeight}, image);

  std::vector<std::size_t> seen(instances.size());
  for (const std::uint32_t instance : image.instance) {
    if (instance != kernels::Hit::kNone) ++seen[instance];
  }
  for (std::size_t i = 0; i < placed.size(); ++i) {
    // The object alone: what of it the others cover.
    const Result<RayScene> alone = RayScene::from_instances(std::span(instances).subspan(i, 1));
    if (!alone) return alone.error();
    const Model& model = models[placed[i].model];
    const Pose& T_camera_model = instances[i].T_world_scene;
    DepthImage own;
    const Eigen::Vector3d centre = (T_camera_model * model.centre).cast<double>();
    render(*alone, scene.camera,
           kernels::window_of_ball(scene.camera, kScanWidth, kScanHeight, centre,
                                   static_cast<double>(model.diameter)),
           own);
    const auto pixels =
        own.instance.size() - static_cast<std::size_t>(std::count(
                                  own.instance.begin(), own.instance.end(), kernels::Hit::kNone));
    const double visible =
        pixels == 0 ? 0 : static_cast<double>(seen[i]) / static_cast<double>(pixels);
    scene.truth.push_back({model.name, T_camera_model, 1 - visible,
                           visible < kMinVisible || seen[i] < kMinVisiblePixels});
  }
  scene.depths = measure(image.depth, scene.camera, metres, options, index);
  return scene;
}

}  // namespace trivet
