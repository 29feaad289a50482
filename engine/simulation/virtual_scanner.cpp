#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/simulation/measure_scene.hpp"
#include "engine/simulation/pile_up.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/common/ray_scene.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using engine::Body;
using engine::ExactImage;
using engine::Finish;
using engine::PlacedBody;
using kernels::CounterRandom;
using kernels::RayScene;

constexpr double kFocal = 572;         // [pixel], like a Kinect or PrimeSense
constexpr double kFilledShare = 0.85;  // share of the image's width or height that the pile fills
constexpr double kMinVisible = 0.15;   // minimum visible fraction of instances that are not ignored
constexpr int kMinVisiblePixels = 300;
constexpr double kBinHeight = 0.5;         // relative to the pile's height
constexpr double kBinThickness = 0.005;    // [m]
constexpr double kWallDistance = 0.02;     // [m] behind the pile
constexpr std::size_t kClutterKinds = 12;  // maximum
// Relative to the models' mean diameter.
constexpr double kSmallestClutter = 0.5, kLargestClutter = 1.1;
constexpr std::uint64_t kClutterSeed = 0xC1C7;  // generates other parts than the models
enum Item : std::uint64_t {
  kPile,
  kCamera,
  kChoice,
  kFinish,
  kClutter,
  kFlaws,
  kSetting,
  kImageSize
};  // separate streams of random numbers

// Distribution of scenes under ScanOptions::randomize.
constexpr double kShortestFocal = 400, kLongestFocal = 1000;  // [pixel]
// Maximum distance relative to the nearest that frames the pile.
constexpr double kFarthestView = 2.5;
constexpr double kOfRange = 0.95;         // share of the sensor's range that the pile lies within
constexpr std::uint32_t kWideScan = 848;  // columns in half of the sets
constexpr double kGlossyShare = 0.25;     // share of nonmetal objects
constexpr double kBlackShare = 0.15;      // share of objects
// Share of scenes: a table with an end, a floor and a wall behind.
constexpr double kRoomShare = 0.6;

/// Choose `of_a_kind` of every model in a random order, then again in another order, with clutter
/// among them. Indices of clutter start at num_models.
std::vector<std::uint32_t> choose_bodies(std::size_t num_models, std::size_t num_clutter_kinds,
                                         const ScanOptions& options, CounterRandom& random) {
  const auto shuffle = [&](std::vector<std::uint32_t>& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[random.next() % i]);
  };
  std::vector<std::uint32_t> chosen;
  std::vector<std::uint32_t> round(num_models);
  while (chosen.size() < options.num_instances) {
    for (std::size_t i = 0; i < num_models; ++i) round[i] = static_cast<std::uint32_t>(i);
    shuffle(round);
    for (const std::uint32_t model : round) chosen.insert(chosen.end(), options.of_a_kind, model);
  }
  chosen.resize(options.num_instances);
  for (std::uint32_t i = 0; i < options.num_clutter; ++i) {
    chosen.push_back(static_cast<std::uint32_t>(num_models + random.next() % num_clutter_kinds));
  }
  shuffle(chosen);
  return chosen;
}

/// Generate parts other than the models, about as large as these.
std::vector<ScanModel> make_clutter(const ScanOptions& options, std::span<const Body> bodies) {
  double mean = 0;
  for (const Body& body : bodies)
    mean += static_cast<double>(body.diameter) / static_cast<double>(bodies.size());
  const std::size_t n = std::min<std::size_t>(options.num_clutter, kClutterKinds);
  std::vector<ScanModel> clutter = make_scan_models(n, options.seed ^ kClutterSeed);
  CounterRandom random(options.seed, 0, kClutter);
  for (ScanModel& model : clutter) {
    const double diameter = mean * random.uniform(kSmallestClutter, kLargestClutter);
    const auto factor =
        static_cast<float>(diameter / static_cast<double>(kernels::find_diameter(model.vertices)));
    for (std::size_t i = 0; i < model.vertices.size(); ++i)
      model.vertices.set(i, factor * model.vertices[i]);
  }
  return clutter;
}

