#include "engine/evaluation/bop_scores.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "engine/common/parallel.hpp"
#include "engine/evaluation/average_precision.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/evaluation/object_view.hpp"
#include "kernels/common/ray_scene.hpp"
#include "kernels/verification/pose_errors.hpp"
#include "storage/common/precondition.hpp"

namespace trivet {
namespace {

using Eigen::Isometry3d;
using engine::MeasuredImage;
using engine::ObjectImage;
using kernels::PixelWindow;
using kernels::RayScene;

constexpr double kMinVisible = 0.1;
constexpr std::size_t kMaxEstimates = 100;  // maximum per image, for detection
constexpr double kImageWidth = 640;         // reference width of thresholds in pixels
constexpr std::size_t kNumThresholds = kBopShares.size();
// Combinations with tolerances.
constexpr std::size_t kNumVsdThresholds = kNumThresholds * kNumThresholds;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

double pixel_threshold(std::size_t i) noexcept { return 5 * static_cast<double>(i + 1); }
double mm_threshold(std::size_t i) noexcept { return 2 * static_cast<double>(i + 1); }

/// A model prepared for measuring errors.
struct Gauge {
  const EvaluationMesh* mesh;
  std::vector<Isometry3d> symmetries;
  Eigen::Vector3d center;  // center of a ball around all vertices
  double radius;
  std::optional<RayScene> rays;  // empty without triangles
};

Result<Gauge> make_gauge(const EvaluationMesh& mesh) {
  const auto refuse = [&](const char* expected) {
    return Error{ErrorCode::bad_data,
                 fmt::format("the mesh that errors of '{}' are measured on: expected {}, found {} "
                             "vertices and a diameter of {}",
                             mesh.name, expected, mesh.vertices.size(), mesh.diameter)};
  };
  if (mesh.vertices.empty()) return refuse("at least one vertex");
  if (!(mesh.diameter > 0)) return refuse("a diameter above 0");
  Gauge gauge{&mesh, kernels::discretize_symmetry(mesh.symmetry), {}, 0, {}};
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    box.extend(mesh.vertices[i].cast<double>());
  gauge.center = box.center();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    gauge.radius = std::max(gauge.radius, (mesh.vertices[i].cast<double>() - gauge.center).norm());
  }
  if (!mesh.triangles.empty()) {
    TRIVET_TRY_ASSIGN(RayScene rays, RayScene::from_mesh(mesh.vertices, mesh.triangles));
    gauge.rays.emplace(std::move(rays));
  }
  return gauge;
}

PixelWindow window_of(const Gauge& gauge, const Pose& pose, const MeasuredImage& measured) {
  return kernels::window_of_ball(measured.camera, measured.window.width, measured.window.height,
                                 pose.cast<double>() * gauge.center, gauge.radius);
}

Result<ObjectImage> render(const Gauge& gauge, const Pose& pose, const PixelWindow& window,
                           const MeasuredImage& measured) {
  return engine::render_object(*gauge.rays, pose, measured.camera, window);
}

/// One value per pair of an estimate and a truth.
template <class T>
class PairTable {
 public:
  PairTable() = default;
  PairTable(std::size_t num_estimates, std::size_t num_truths)
      : num_truths_(num_truths), values_(num_estimates * num_truths) {}
  T& operator()(std::size_t e, std::size_t t) { return values_[e * num_truths_ + t]; }
  const T& operator()(std::size_t e, std::size_t t) const { return values_[e * num_truths_ + t]; }

 private:
  std::size_t num_truths_ = 0;
  std::vector<T> values_;
};

/// The detections of one model in one scene and its instances there.
struct Group {
  std::size_t model = 0;                // index of the gauge
  std::vector<std::size_t> detections;  // indices in the scene's result, by falling score
  std::vector<std::size_t> truths;      // indices in the scene
  std::vector<float> scores;            // one per detection
  std::vector<bool> visible;            // one per truth: whether at least 10 % is visible
  std::vector<bool> targets;            // one per truth: whether localization must find it
  std::size_t num_wanted = 0;           // number of detections used for localization
  std::size_t num_kept = 0;             // number of detections among the 100 best of the image

