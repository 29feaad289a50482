// Repeatability of descriptors on increasingly degraded scans: recall against 1-precision over the
// nearest-neighbor distance ratio, after Guo et al., IJCV 2013.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "descriptors/degrade_mesh.hpp"
#include "descriptors/descriptors.hpp"
#include "descriptors/feature_pool.hpp"
#include "engine/common/parallel.hpp"
#include "kernels/common/pca.hpp"
#include "kernels/common/projector.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/surfaces/mesh_resolution.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNumKeypoints = 1000;  // per model
constexpr int kNumThresholds = 100;          // steps of the ratio
constexpr float kReach = 0.5F;               // [support radii]; nearer matches are correct

struct StudiedModel {
  std::string name;
  Mesh mesh;
  float resolution = 0;
  KeypointSurface surface{};
};

Result<StudiedModel> read_model(const fs::path& file) {
  Result<Cloud> cloud = read_cloud(file);
  if (!cloud) return cloud.error();
  if (cloud->triangles.empty())
    return Error{ErrorCode::bad_data, fmt::format("{}: expected a mesh, found points without "
                                                  "triangles",
                                                  file.string())};
  StudiedModel model{.name = file.stem().string(),
                     .mesh = {std::move(cloud->points), std::move(cloud->triangles)}};
  model.resolution =
      static_cast<float>(kernels::mean_edge_length(model.mesh.vertices, model.mesh.triangles));
  return model;
}

/// A descriptor and its features on the models.
struct Study {
  const Descriptor* descriptor;
  std::optional<PcaBasis> basis{};
  FeaturePool pool{};

  Column<float> features(const KeypointSurface& surface) const {
    Column<float> raw = describe(*descriptor, surface);
    if (!basis) return raw;
    const std::size_t n = surface.keypoints.size();
    Column<float> projected(n * basis->size());
    const kernels::Projector projector(*basis);
    engine::for_chunks(n, 64, [&](std::size_t first, std::size_t count) {
      projector.project(std::span(raw).subspan(first * descriptor->size, count * descriptor->size),
                        std::span(projected).subspan(first * basis->size(), count * basis->size()));
    });
    return projected;
  }
};

Study study_models(const Descriptor& descriptor, const std::vector<StudiedModel>& models) {
  Study study{.descriptor = &descriptor};
  if (descriptor.num_components > 0) {
    Column<float> all;
    for (const StudiedModel& model : models) {
      const Column<float> some = describe(descriptor, model.surface);
      all.insert(all.end(), some.begin(), some.end());
    }
    study.basis = kernels::find_components(all, descriptor.size, descriptor.num_components);
  }
  study.pool.dimension = study.basis ? study.basis->size() : descriptor.size;
  for (std::uint32_t m = 0; m < models.size(); ++m) {
    const KeypointSurface& surface = models[m].surface;
    const Column<float> some = study.features(surface);
    study.pool.features.insert(study.pool.features.end(), some.begin(), some.end());
    study.pool.models.insert(study.pool.models.end(), surface.keypoints.size(), m);
    for (std::size_t k = 0; k < surface.keypoints.size(); ++k)
      study.pool.keypoints.push_back(surface.keypoints[k]);
    study.pool.reaches.push_back(kReach * surface.radius);
  }
  return study;
}

/// A scan of a model, and the position of each of its keypoints on the model.
struct Scan {
  KeypointSurface surface;
  Points true_places;
};

Scan scan_model(const StudiedModel& model, const Degradation& how, std::uint64_t seed) {
  const Pose T_scene_model = random_pose(seed, 100 * model.resolution);
  Mesh mesh = degrade_mesh(model.mesh, how, model.resolution, T_scene_model, seed);
  // The scan's keypoints are its vertices nearest to the model's keypoints.
  const kernels::VoxelHash grid(mesh.vertices, 2 * model.resolution);
  const Pose T_model_scene = T_scene_model.inverse();
  std::vector<std::uint32_t> keypoints;
  Scan scan;
  for (std::size_t k = 0; k < model.surface.keypoints.size(); ++k) {
    const auto nearest = grid.nearest(T_scene_model * model.surface.keypoints[k],
                                      std::numeric_limits<float>::infinity());
    keypoints.push_back(nearest->index);
    scan.true_places.push_back(T_model_scene * mesh.vertices[nearest->index]);
  }
  scan.surface = sample_surface(std::move(mesh), keypoints, model.resolution);
  return scan;
}

