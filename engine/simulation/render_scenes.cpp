#include "engine/simulation/render_scenes.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>

#include "engine/common/bop_models.hpp"
#include "engine/common/check_range.hpp"
#include "engine/common/parallel.hpp"
#include "engine/common/scaled.hpp"
#include "engine/simulation/bop_truth.hpp"
#include "engine/simulation/make_parts.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/simulation/deform_surface.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/datasets/write_bop.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"
#include "storage/formats/write_png.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

constexpr int kSceneId = 1;  // BOP scene of every image

constexpr std::uint64_t kDeviationStream = 0xDE7, kObjectStream = 0x0B1;

/// Coarse, since only the symmetries of the trained models are used here.
constexpr TrainOptions kSymmetryOnly{.relative_step = 0.1F};

/// Keep the vertices of triangles, in their order, scaled by `factor`.
void keep_used(const Cloud& surface, double factor, ScanModel& model) {
  constexpr std::uint32_t kUnused = 0xFFFF'FFFFU;
  std::vector<std::uint32_t> place(surface.points.size(), kUnused);
  const auto use = [&](std::uint32_t vertex) {
    if (place[vertex] == kUnused) {
      place[vertex] = static_cast<std::uint32_t>(model.vertices.size());
      model.vertices.push_back((factor * surface.points[vertex].cast<double>()).cast<float>());
    }
    return place[vertex];
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::uint32_t a = use(surface.triangles.a[t]), b = use(surface.triangles.b[t]),
                        c = use(surface.triangles.c[t]);
    model.triangles.push_back(a, b, c);
  }
}

Result<ScanModel> read_model(const ModelSource& source, LengthUnit unit,
                             const ScanModelOptions& options) {
  TRIVET_TRY_ASSIGN(const Cloud surface,
                    read_cloud(source.file, {.unit = unit, .keep_origin = true}));
  if (surface.triangles.empty()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a mesh, found points without faces, which a sensor "
                             "sees through",
                             source.file.string())};
  }
  double scale = source.scale;  // factor to the library's unit
  if (options.diameter > 0) {
    const float diameter = kernels::find_diameter(surface.points);
    if (diameter > 0) scale = static_cast<double>(options.diameter) / static_cast<double>(diameter);
  }
  const double meters = unit_scale(unit, LengthUnit::meter);
  ScanModel model;
  model.name = source.name;
  model.metal = options.metal;
  keep_used(surface, scale * meters, model);
  if (source.symmetry) {
    model.symmetry = engine::scaled(*source.symmetry, scale / source.scale * meters);
    return model;
  }
  Cloud own;
  own.points = model.vertices;
  own.triangles = model.triangles;
  TRIVET_TRY_ASSIGN(TrainedModel trained,
                    train_model(own, {source.name, source.file, 1, {}}, kSymmetryOnly));
  model.symmetry = std::move(trained.model.symmetry);
  return model;
}

/// Run `make(i)`, which returns the item's name, for each i in parallel, until one fails or the run
/// is asked to stop. Errors: that of the lowest index; resumable when stopped.
template <class Make>
Result<void> make_all(std::size_t n, const Progress& progress, Make&& make) {
  std::vector<std::optional<Error>> errors(n);
  std::mutex mutex;
  std::size_t done = 0;
  engine::for_each_index(n, [&](std::size_t i) {
    if (progress.stop.stop_requested()) return;
    const Result<std::string> made = make(i);
    const std::lock_guard lock(mutex);
    if (!made) {
      errors[i] = made.error();
    } else {
      progress(++done, n, *made);
    }
  });
  for (const std::optional<Error>& error : errors) {
    if (error) return *error;
  }
  if (done < n)
    return Error{ErrorCode::resumable, fmt::format("stopped after {} of {} scenes", done, n)};
  return {};
}

/// The models are written twice, since errors are measured on the same meshes.
Result<std::vector<ManifestModel>> write_models(std::span<const ScanModel> models, LengthUnit unit,
                                                const fs::path& folder) {
  std::vector<engine::BopModel> of_bop;
  for (const ScanModel& model : models)
    of_bop.push_back({model.name, model.vertices, model.triangles, model.symmetry});
  return engine::write_bop_models(of_bop, LengthUnit::meter, unit, folder, {"models_eval"});
}

Result<void> write_masks(const fs::path& scene_folder, int image_id,
                         std::span<const engine::ObjectView> views, std::uint32_t width) {
  for (std::size_t k = 0; k < views.size(); ++k) {
    Result<void> written =
        write_gray_png(bop_mask_file(scene_folder, image_id, k), views[k].mask, width);
    if (!written) return written;
    written = write_gray_png(bop_visible_mask_file(scene_folder, image_id, k),
                             views[k].mask_visible, width);
    if (!written) return written;
  }
  return {};
}

std::vector<int> object_ids_of(const Manifest& manifest) {
  std::vector<int> ids;
  for (const ManifestModel& model : manifest.models) ids.push_back(model.object_id);
  return ids;
}

/// Scale along each axis, about the center of the bounding box.
void stretch(const Eigen::Vector3d& factors, Points& points) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < points.size(); ++i) box.extend(points[i]);
  const Eigen::Vector3d middle = box.center().cast<double>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    points.set(i, (middle + factors.cwiseProduct(p - middle)).cast<float>());
  }
}

