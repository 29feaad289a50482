// Rendered scans compared with real ones: the sensor's effect on outlines, edges and faces of
// objects with known poses, by the same statistics for both.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/simulation/make_parts.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "engine/training/survey_model.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using kernels::RayScene;

/// A depth image and all objects known to be in it.
struct KnownScan {
  std::uint32_t width = 0, height = 0;
  Camera camera;
  std::vector<float> depth;  // [m]; 0: no measurement
  std::vector<RayScene::Instance> objects;
  std::vector<bool> counts;
};

constexpr std::array<int, 4> kLags{1, 3, 5, 8};
constexpr std::uint32_t kScenes = 26;  // rendered for each kind of sensor
constexpr int kReach = 5, kFarBegin = 8, kFarEnd = 12, kInterior = 6;

/// Sums over scans.
struct Statistics {
  // Beyond the outline: pixels with the object's depth, by side (left, right, top, bottom).
  std::array<std::array<double, kReach>, 4> carried{}, outside{};
  // Within the outline: how much farther the depth is than at the face's center [widths of a pixel
  // there].
  std::array<double, kReach> lean{}, inside{};
  // Sums over the residuals on faces after subtracting a quadratic surface.
  std::array<double, kLags.size()> products{}, pairs{};
  double squares = 0, weight = 0;
  double missing = 0, pixels = 0;

  double share(int d) const {
    double sum = 0, n = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      sum += carried[side][static_cast<std::size_t>(d)];
      n += outside[side][static_cast<std::size_t>(d)];
    }
    return sum / n;
  }
  /// Difference between the largest and smallest fraction of a side, at 2 pixels.
  double sidedness() const {
    double low = 1, high = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      if (outside[side][1] < 50) continue;
      low = std::min(low, carried[side][1] / outside[side][1]);
      high = std::max(high, carried[side][1] / outside[side][1]);
    }
    return high - low;
  }
  bool enough() const {
    double n = 0;
    for (const auto& side : outside) n += side[0];
    return n >= 80 && weight > 0;
  }
};

/// All statistics, in one row.
struct Figures {
  std::vector<std::string> names;
  std::vector<double> values;
  void add(const std::string& name, double value) {
    names.push_back(name);
    values.push_back(value);
  }
};
Figures figures_of(const Statistics& s) {
  Figures out;
  for (int d = 0; d < kReach; ++d) out.add("carried at " + std::to_string(d + 1), s.share(d));
  out.add("sidedness", s.sidedness());
  for (std::size_t k = 0; k < kLags.size(); ++k) {
    out.add("autocorrelation at " + std::to_string(kLags[k]),
            s.products[k] / s.pairs[k] / (s.squares / s.weight));
  }
  for (std::size_t d = 0; d < kReach; ++d)
    out.add("lean at " + std::to_string(d + 1), s.lean[d] / s.inside[d]);
  out.add("deviation", std::sqrt(s.squares / s.weight));
  out.add("missing", s.missing / s.pixels);
  return out;
}

/// Differences from the true surfaces, pixel by pixel.
class Comparison {
 public:
  Comparison(const KnownScan& scan, const RayScene& rays)
      : scan_(scan),
        exact_(engine::render_exactly(rays, scan.camera, scan.width, scan.height)),
        width_(static_cast<int>(scan.width)),
        height_(static_cast<int>(scan.height)) {}

  void add_to(Statistics& sum) const {
    for (std::uint32_t k = 0; k < scan_.objects.size(); ++k) {
      if (!scan_.counts[k]) continue;
      const double middle = add_face(k, sum);
      if (std::isfinite(middle)) add_outline(k, middle, sum);
    }
  }