/// A surface that belongs to no model.
struct Sheet {
  Points vertices;
  Triangles triangles;

  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Vector3d& corner : {a, b, c, d}) vertices.push_back(corner.cast<float>());
    triangles.push_back(first, first + 1, first + 2);
    triangles.push_back(first, first + 2, first + 3);
  }
};

/// Add a square at z = 0 under everything that the camera sees.
void add_ground(double half_side, Sheet& sheet) {
  sheet.add({-half_side, -half_side, 0}, {half_side, -half_side, 0}, {half_side, half_side, 0},
            {-half_side, half_side, 0});
}

/// Height of the walls: half the pile's height, and at least the height of anything that leans on
/// them.
double bin_height(const Points& points, const engine::BinSize& half) {
  double top = 0, leaning = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d p = points[i].cast<double>();
    top = std::max(top, p.z());
    if ((half - p.head<2>().cwiseAbs()).minCoeff() < kBinThickness)
      leaning = std::max(leaning, p.z());
  }
  return std::max(kBinHeight * top, leaning) + kBinThickness;
}

/// Add the inner and outer faces of four walls, and their rim.
void add_bin(const engine::BinSize& half, double height, Sheet& sheet) {
  const engine::BinSize outer = half.array() + kBinThickness;
  const auto corner = [](const engine::BinSize& size, int i, double z) {
    return Vector3d(i == 0 || i == 3 ? -size.x() : size.x(), i < 2 ? -size.y() : size.y(), z);
  };
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    sheet.add(corner(half, i, 0), corner(half, j, 0), corner(half, j, height),
              corner(half, i, height));
    sheet.add(corner(outer, i, 0), corner(outer, j, 0), corner(outer, j, height),
              corner(outer, i, height));
    sheet.add(corner(half, i, height), corner(half, j, height), corner(outer, j, height),
              corner(outer, i, height));
  }
}

/// Add two walls that meet behind the points, as seen from the camera.
void add_walls(const Points& points, const Pose& T_camera_world, double half_side, Sheet& sheet) {
  const Vector3d view = T_camera_world.linear().cast<double>().row(2);
  const double azimuth = std::atan2(view.y(), view.x());
  std::array<Vector3d, 2> away;
  std::array<double, 2> distance{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double angle = azimuth + (k == 0 ? -1 : 1) * std::numbers::pi / 4;
    away[k] = {std::cos(angle), std::sin(angle), 0};
    for (std::size_t i = 0; i < points.size(); ++i) {
      distance[k] = std::max(distance[k], away[k].dot(points[i].cast<double>()) + kWallDistance);
    }
  }
  const Vector3d foot = distance[0] * away[0] + distance[1] * away[1], top(0, 0, half_side);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector3d end = foot - half_side * away[1 - k];
    sheet.add(foot, end, end + top, foot + top);
  }
}

/// The surface points of the pile, in the world.
Points surface_points(std::span<const Body> bodies, std::span<const PlacedBody> placed) {
  Points points;
  for (const PlacedBody& instance : placed) {
    const PointsView vertices = bodies[instance.body].vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      points.push_back(instance.T_world_body * vertices[i]);
  }
  return points;
}

struct Elevations {
  double low, high;  // elevation above the ground [degree]
};

/// Camera position and lens of a scene.
struct Setting {
  Elevations elevations;
  double nearest, farthest;  // range of the sensor [m]
  double focal = kFocal;     // [pixel], at a resolution of 1
  double retreat = 1;        // factor on the minimum camera distance, within range
  // Displacement of the pile from the image's center, -1..1 of the maximum.
  double off_u = 0, off_v = 0;
};

Setting draw_setting(const ScanOptions& options, const engine::SensorTraits& sensor,
                     CounterRandom& random) {
  Setting setting{.elevations = options.bin ? Elevations{60, 85} : Elevations{40, 75},
                  .nearest = sensor.nearest,
                  .farthest = sensor.farthest};
  if (!options.randomize) return setting;
  setting.focal = kShortestFocal * std::pow(kLongestFocal / kShortestFocal, random.uniform());
  setting.elevations = options.bin ? Elevations{50, 88} : Elevations{25, 85};
  setting.retreat = std::pow(kFarthestView, random.uniform());
  setting.off_u = random.uniform(-1, 1);
  setting.off_v = random.uniform(-1, 1);
  return setting;
}