/// Let an object deviate from its model as real ones do. It may be open although the model is
/// closed, differ in size by up to 1 %, along each axis independently by up to .5 % more, and be
/// bent by up to 1 % of the diameter. Each deviation may also be absent.
///
/// Returns the bend [diameters].
double randomize_object(ScanModel& object, kernels::CounterRandom& random) {
  const double open = random.uniform(), sized = random.uniform(),
               size = random.uniform(-0.01, 0.01), uneven = random.uniform(),
               bent = random.uniform(), bend = random.uniform(0, 0.01);
  if (!object.hollow.triangles.empty() && open < 0.5) {
    object.vertices = object.hollow.vertices;
    object.triangles = object.hollow.triangles;
  }
  Eigen::Vector3d factors = Eigen::Vector3d::Constant(sized < 0.3 ? 1 : 1 + size);
  for (double& factor : factors) {
    const double own = random.uniform(-0.005, 0.005);
    if (uneven < 0.5) factor += own;
  }
  stretch(factors, object.vertices);
  return bent < 0.3 ? 0 : bend;
}

}  // namespace

Result<std::vector<ScanModel>> read_scan_models(std::span<const ModelSource> sources,
                                                LengthUnit unit, const ScanModelOptions& options) {
  TRIVET_TRY(engine::check_ranges({{options.diameter >= 0 && options.diameter < 1e6F, "diameter",
                                    "0 to a million", static_cast<double>(options.diameter)}}));
  std::vector<ScanModel> models;
  for (const ModelSource& source : sources) {
    TRIVET_TRY_ASSIGN(ScanModel model, read_model(source, unit, options));
    models.push_back(std::move(model));
  }
  return models;
}

std::vector<ScanModel> make_scan_models(std::size_t n, std::uint64_t seed,
                                        std::span<const std::string> families) {
  std::vector<ScanModel> models;
  for (Part& part : make_parts(n, seed, families)) {
    models.push_back({std::move(part.name), std::move(part.vertices), std::move(part.triangles),
                      std::move(part.symmetry), part.metal, std::move(part.hollow)});
  }
  return models;
}

std::vector<ScanModel> scanned_objects(std::span<const ScanModel> models,
                                       const ScanOptions& options) {
  std::vector<ScanModel> objects(models.begin(), models.end());
  for (std::size_t m = 0; m < objects.size(); ++m) {
    double deviation = options.deviation;
    if (options.randomize) {
      kernels::CounterRandom random(options.seed, kObjectStream, m);
      deviation = std::max(deviation, randomize_object(objects[m], random));
    }
    if (!(deviation > 0)) continue;
    const auto diameter = static_cast<double>(kernels::find_diameter(objects[m].vertices));
    kernels::CounterRandom seeds(options.seed, kDeviationStream, m);
    kernels::deform_surface(objects[m].vertices, diameter, deviation * diameter, seeds.next());
  }
  return objects;
}

Result<Manifest> render_scenes(std::span<const ScanModel> models, LengthUnit unit,
                               const ScanOptions& options, const fs::path& folder,
                               const Progress& progress) {
  const std::vector<ScanModel> objects = scanned_objects(models, options);
  TRIVET_TRY_ASSIGN(const VirtualScanner scanner, VirtualScanner::create(objects, unit, options));
  TRIVET_TRY_ASSIGN(const engine::BopTruth bop_truth, engine::BopTruth::create(models));
  const fs::path scene_folder = bop_scene_folder(folder / "test", kSceneId);
  for (const fs::path& made_folder : {bop_depth_file(scene_folder, 0).parent_path(),
                                      bop_mask_file(scene_folder, 0, 0).parent_path(),
                                      bop_visible_mask_file(scene_folder, 0, 0).parent_path()}) {
    TRIVET_TRY(make_folder(made_folder));
  }
  Manifest manifest;
  manifest.unit = unit;
  TRIVET_TRY_ASSIGN(std::vector<ManifestModel> entries, write_models(models, unit, folder));
  manifest.models = std::move(entries);

  manifest.scenes.resize(options.num_scenes);
  std::vector<BopScene> bop{{kSceneId, std::vector<BopImage>(options.num_scenes)}};
  std::vector<CocoImage> coco(options.num_scenes);
  std::uint32_t width = kScanWidth, height = kScanHeight;  // size of every scene's image
  const Result<void> rendered =
      make_all(options.num_scenes, progress, [&](std::size_t i) -> Result<std::string> {
        TRIVET_TRY_ASSIGN(RenderedScene scene, scanner.scan(static_cast<std::uint32_t>(i)));
        ManifestScene& entry = manifest.scenes[i];
        entry.file = bop_depth_file(scene_folder, static_cast<int>(i));
        entry.name = entry.file.lexically_relative(folder).generic_string();
        entry.camera = scene.camera;
        entry.truth = std::move(scene.truth);
        entry.scene_id = kSceneId;
        entry.image_id = static_cast<int>(i);
        TRIVET_TRY_ASSIGN(const std::vector<engine::ObjectView> views,
                          bop_truth.describe(scene.depths, scene.width, scene.bop));
        TRIVET_TRY(write_masks(scene_folder, scene.bop.id, views, scene.width));
        coco[i] = engine::coco_image(scene.bop, views, scene.width, scene.height);
        bop[0].images[i] = std::move(scene.bop);
        if (i == 0) {
          width = scene.width;
          height = scene.height;
        }
        TRIVET_TRY(write_depth_png(entry.file, scene.depths, scene.width));
        return entry.name;
      });
  if (!rendered) return rendered.error();
  const Camera& camera = bop[0].images[0].camera;
  for (const Result<void>& written :
       {write_bop_camera(folder / "camera.json", camera, width, height),
        write_bop_scene(scene_folder, bop[0].images),
        write_coco_truth(scene_folder / "scene_gt_coco.json", object_ids_of(manifest), coco),
        write_bop_targets(folder, bop), write_manifest(folder / "manifest.json", manifest)}) {
    if (!written) return written.error();
  }
  return manifest;
}

}  // namespace trivet
