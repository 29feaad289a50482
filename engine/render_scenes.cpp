#include "engine/render_scenes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <mutex>
#include <optional>

#include "engine/check_range.hpp"
#include "engine/parallel.hpp"
#include "kernels/diameter.hpp"
#include "storage/file.hpp"
#include "storage/read_cloud.hpp"
#include "storage/write_png.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// Coarse: of a trained model only its size, surface and symmetries are used here.
constexpr TrainOptions kSurfaceOnly{.relative_step = 0.1F};

Result<Model> read_model(ModelSource source, const ScanOptions& options) {
  const Result<Cloud> surface = read_cloud(source.file);
  if (!surface) return surface.error();
  if (surface->triangles.empty()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a mesh, found points without faces, which a sensor "
                             "sees through",
                             source.file.string())};
  }
  if (options.diameter > 0) {
    const float diameter = kernels::find_diameter(surface->points);
    if (diameter > 0)
      source.scale = static_cast<double>(options.diameter) / static_cast<double>(diameter);
  }
  Result<TrainedModel> trained = train_model(*surface, source, kSurfaceOnly);
  if (!trained) return trained.error();
  return std::move(trained->model);
}

/// Run `make(i)`, which gives the item's name, for each i side by side, until one fails or a stop
/// is asked for. Errors: that of the lowest index; resumable when stopped.
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

}  // namespace

Result<void> validate(const ScanOptions& options) {
  return engine::check_ranges({
      {options.num_scenes >= 1 && options.num_scenes <= 10000, "scenes", "1 to 10000",
       static_cast<double>(options.num_scenes)},
      {options.num_instances >= 1 && options.num_instances <= 200, "instances", "1 to 200",
       static_cast<double>(options.num_instances)},
      {options.noise >= 0 && options.noise <= 10, "noise", "0 to 10",
       static_cast<double>(options.noise)},
      {options.diameter >= 0 && options.diameter < 1e6F, "diameter", "0 to a million",
       static_cast<double>(options.diameter)},
  });
}

Result<Manifest> render_scenes(std::span<const ModelSource> sources, LengthUnit unit,
                               const ScanOptions& options, const fs::path& folder,
                               const Progress& progress) {
  if (const Result<void> valid = validate(options); !valid) return valid.error();
  if (const Result<void> made = make_folder(folder / "models"); !made) return made.error();

  Manifest manifest;
  manifest.unit = unit;
  std::vector<Model> models;
  for (const ModelSource& source : sources) {
    Result<Model> model = read_model(source, options);
    if (!model) return model.error();
    const fs::path file = folder / "models" / (source.name + ".ply");
    Cloud surface;
    surface.points = model->vertices;
    surface.triangles = model->triangles;
    if (const Result<void> written = write_ply(file, surface); !written) return written.error();
    const std::optional<Symmetry> symmetry =
        model->symmetry.trivial() ? std::nullopt : std::optional(model->symmetry);
    manifest.models.push_back({source.name, file, 1, symmetry});
    models.push_back(std::move(*model));
  }

  manifest.scenes.resize(options.num_scenes);
  const Result<void> rendered =
      make_all(options.num_scenes, progress, [&](std::size_t i) -> Result<std::string> {
        Result<RenderedScene> scene =
            render_scene(models, unit, options, static_cast<std::uint32_t>(i));
        if (!scene) return scene.error();
        ManifestScene& entry = manifest.scenes[i];
        entry.name = fmt::format("scene_{:04}.png", i);
        entry.file = folder / entry.name;
        entry.camera = scene->camera;
        entry.truth = std::move(scene->truth);
        if (const Result<void> written = write_depth_png(entry.file, scene->depths, kScanWidth);
            !written) {
          return written.error();
        }
        return entry.name;
      });
  if (!rendered) return rendered.error();
  if (const Result<void> written = write_manifest(folder / "manifest.json", manifest); !written)
    return written.error();
  return manifest;
}

}  // namespace trivet