  bool has_image = false, has_vsd = false;
  PairTable<double> mssd;                 // [manifest unit]
  PairTable<double> mspd;                 // [pixel of 640]; zeros without an image
  PairTable<std::array<double, 10>> vsd;  // zeros without an image or faces
};

std::size_t count_true(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

double visible_share(const TruthInstance& truth) noexcept {
  return truth.visible_fraction.value_or(truth.ignore ? 0 : 1);
}

/// The number of instances that localization must find, and which truths they are: the most visible
/// ones.
void choose_targets(const ManifestScene& scene, const std::string& model, Group& group) {
  if (scene.targets.empty()) {
    group.num_wanted = count_true(group.visible);
  } else {
    const auto target = std::ranges::find(scene.targets, model, &SceneTarget::model);
    group.num_wanted = target == scene.targets.end() ? 0 : target->num_instances;
  }
  std::vector<std::size_t> order(group.truths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t t) {
    return visible_share(scene.truth[group.truths[t]]);
  });
  group.targets.assign(group.truths.size(), false);
  for (std::size_t i = 0; i < std::min(group.num_wanted, order.size()); ++i)
    group.targets[order[i]] = true;
}

/// Group a scene's truths and detections by model. Detections of models without a truth are
/// counted.
std::vector<Group> make_groups(const ManifestScene& scene, const SceneResult& result,
                               const std::map<std::string, std::size_t>& models,
                               std::size_t& num_absent) {
  std::map<std::size_t, Group> groups;
  for (std::size_t t = 0; t < scene.truth.size(); ++t) {
    const auto model = models.find(scene.truth[t].model);
    if (model == models.end()) continue;
    Group& group = groups[model->second];
    group.model = model->second;
    group.truths.push_back(t);
    group.visible.push_back(visible_share(scene.truth[t]) >= kMinVisible);
  }

  std::vector<std::size_t> order;
  for (std::size_t d = 0; d < result.detections.size(); ++d) {
    if (models.contains(result.detections[d].model)) order.push_back(d);
  }
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t d) { return result.detections[d].score; });
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const Detection& detection = result.detections[order[rank]];
    const auto group = groups.find(models.at(detection.model));
    const bool kept = rank < kMaxEstimates;
    if (group == groups.end()) {
      num_absent += kept ? 1 : 0;
      continue;
    }
    group->second.detections.push_back(order[rank]);
    group->second.scores.push_back(detection.score);
    group->second.num_kept += kept ? 1 : 0;
  }

  std::vector<Group> out;
  for (auto& [model, group] : groups) {
    choose_targets(scene, scene.truth[group.truths[0]].model, group);
    out.push_back(std::move(group));
  }
  return out;
}

/// Fill the tables of distances. Pairs are independent.
void measure_distances(const ManifestScene& scene, const SceneResult& result, const Gauge& gauge,
                       const std::optional<MeasuredImage>& measured, Group& group) {
  group.mssd = {group.detections.size(), group.truths.size()};
  group.mspd = group.mssd;
  const PointsView vertices = gauge.mesh->vertices;
  engine::for_each_index(group.detections.size(), [&](std::size_t e) {
    const Isometry3d estimate(result.detections[group.detections[e]].T_scene_model.cast<double>());
    for (std::size_t t = 0; t < group.truths.size(); ++t) {
      const Isometry3d truth(
          in_cloud_frame(scene.truth[group.truths[t]].file_pose(), result.offset).cast<double>());
      group.mssd(e, t) = kernels::mssd(vertices, estimate, truth, gauge.symmetries);
      if (!measured) continue;
      group.mspd(e, t) =
          kImageWidth / measured->window.width *
          kernels::mspd(vertices, measured->camera, estimate, truth, gauge.symmetries);
    }
  });
}

/// Fill the table of VSD. Each pose is rendered once, and only if a truth may be visible with it.
Result<void> measure_vsd(const ManifestScene& scene, const SceneResult& result, const Gauge& gauge,
                         const MeasuredImage& measured, double delta, Group& group) {
  group.vsd = {group.detections.size(), group.truths.size()};
  const auto pose_of = [&](std::size_t e) -> const Pose& {
    return result.detections[group.detections[e]].T_scene_model;
  };
  std::vector<PixelWindow> windows(group.detections.size());
  for (std::size_t e = 0; e < windows.size(); ++e)
    windows[e] = window_of(gauge, pose_of(e), measured);

  std::vector<std::optional<Result<ObjectImage>>> truths(group.truths.size());
  engine::for_each_index(truths.size(), [&](std::size_t t) {
    const Pose& pose = scene.truth[group.truths[t]].T_scene_model;
    const PixelWindow window = window_of(gauge, pose, measured);
    const auto met = [&](const PixelWindow& other) { return other.overlaps(window); };
    if (std::ranges::any_of(windows, met)) truths[t] = render(gauge, pose, window, measured);
  });
  for (const auto& truth : truths) {
    if (truth && !*truth) return truth->error();
  }

  std::vector<std::optional<Error>> failures(windows.size());
  engine::for_each_index(windows.size(), [&](std::size_t e) {
    std::optional<ObjectImage> estimate;
    for (std::size_t t = 0; t < truths.size(); ++t) {
      group.vsd(e, t).fill(1);  // no common pixel
      if (!truths[t] || !(*truths[t])->window.overlaps(windows[e])) continue;
      if (!estimate) {
        Result<ObjectImage> rendered = render(gauge, pose_of(e), windows[e], measured);
        if (!rendered) {
          failures[e] = rendered.error();
          return;
        }
        estimate = *std::move(rendered);
      }
      kernels::vsd(measured.map(), estimate->map(), (*truths[t])->map(),
                   {delta, gauge.mesh->diameter, kBopShares}, group.vsd(e, t));
    }
  });
  for (const std::optional<Error>& failure : failures) {
    if (failure) return *failure;
  }
  return {};
}