std::uint32_t scaled(std::uint32_t pixels, double resolution) {
  return static_cast<std::uint32_t>(std::lround(resolution * pixels));
}

/// Create an empty image: its flaws, its size and its camera.
///
/// focal  focal length at a resolution of 1 [pixel]
RenderedScene choose_image(const ScanOptions& options, LengthUnit unit, double focal,
                           std::uint32_t index) {
  RenderedScene scene;
  if (options.randomize) {
    CounterRandom random(options.seed, index, kFlaws);
    scene.flaws = engine::draw_flaws(options.sensor.sensor, random);
    // All images of a set have one size, since BOP's camera.json has only one.
    if (CounterRandom(options.seed, 0, kImageSize).uniform() < 0.5) scene.width = kWideScan;
  }
  scene.width = scaled(scene.width, options.resolution);
  scene.height = scaled(scene.height, options.resolution);
  focal *= options.resolution;
  const double depth_step = engine::traits_of(options.sensor.sensor).depth_step;
  scene.true_camera = {focal, focal, 0.5 * (scene.width - 1), 0.5 * (scene.height - 1),
                       depth_step * unit_scale(LengthUnit::meter, unit)};
  scene.camera = engine::written_camera(scene.true_camera, scene.flaws.calibration);
  scene.bop.id = static_cast<int>(index);
  scene.bop.camera = scene.camera;
  scene.bop.camera.depth_scale = depth_step * 1000;
  return scene;
}

/// A camera that looks down on the points from a random side. It is as near as possible with all
/// points in view and a margin around them, but within the sensor's range; or farther away.
Pose place_camera(const Points& points, const Camera& camera, const Setting& setting,
                  CounterRandom& random) {
  const auto& [elevations, nearest, farthest, focal, retreat, off_u, off_v] = setting;
  const double elevation = random.uniform(elevations.low, elevations.high) * std::numbers::pi / 180;
  const double azimuth = random.uniform(0, 2 * std::numbers::pi);
  const Vector3d away(std::cos(elevation) * std::cos(azimuth),
                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Eigen::Matrix3d axes;  // rows: the camera's x, y and z axes in the world
  axes.row(2) = -away;
  axes.row(0) = Vector3d::UnitZ().cross(away).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));

  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) box.extend(axes * points[i].cast<double>());
  const Vector3d middle = box.center();
  const double width = kFilledShare * camera.cx / camera.fx,
               height = kFilledShare * camera.cy / camera.fy;
  double distance = 0;  // distance from the camera to the center
  double depth = 0;     // depth of the pile beyond the center
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d p = axes * points[i].cast<double>() - middle;
    distance = std::max({distance, nearest - p.z(), std::abs(p.x()) / width - p.z(),
                         std::abs(p.y()) / height - p.z()});
    depth = std::max(depth, p.z());
  }
  Vector3d offset(0, 0, distance);
  if (retreat > 1) {
    offset.z() = std::max(distance, std::min(retreat * distance, kOfRange * farthest - depth));
    offset.x() = off_u * (offset.z() - distance) * width;
    offset.y() = off_v * (offset.z() - distance) * height;
  }
  Pose T_camera_world = Pose::Identity();
  T_camera_world.linear() = axes.cast<float>();
  T_camera_world.translation() = (offset - middle).cast<float>();
  return T_camera_world;
}

/// Largest distance from the camera's plane [m].
double farthest_depth(const Points& points, const Pose& T_camera_world) {
  float farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    farthest = std::max(farthest, (T_camera_world * points[i]).z());
  return static_cast<double>(farthest);
}