 private:
  bool within(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }
  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v) * scan_.width + static_cast<std::size_t>(u);
  }
  bool shows(int u, int v, std::uint32_t k) const {
    return within(u, v) && exact_.depth[at(u, v)] > 0 && exact_.instance[at(u, v)] == k;
  }
  double measured(int u, int v) const { return static_cast<double>(scan_.depth[at(u, v)]); }
  double exact(int u, int v) const { return static_cast<double>(exact_.depth[at(u, v)]); }
  double scaled(double error, double z) const { return 1000 * error / (z * z); }

  /// Whether a pixel is well within the object and its surface faces the camera.
  bool interior(int u, int v, std::uint32_t k) const {
    if (!shows(u, v, k)) return false;
    for (const int d : {-kInterior, kInterior}) {
      if (!shows(u + d, v, k) || !shows(u, v + d, k)) return false;
    }
    const Eigen::Vector3d ray((u - scan_.camera.cx) / scan_.camera.fx,
                              (v - scan_.camera.cy) / scan_.camera.fy, 1);
    return -exact_.normals[at(u, v)].cast<double>().dot(ray.normalized()) > 0.5;
  }

  /// Returns the mean residual of the face [m]; NaN if too little of the face was measured.
  double add_face(std::uint32_t k, Statistics& sum) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::vector<int> us, vs;
    std::vector<double> errors;
    double all = 0, face = 0;
    for (int v = 0; v < height_; ++v) {
      for (int u = 0; u < width_; ++u) {
        if (!interior(u, v, k)) continue;
        all += 1;
        const double z = measured(u, v), error = z - exact(u, v);
        if (z == 0 || std::abs(error) > 0.025 * z) continue;
        us.push_back(u);
        vs.push_back(v);
        errors.push_back(scaled(error, z));
        face += error;
      }
    }
    const auto n = static_cast<Eigen::Index>(errors.size());
    if (n < 500 || static_cast<double>(n) < 0.5 * all) return kNone;
    sum.missing += all - static_cast<double>(n);
    sum.pixels += all;
    Eigen::MatrixXd terms(n, 6);
    Eigen::VectorXd values(n);
    const double cu = us[0], cv = vs[0];
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto j = static_cast<std::size_t>(i);
      const double x = (us[j] - cu) / 50, y = (vs[j] - cv) / 50;
      terms.row(i) << 1, x, y, x * x, x * y, y * y;
      values[i] = errors[j];
    }
    const Eigen::VectorXd fit =
        (terms.transpose() * terms).ldlt().solve(terms.transpose() * values);
    const Eigen::VectorXd rest = values - terms * fit;
    const double limit = 9 * rest.squaredNorm() / static_cast<double>(n);
    std::vector<double> image(scan_.depth.size(), kNone);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (rest[i] * rest[i] > limit) continue;
      const auto j = static_cast<std::size_t>(i);
      image[at(us[j], vs[j])] = rest[i];
      sum.squares += rest[i] * rest[i];
      sum.weight += 1;
    }
    for (std::size_t lag = 0; lag < kLags.size(); ++lag) {
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto j = static_cast<std::size_t>(i);
        const double here = image[at(us[j], vs[j])];
        for (const auto& [du, dv] : {std::pair{kLags[lag], 0}, std::pair{0, kLags[lag]}}) {
          if (!within(us[j] + du, vs[j] + dv)) continue;
          const double there = image[at(us[j] + du, vs[j] + dv)];
          if (!std::isfinite(here * there)) continue;
          sum.products[lag] += here * there;
          sum.pairs[lag] += 1;
        }
      }
    }
    return face / static_cast<double>(n);
  }

  void add_outline(std::uint32_t k, double middle, Statistics& sum) const {
    constexpr std::array<std::pair<int, int>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
    for (int v = 0; v < height_; ++v) {
      for (int u = 0; u < width_; ++u) {
        if (!shows(u, v, k)) continue;
        for (std::size_t side = 0; side < 4; ++side)
          add_edge(u, v, kSides[side].first, kSides[side].second, k, middle, side, sum);
      }
    }
  }

  void add_edge(int u, int v, int du, int dv, std::uint32_t k, double middle, std::size_t side,
                Statistics& sum) const {
    if (!within(u + kFarEnd * du, v + kFarEnd * dv)) return;
    std::vector<double> far;
    for (int d = 1; d <= kFarEnd; ++d) {
      if (exact_.depth[at(u + d * du, v + d * dv)] > 0) return;  // a known object
      const double z = measured(u + d * du, v + d * dv);
      if (d >= kFarBegin && z > 0) far.push_back(z);
    }
    if (far.size() < 3) return;
    std::nth_element(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(far.size() / 2),
                     far.end());
    const double z = exact(u, v), jump = far[far.size() / 2] - z;
    if (jump < std::max(0.04, 0.05 * z)) return;
    // Only where the measured object agrees with its known pose.
    if (!shows(u - kReach * du, v - kReach * dv, k)) return;
    const double deep = measured(u - kReach * du, v - kReach * dv);
    if (std::abs(deep - exact(u - kReach * du, v - kReach * dv)) > 0.02 * z) return;
    for (int d = 1; d <= kReach; ++d) {
      const auto place = static_cast<std::size_t>(d - 1);
      const double beyond = measured(u + d * du, v + d * dv);
      sum.outside[side][place] += 1;
      sum.carried[side][place] += beyond > 0 && beyond < z + jump / 2 ? 1 : 0;
      const int x = u - (d - 1) * du, y = v - (d - 1) * dv;
      if (!shows(x, y, k) || measured(x, y) == 0) continue;
      const double error = measured(x, y) - exact(x, y);
      if (std::abs(error) > jump / 2) continue;
      sum.lean[place] += (error - middle) * scan_.camera.fx / z;
      sum.inside[place] += 1;
    }
  }

  const KnownScan& scan_;
  engine::ExactImage exact_;
  int width_, height_;
};