/// Assign each estimate, in order, the free truth with the smallest error below the threshold.
/// Returns the truth assigned to each estimate, or kNone.
template <class ErrorOf>
std::vector<std::size_t> match(std::size_t num_estimates, std::vector<bool> free,
                               const ErrorOf& error, double threshold) {
  std::vector<std::size_t> matched(num_estimates, kNone);
  for (std::size_t e = 0; e < num_estimates; ++e) {
    double least = threshold;
    for (std::size_t t = 0; t < free.size(); ++t) {
      if (!free[t] || !(error(e, t) < least)) continue;
      least = error(e, t);
      matched[e] = t;
    }
    if (matched[e] != kNone) free[matched[e]] = false;
  }
  return matched;
}

/// Numbers of targets and of found targets at each threshold, summed over groups.
struct Found {
  std::size_t num_targets = 0;
  std::vector<std::size_t> num_found;

  explicit Found(std::size_t num_thresholds) : num_found(num_thresholds) {}

  template <class ErrorOf>
  void add(const Group& group, std::size_t k, const ErrorOf& error, double threshold) {
    const std::vector<std::size_t> matched =
        match(std::min(group.num_wanted, group.detections.size()), group.targets, error, threshold);
    num_found[k] += matched.size() -
                    static_cast<std::size_t>(std::count(matched.begin(), matched.end(), kNone));
  }
  void add(const Found& other) {
    num_targets += other.num_targets;
    for (std::size_t k = 0; k < num_found.size(); ++k) num_found[k] += other.num_found[k];
  }
  /// Mean recall over the thresholds; 0 without targets.
  double average_recall() const {
    double sum = 0;
    for (const std::size_t found : num_found)
      sum += num_targets == 0 ? 0 : static_cast<double>(found) / static_cast<double>(num_targets);
    return sum / static_cast<double>(num_found.size());
  }
};

/// Scores of one scene.
struct SceneScores {
  std::optional<Error> failure;
  std::size_t num_absent = 0;
  std::vector<Group> groups;  // by model; without their VSD tables
  bool any_vsd = false, any_image = false;
  Found mssd{kNumThresholds}, mspd{kNumThresholds}, vsd{kNumVsdThresholds};
};

void count_found(const Group& group, double diameter, SceneScores& scene) {
  const std::size_t num_targets = count_true(group.targets);
  scene.mssd.num_targets += num_targets;
  if (group.has_image) scene.mspd.num_targets += num_targets;
  if (group.has_vsd) scene.vsd.num_targets += num_targets;
  for (std::size_t k = 0; k < kNumThresholds; ++k) {
    const auto mssd = [&](std::size_t e, std::size_t t) { return group.mssd(e, t) / diameter; };
    scene.mssd.add(group, k, mssd, kBopShares[k]);
    if (group.has_image) scene.mspd.add(group, k, group.mspd, pixel_threshold(k));
    if (!group.has_vsd) continue;
    for (std::size_t tau = 0; tau < kNumThresholds; ++tau) {
      const auto vsd = [&](std::size_t e, std::size_t t) { return group.vsd(e, t)[tau]; };
      scene.vsd.add(group, tau * kNumThresholds + k, vsd, kBopShares[k]);
    }
  }
}