/// Add a table that ends a little beyond the pile, on a floor, in front of a wall.
void add_room(const Points& points, const Pose& T_camera_world, CounterRandom& random,
              Sheet& sheet) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) box.extend(points[i].cast<double>());
  const Vector3d view = T_camera_world.linear().cast<double>().row(2);
  const double azimuth = std::atan2(view.y(), view.x()) + random.uniform(-0.5, 0.5);
  const Vector3d forward(std::cos(azimuth), std::sin(azimuth), 0),
      sideways(-forward.y(), forward.x(), 0);
  const auto corners = [&](double back, double front, double side, double z) {
    const Vector3d middle = box.center(), up(0, 0, z - middle.z());
    sheet.add(middle + up - back * forward - side * sideways,
              middle + up + front * forward - side * sideways,
              middle + up + front * forward + side * sideways,
              middle + up - back * forward + side * sideways);
  };
  const double extent = box.sizes().head<2>().norm() / 2, floor = -random.uniform(0.4, 1);
  corners(extent + 0.5, extent + random.uniform(0.02, 0.5), extent + random.uniform(0.05, 0.6), 0);
  const double wall = extent + random.uniform(1, 3), far = 20 * wall;
  corners(far, wall, far, floor);
  const Vector3d foot = box.center() + wall * forward, up(0, 0, 1);
  sheet.add(foot - far * sideways + floor * up, foot + far * sideways + floor * up,
            foot + far * sideways + far * up, foot - far * sideways + far * up);
}

/// Draw the finish of an object in a scene. Random numbers are drawn in the order of the objects.
Finish choose_finish(const ScanModel& model, bool randomize, CounterRandom& finish,
                     CounterRandom& drawn) {
  Finish out{model.metal, finish.uniform(0.15, 0.9)};
  if (!randomize) return out;
  const double glossy = drawn.uniform(), black = drawn.uniform();
  out.metal = model.metal || glossy < kGlossyShare;
  if (black < kBlackShare) out.reflectance = drawn.uniform(0.02, 0.15);
  return out;
}

/// Surfaces that are not objects: the ground or a room, the bin, walls.
struct Surroundings {
  Sheet sheet;
  Finish finish;
};

/// range  range of the farthest point [m]
Surroundings surround(const Points& points, const Pose& T_camera_world, double range,
                      const engine::BinSize& bin, const ScanOptions& options,
                      CounterRandom& random) {
  Surroundings out;
  const double room = random.uniform(), ground = random.uniform(0.15, 0.9);
  if (options.randomize) out.finish.reflectance = ground;
  if (options.randomize && room < kRoomShare) {
    add_room(points, T_camera_world, random, out.sheet);
  } else {
    add_ground(20 * range, out.sheet);
  }
  if (options.bin) add_bin(bin, bin_height(points, bin), out.sheet);
  if (options.walls) add_walls(points, T_camera_world, 20 * range, out.sheet);
  return out;
}

/// The number of pixels that would show an object without occlusion, including those beyond the
/// image.
Result<int> count_silhouette(const RayScene::Instance& object, PointsView vertices,
                             const Camera& camera) {
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3d p = (object.T_world_scene * vertices[i]).cast<double>();
    box.extend(Eigen::Vector2d(camera.fx * p.x() / p.z() + camera.cx,
                               camera.fy * p.y() / p.z() + camera.cy));
  }
  const Eigen::Vector2d low = box.min().array().floor(), high = box.max().array().ceil();
  Camera window = camera;
  window.cx -= low.x();
  window.cy -= low.y();
  TRIVET_TRY_ASSIGN(const RayScene alone, RayScene::from_instances(std::span(&object, 1)));
  const auto width = static_cast<std::uint32_t>(high.x() - low.x()) + 1,
             height = static_cast<std::uint32_t>(high.y() - low.y()) + 1;
  const ExactImage image = engine::render_exactly(alone, window, width, height);
  return static_cast<int>(image.depth.size() -
                          static_cast<std::size_t>(std::ranges::count(image.depth, 0.0F)));
}