/// Best recall of any threshold with 1-precision up to this value.
double recall_at(const PrecisionRecall& curve, double one_minus_precision) {
  double recall = 0;
  for (const OperatingPoint& point : curve.points)
    if (1 - point.precision <= one_minus_precision) recall = std::max(recall, point.recall);
  return recall;
}

class Tables {
 public:
  explicit Tables(const fs::path& folder)
      : curves_(folder / "curves.csv"), summary_(folder / "summary.csv") {
    curves_ << "descriptor,degradation,threshold,recall,one_minus_precision\n";
    summary_ << "descriptor,numbers,degradation,model,keypoints,area,recall_at_0.1,nearest_right\n";
  }

  void add_summary(const Descriptor& descriptor, const Degradation& how, const std::string& model,
                   std::span<const ScoredOutcome> outcomes) {
    const PrecisionRecall curve = precision_recall(outcomes, outcomes.size());
    const auto right = std::ranges::count_if(outcomes, &ScoredOutcome::right);
    summary_ << fmt::format("\"{}\",{},\"{}\",\"{}\",{},{:.4f},{:.4f},{:.4f}\n", descriptor.name,
                            descriptor.kept_size(), how.name, model, outcomes.size(),
                            curve.average_precision, recall_at(curve, 0.1),
                            static_cast<double>(right) / static_cast<double>(outcomes.size()));
  }

  void add_curve(const Descriptor& descriptor, const Degradation& how,
                 std::span<const ScoredOutcome> outcomes) {
    for (int t = 0; t <= kNumThresholds; ++t) {
      const double threshold = static_cast<double>(t) / kNumThresholds;
      double accepted = 0, right = 0;
      for (const ScoredOutcome& match : outcomes) {
        if (1 - match.score > threshold) continue;
        ++accepted;
        right += match.right ? 1 : 0;
      }
      curves_ << fmt::format("\"{}\",\"{}\",{:.2f},{:.4f},{:.4f}\n", descriptor.name, how.name,
                             threshold, right / static_cast<double>(outcomes.size()),
                             accepted > 0 ? 1 - right / accepted : 0.0);
    }
  }

  bool close() {
    curves_.close();
    summary_.close();
    return curves_.good() && summary_.good();
  }

 private:
  std::ofstream curves_, summary_;
};

/// A folder stands for the meshes in it.
std::vector<fs::path> list_files(std::span<char* const> arguments) {
  std::vector<fs::path> files;
  for (const fs::path path : arguments) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(path))
      if (is_cloud_file(entry.path())) inside.push_back(entry.path());
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

int run(const fs::path& folder, std::span<char* const> arguments) {
  std::vector<StudiedModel> models;
  for (const fs::path& file : list_files(arguments)) {
    Result<StudiedModel> model = read_model(file);
    if (!model) {
      fmt::print(stderr, "descriptor_curves: {}\n", model.error().message);
      return 65;
    }
    models.push_back(std::move(*model));
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto keypoints = draw_vertices(models[m].mesh, kNumKeypoints, m);
    models[m].surface = sample_surface(models[m].mesh, keypoints, models[m].resolution);
  }
  fmt::print(stderr, "describing {} models\n", models.size());
  std::vector<Study> studies;
  for (const Descriptor& descriptor : descriptors())
    studies.push_back(study_models(descriptor, models));

  fs::create_directories(folder);
  Tables tables(folder);
  std::uint64_t seed = 0;
  for (const Degradation& how : degradations()) {
    fmt::print(stderr, "{}\n", how.name);
    std::vector<Scan> scans(models.size());
    const std::uint64_t first_seed = seed;
    engine::for_each_index(models.size(), [&](std::size_t m) {
      scans[m] = scan_model(models[m], how, first_seed + m);
    });
    seed += models.size();
    for (const Study& study : studies) {
      std::vector<ScoredOutcome> all;
      for (std::uint32_t m = 0; m < models.size(); ++m) {
        const auto some =
            match_with(study.pool, study.features(scans[m].surface), m, scans[m].true_places);
        tables.add_summary(*study.descriptor, how, models[m].name, some);
        all.insert(all.end(), some.begin(), some.end());
      }
      tables.add_summary(*study.descriptor, how, "all", all);
      tables.add_curve(*study.descriptor, how, all);
    }
  }
  if (tables.close()) return 0;
  fmt::print(stderr, "descriptor_curves: could not write to {}\n", folder.string());
  return 74;
}

}  // namespace
}  // namespace trivet::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: descriptor_curves OUT_DIR MESH|DIR...\n");
    return 2;
  }
  const std::span<char* const> arguments(argv, static_cast<std::size_t>(argc));
  return trivet::bench::run(arguments[1], arguments.subspan(2));
}