/// Write the errors of each detection relative to the nearest truth.
void write_errors(const Group& group, std::vector<std::optional<BopErrors>>& out) {
  for (std::size_t e = 0; e < group.detections.size(); ++e) {
    std::size_t nearest = 0;
    for (std::size_t t = 1; t < group.truths.size(); ++t) {
      if (group.mssd(e, t) < group.mssd(e, nearest)) nearest = t;
    }
    BopErrors errors{group.truths[nearest], group.mssd(e, nearest), {}, {}};
    if (group.has_image) errors.mspd = group.mspd(e, nearest);
    if (group.has_vsd) errors.vsd = group.vsd(e, nearest);
    out[group.detections[e]] = errors;
  }
}

/// found  absent if there is no result, and possibly no readable image
SceneScores score_scene(const ManifestScene& scene, const std::optional<SceneResult>& found,
                        const std::map<std::string, std::size_t>& models,
                        std::span<const Gauge> gauges, double delta,
                        std::vector<std::optional<BopErrors>>& errors) {
  static const SceneResult kNothing;
  const SceneResult& result = found ? *found : kNothing;
  SceneScores out;
  out.groups = make_groups(scene, result, models, out.num_absent);
  errors.resize(result.detections.size());
  if (out.groups.empty()) return out;
  Result<std::optional<MeasuredImage>> measured =
      engine::read_measured_image(scene.file, scene.camera);
  if (!measured && !found) measured = std::optional<MeasuredImage>();
  if (!measured) {
    out.failure = measured.error();
    return out;
  }
  for (Group& group : out.groups) {
    const Gauge& gauge = gauges[group.model];
    group.has_image = measured->has_value();
    group.has_vsd = group.has_image && gauge.rays;
    measure_distances(scene, result, gauge, *measured, group);
    if (group.has_vsd) {
      const Result<void> done = measure_vsd(scene, result, gauge, **measured, delta, group);
      if (!done) {
        out.failure = done.error();
        return out;
      }
    }
    out.any_image |= group.has_image;
    out.any_vsd |= group.has_vsd;
    count_found(group, gauge.mesh->diameter, out);
    write_errors(group, errors);
    group.vsd = {};  // largest table, not needed for detection
  }
  return out;
}

/// Average precisions of one model.
struct ModelPrecision {
  std::size_t num_targets = 0, num_in_images = 0;
  double mssd = 0, mspd = 0, mssd_mm = 0;
};

/// groups  groups of one model, in the order of the scenes
ModelPrecision precision_of(std::span<const Group* const> groups, double diameter,
                            double millimeters) {
  ModelPrecision out;
  for (const Group* group : groups) {
    const std::size_t visible = count_true(group->visible);
    out.num_targets += visible;
    if (group->has_image) out.num_in_images += visible;
  }

  std::vector<engine::ScoredMatch> matches;
  const auto average = [&](bool only_images, std::size_t num_targets, const auto& error_of,
                           const auto& threshold_of) {
    double sum = 0;
    for (std::size_t k = 0; k < kNumThresholds; ++k) {
      matches.clear();
      for (const Group* group : groups) {
        if (only_images && !group->has_image) continue;
        const auto error = [&](std::size_t e, std::size_t t) { return error_of(*group, e, t); };
        const std::vector<std::size_t> matched = match(
            group->num_kept, std::vector<bool>(group->truths.size(), true), error, threshold_of(k));
        for (std::size_t e = 0; e < matched.size(); ++e) {
          const bool found = matched[e] != kNone;
          if (found && !group->visible[matched[e]]) continue;  // counts neither way
          matches.push_back({group->scores[e], found});
        }
      }
      sum += engine::average_precision(matches, num_targets);
    }
    return sum / static_cast<double>(kNumThresholds);
  };
  const auto in_diameters = [&](const Group& group, std::size_t e, std::size_t t) {
    return group.mssd(e, t) / diameter;
  };
  const auto in_millimeters = [&](const Group& group, std::size_t e, std::size_t t) {
    return group.mssd(e, t) * millimeters;
  };
  const auto in_pixels = [](const Group& group, std::size_t e, std::size_t t) {
    return group.mspd(e, t);
  };
  const auto share = [](std::size_t k) { return kBopShares[k]; };
  out.mssd = average(false, out.num_targets, in_diameters, share);
  out.mssd_mm = average(false, out.num_targets, in_millimeters, mm_threshold);
  out.mspd = average(true, out.num_in_images, in_pixels, pixel_threshold);
  return out;
}