void add_scan(const KnownScan& scan, Statistics& sum) {
  const auto rays = RayScene::from_instances(scan.objects);
  ASSERT_TRUE(rays);
  Comparison(scan, *rays).add_to(sum);
}

Statistics measure_real(const std::filesystem::path& file) {
  Statistics sum;
  const Result<Manifest> manifest = read_manifest(file);
  EXPECT_TRUE(manifest) << manifest.error().message;
  const double meters = unit_scale(manifest->unit, LengthUnit::meter);
  std::vector<std::optional<RayScene>> meshes(manifest->models.size());
  const auto mesh_of = [&](const std::string& name) -> const RayScene* {
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const ManifestModel& model = manifest->models[m];
      if (model.name != name) continue;
      if (!meshes[m]) {
        Result<Cloud> cloud = read_cloud(model.file);
        EXPECT_TRUE(cloud) << cloud.error().message;
        const auto scale = static_cast<float>(model.scale * meters);
        for (std::size_t i = 0; i < cloud->points.size(); ++i)
          cloud->points.set(i, scale * cloud->points[i]);
        StageTimes times;
        auto surface = engine::survey_model(*cloud, {name, model.file, 1, {}},
                                            TrainOptions{}.num_samples, times);
        EXPECT_TRUE(surface) << surface.error().message;
        meshes[m].emplace(std::move(surface->rays));
      }
      return &*meshes[m];
    }
    return nullptr;
  };
  for (const ManifestScene& scene : manifest->scenes) {
    const Result<Cloud> image = read_cloud(scene.file, {.camera = scene.camera});
    EXPECT_TRUE(image) << image.error().message;
    KnownScan scan;
    scan.camera = *scene.camera;
    scan.width = image->grid->width;
    scan.height = image->grid->height;
    scan.depth.assign(image->grid->point_index.size(), 0);
    for (std::size_t i = 0; i < scan.depth.size(); ++i) {
      const std::int32_t point = image->grid->point_index[i];
      if (point >= 0)
        scan.depth[i] =
            static_cast<float>(meters) * image->points[static_cast<std::size_t>(point)].z();
    }
    for (const TruthInstance& truth : scene.truth) {
      Pose pose = truth.T_scene_model;
      pose.translation() *= static_cast<float>(meters);
      scan.objects.push_back({mesh_of(truth.model), pose});
      scan.counts.push_back(!truth.ignore);
    }
    add_scan(scan, sum);
  }
  return sum;
}