/// Measurements of each instance.
struct Measured {
  std::vector<int> visible;  // number of pixels of the exact image that show it
  std::vector<double> area;  // measured area [m^2]
  double total_area = 0;     // area of the whole scene
};

Measured count_measured(const ExactImage& image, std::span<const std::uint16_t> depths,
                        const Camera& camera, std::size_t num_instances) {
  Measured out{std::vector<int>(num_instances), std::vector<double>(num_instances), 0};
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    if (image.depth[i] == 0) continue;
    const auto u = static_cast<double>(i % image.width), v = static_cast<double>(i / image.width);
    ++out.visible[image.instance[i]];
    if (depths[i] == 0) continue;
    const Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
    const auto z = static_cast<double>(image.depth[i]);
    const double facing = std::abs(image.normals[i].cast<double>().dot(ray));
    if (facing <= static_cast<double>(kernels::kMinViewCosine) * ray.norm()) continue;
    const double patch = z * z / (camera.fx * camera.fy * facing);
    out.area[image.instance[i]] += patch;
    out.total_area += patch;
  }
  return out;
}

/// Visibility of an object in the exact image.
struct VisiblePixels {
  int num_all = 0, num_visible = 0;  // pixels of the silhouette, and those that show the object

  double fraction() const {
    if (num_all == 0) return 0;
    return std::min(1.0, static_cast<double>(num_visible) / num_all);
  }
  /// The resulting ground truth.
  TruthInstance truth() const {
    TruthInstance out;
    out.visible_fraction = fraction();
    out.ignore = out.visible_fraction < kMinVisible || num_visible < kMinVisiblePixels;
    return out;
  }
};

double area_of(PointsView vertices, const Triangles& triangles) {
  double area = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3d a = vertices[triangles.a[t]].cast<double>(),
                   b = vertices[triangles.b[t]].cast<double>(),
                   c = vertices[triangles.c[t]].cast<double>();
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

Pose scaled(Pose pose, double factor) {
  pose.translation() = (factor * pose.translation().cast<double>()).cast<float>();
  return pose;
}

}  // namespace

struct VirtualScanner::State {
  std::span<const ScanModel> models;
  LengthUnit unit;
  ScanOptions options;
  std::vector<ScanModel> clutter;  // kinds of clutter
  std::vector<Body> bodies;        // one per model, then one per kind of clutter
  std::vector<RayScene> meshes;    // in the same order
  std::vector<double> areas;       // one per model [m^2]
};

VirtualScanner::VirtualScanner(std::unique_ptr<const State> state) : state_(std::move(state)) {}
VirtualScanner::VirtualScanner(VirtualScanner&&) noexcept = default;
VirtualScanner& VirtualScanner::operator=(VirtualScanner&&) noexcept = default;
VirtualScanner::~VirtualScanner() = default;

Result<VirtualScanner> VirtualScanner::create(std::span<const ScanModel> models, LengthUnit unit,
                                              const ScanOptions& options) {
  TRIVET_TRY(validate(options));
  if (models.empty())
    return Error{ErrorCode::bad_data, "at least one model expected to scan, none found"};
  auto state = std::make_unique<State>(State{models, unit, options, {}, {}, {}, {}});
  const auto add = [&](const ScanModel& model) -> Result<void> {
    TRIVET_TRY_ASSIGN(RayScene mesh, RayScene::from_mesh(model.vertices, model.triangles));
    state->meshes.push_back(std::move(mesh));
    state->bodies.push_back(engine::make_body(model.vertices, model.triangles));
    if (state->bodies.back().diameter > 0) return {};
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected an object of some size, found all of its corners at one "
                             "place",
                             model.name)};
  };
  for (const ScanModel& model : models) {
    TRIVET_TRY(add(model));
    state->areas.push_back(area_of(model.vertices, model.triangles));
  }
  state->clutter = make_clutter(options, state->bodies);
  for (const ScanModel& model : state->clutter) {
    TRIVET_TRY(add(model));
  }
  return VirtualScanner(std::move(state));
}