BopRecall recall_of(std::span<const SceneScores> scenes) {
  Found mssd(kNumThresholds), mspd(kNumThresholds), vsd(kNumVsdThresholds);
  bool any_image = false, any_vsd = false;
  for (const SceneScores& scene : scenes) {
    mssd.add(scene.mssd);
    mspd.add(scene.mspd);
    vsd.add(scene.vsd);
    any_image |= scene.any_image;
    any_vsd |= scene.any_vsd;
  }
  BopRecall out;
  out.num_targets = mssd.num_targets;
  out.mssd = mssd.average_recall();
  if (any_image) out.mspd = mspd.average_recall();
  if (any_vsd) out.vsd = vsd.average_recall();
  if (out.vsd && out.mspd) out.mean = (*out.vsd + out.mssd + *out.mspd) / 3;
  return out;
}

BopPrecision precision_over_models(std::span<const SceneScores> scenes,
                                   std::span<const Gauge> gauges, double millimeters) {
  std::vector<std::vector<const Group*>> groups(gauges.size());
  BopPrecision out;
  for (const SceneScores& scene : scenes) {
    out.num_absent += scene.num_absent;
    for (const Group& group : scene.groups) groups[group.model].push_back(&group);
  }
  std::vector<ModelPrecision> models(gauges.size());
  engine::for_each_index(gauges.size(), [&](std::size_t m) {
    models[m] = precision_of(groups[m], gauges[m].mesh->diameter, millimeters);
  });

  std::size_t num_models = 0, num_in_images = 0;
  double mspd = 0;
  for (const ModelPrecision& model : models) {
    if (model.num_targets == 0) continue;  // no targets
    ++num_models;
    out.num_targets += model.num_targets;
    out.mssd += model.mssd;
    out.mssd_mm += model.mssd_mm;
    if (model.num_in_images == 0) continue;
    ++num_in_images;
    mspd += model.mspd;
  }
  if (num_models == 0) return out;
  out.mssd /= static_cast<double>(num_models);
  out.mssd_mm /= static_cast<double>(num_models);
  if (num_in_images > 0) {
    out.mspd = mspd / static_cast<double>(num_in_images);
    out.mean = (out.mssd + *out.mspd) / 2;
  }
  return out;
}

/// The scored models by name, as indices of the available meshes.
Result<std::map<std::string, std::size_t>> index_models(const Manifest& manifest,
                                                        std::span<const EvaluationMesh> meshes,
                                                        std::vector<const EvaluationMesh*>& used) {
  std::map<std::string, std::size_t> models;
  for (const std::string& name : scored_models(manifest)) {
    const auto mesh = std::ranges::find(meshes, name, &EvaluationMesh::name);
    if (mesh == meshes.end()) {
      return Error{ErrorCode::bad_data,
                   fmt::format("expected a mesh to measure errors of '{}' on, found none of that "
                               "name; give the model's mesh",
                               name)};
    }
    models.emplace(name, used.size());
    used.push_back(&*mesh);
  }
  return models;
}

}  // namespace

Result<BopScores> bop_scores(const Manifest& manifest, std::span<const EvaluationMesh> meshes,
                             std::span<const std::optional<SceneResult>> results,
                             const BopOptions& options) {
  TRIVET_REQUIRE(results.size() == manifest.scenes.size(), "one result, or none, for each scene");
  TRIVET_REQUIRE(options.vsd_delta_mm > 0, "a tolerance above zero");
  std::vector<const EvaluationMesh*> used;
  TRIVET_TRY_ASSIGN(const auto models, index_models(manifest, meshes, used));
  std::vector<std::optional<Result<Gauge>>> made(used.size());
  engine::for_each_index(used.size(), [&](std::size_t m) { made[m] = make_gauge(*used[m]); });
  std::vector<Gauge> gauges;
  for (std::optional<Result<Gauge>>& gauge : made) {
    if (!*gauge) return gauge->error();
    gauges.push_back(**std::move(gauge));
  }

  const double delta = options.vsd_delta_mm * unit_scale(LengthUnit::millimeter, manifest.unit);
  BopScores out;
  out.errors.resize(results.size());
  std::vector<SceneScores> scenes(results.size());
  engine::for_each_index(results.size(), [&](std::size_t s) {
    scenes[s] = score_scene(manifest.scenes[s], results[s], models, gauges, delta, out.errors[s]);
  });
  for (const SceneScores& scene : scenes) {
    if (scene.failure) return *scene.failure;
  }
  out.localization = recall_of(scenes);
  out.detection =
      precision_over_models(scenes, gauges, unit_scale(manifest.unit, LengthUnit::millimeter));
  return out;
}

}  // namespace trivet