/// Statistics of each randomized scene separately.
std::vector<Statistics> measure_rendered(Sensor sensor, std::uint32_t num_scenes) {
  const std::vector<ScanModel> models =
      make_scan_models(4, 3, std::vector<std::string>{"carton", "elbow", "can", "cup"});
  ScanOptions options;
  options.num_instances = options.of_a_kind = 2;
  options.seed = 21;
  options.sensor.sensor = sensor;
  options.randomize = true;
  const Result<VirtualScanner> scanner = VirtualScanner::create(models, LengthUnit::meter, options);
  EXPECT_TRUE(scanner) << scanner.error().message;
  std::vector<RayScene> meshes;
  for (const ScanModel& model : models)
    meshes.push_back(std::move(*RayScene::from_mesh(model.vertices, model.triangles)));
  std::vector<Statistics> all;
  for (std::uint32_t i = 0; i < num_scenes; ++i) {
    const Result<RenderedScene> scene = scanner->scan(i);
    EXPECT_TRUE(scene) << scene.error().message;
    KnownScan scan;
    scan.camera = scene->camera;
    scan.width = scene->width;
    scan.height = scene->height;
    for (const std::uint16_t raw : scene->depths)
      scan.depth.push_back(static_cast<float>(raw * scene->camera.depth_scale));
    for (const TruthInstance& truth : scene->truth) {
      for (std::size_t m = 0; m < models.size(); ++m) {
        if (models[m].name == truth.model)
          scan.objects.push_back({&meshes[m], truth.T_scene_model});
      }
      scan.counts.push_back(!truth.ignore);
    }
    Statistics sum;
    add_scan(scan, sum);
    if (sum.enough()) all.push_back(sum);
  }
  return all;
}

struct RealSets {
  const char* name;
  Sensor sensor;  // the kind of sensor of the real scans
  std::array<const char*, 2> folders;
};
std::ostream& operator<<(std::ostream& out, const RealSets& sets) { return out << sets.name; }

class ScanStatistics : public testing::TestWithParam<RealSets> {};

// docs/verification.md lists the statistics, which this test writes as properties to its XML
// output.
TEST_P(ScanStatistics, OfRealScansLieWithinThoseOfRandomizedOnes) {
  const RealSets sets = GetParam();
  const std::filesystem::path data = TRIVET_DATA;
  for (const char* folder : sets.folders) {
    if (!std::filesystem::exists(data / folder))
      GTEST_SKIP() << data / folder << " is absent: set TRIVET_DATA";
  }
  std::vector<Figures> rendered;
  for (const Statistics& sum : measure_rendered(sets.sensor, kScenes))
    rendered.push_back(figures_of(sum));
  ASSERT_GE(rendered.size(), kScenes / 2);
  for (const std::string folder : sets.folders) {
    const Statistics sum = measure_real(data / folder / "manifest.json");
    ASSERT_TRUE(sum.enough());
    const Figures real = figures_of(sum);
    for (std::size_t k = 0; k < real.values.size(); ++k) {
      std::vector<double> values;
      for (const Figures& figures : rendered) values.push_back(figures.values[k]);
      std::sort(values.begin(), values.end());
      const double low = values.front(), middle = values[values.size() / 2], high = values.back();
      const std::string row = fmt::format("{:.3f}, rendered {:.3f} to {:.3f} to {:.3f}",
                                          real.values[k], low, middle, high);
      RecordProperty(folder + ": " + real.names[k], row);
      EXPECT_TRUE(real.values[k] >= low && real.values[k] <= high)
          << folder << ": " << real.names[k] << " " << row;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, ScanStatistics,
    testing::Values(
        RealSets{"structured_light", Sensor::structured_light, {"icbin_cups", "ycbv_demo_xtion"}},
        RealSets{"stereo", Sensor::stereo, {"ycb_realsense", "pipe_elbows"}}),
    [](const testing::TestParamInfo<RealSets>& sets) { return sets.param.name; });

}  // namespace
}  // namespace trivet