Result<RenderedScene> VirtualScanner::scan(std::uint32_t index) const {
  const auto& [models, unit, options, clutter, bodies, meshes, areas] = *state_;
  const engine::SensorTraits& sensor = engine::traits_of(options.sensor.sensor);
  const auto random_of = [&options = options, index](Item item) {
    return CounterRandom(options.seed, index, item);
  };

  CounterRandom choice = random_of(kChoice);
  const std::vector<std::uint32_t> order =
      choose_bodies(models.size(), clutter.size(), options, choice);
  const engine::BinSize bin = options.bin ? engine::choose_bin(bodies, order) : engine::kTable;
  std::vector<PlacedBody> placed = engine::pile_up(bodies, order, bin, options.seed, index);
  std::stable_partition(
      placed.begin(), placed.end(),
      [&models = models](const PlacedBody& instance) { return instance.body < models.size(); });

  CounterRandom drawn = random_of(kSetting);
  const Setting setting = draw_setting(options, sensor, drawn);
  RenderedScene scene = choose_image(options, unit, setting.focal, index);
  const Points points = surface_points(bodies, placed);
  CounterRandom view = random_of(kCamera);
  const Pose T_camera_world = place_camera(points, scene.true_camera, setting, view);
  const double range = farthest_depth(points, T_camera_world);
  if (range > sensor.farthest) {
    return Error{ErrorCode::usage,
                 fmt::format("scene {}: expected a pile that the sensor sees from within {} m, "
                             "found one that it takes {:.3g} m to see; give the models' unit with "
                             "--unit, a size with --diameter, or another --sensor",
                             index, sensor.farthest, range)};
  }

  // Instance i is placed[i], models first; surfaces that are not objects follow.
  std::vector<RayScene::Instance> instances;
  std::vector<Finish> finishes;
  CounterRandom finish = random_of(kFinish);
  for (const PlacedBody& instance : placed) {
    const ScanModel& model = instance.body < models.size() ? models[instance.body]
                                                           : clutter[instance.body - models.size()];
    instances.push_back({&meshes[instance.body], T_camera_world * instance.T_world_body});
    finishes.push_back(choose_finish(model, options.randomize, finish, drawn));
  }
  const Surroundings around = surround(points, T_camera_world, range, bin, options, drawn);
  TRIVET_TRY_ASSIGN(const RayScene sheet,
                    RayScene::from_mesh(around.sheet.vertices, around.sheet.triangles));
  instances.push_back({&sheet, T_camera_world});
  finishes.push_back(around.finish);
  TRIVET_TRY_ASSIGN(const RayScene rays, RayScene::from_instances(instances));
  scene.exact = engine::render_exactly(rays, scene.true_camera, scene.width, scene.height);
  scene.depths = engine::measure_scene({rays, scene.true_camera, scene.exact, finishes},
                                       options.sensor, options.seed, index, scene.flaws);

  const Measured measured =
      count_measured(scene.exact, scene.depths, scene.true_camera, instances.size());
  for (std::size_t i = 0; i < options.num_instances; ++i) {
    const std::uint32_t model = placed[i].body;
    TRIVET_TRY_ASSIGN(const int num_all,
                      count_silhouette(instances[i], models[model].vertices, scene.true_camera));
    const Pose T_written_model =
        engine::written_pose(instances[i].T_world_scene, bodies[model].center.cast<double>(),
                             scene.true_camera, scene.flaws.calibration);
    BopInstance& bop = scene.bop.instances.emplace_back();
    bop.object_id = static_cast<int>(model) + 1;
    bop.T_camera_model = scaled(T_written_model, 1000);
    TruthInstance truth = VisiblePixels{num_all, measured.visible[i]}.truth();
    truth.model = models[model].name;
    truth.T_scene_model = scaled(T_written_model, unit_scale(LengthUnit::meter, unit));
    truth.occlusion = 1 - std::min(1.0, measured.area[i] / areas[model]);
    truth.clutter = measured.total_area > 0 ? 1 - measured.area[i] / measured.total_area : 1;
    scene.truth.push_back(std::move(truth));
  }
  return scene;
}

}  // namespace trivet
