#include "kernels/verify_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/visibility.hpp"

namespace trivet::kernels {

float Evidence::support() const noexcept {
  const auto seen = static_cast<float>(consistent + oblique + violation + background);
  return seen > 0 ? weight / seen : 0;
}

float Evidence::visible_fraction() const noexcept {
  return visible > 0 ? static_cast<float>(consistent) / static_cast<float>(visible) : 0;
}

float Evidence::violation_fraction() const noexcept {
  const auto judged = static_cast<float>(consistent + oblique + violation + occluded + background);
  return judged > 0 ? static_cast<float>(violation) / judged : 0;
}

float Evidence::contour() const noexcept {
  const std::uint32_t judged = contour_free + contour_crossed;
  constexpr std::uint32_t kFewest = 8;
  return judged >= kFewest ? static_cast<float>(contour_free) / static_cast<float>(judged) : 1;
}

float Evidence::rmse() const noexcept {
  return consistent > 0 ? std::sqrt(squared_residuals / static_cast<float>(consistent)) : 0;
}

float Evidence::score() const noexcept {
  const float agreement = support() * (1 - violation_fraction()) * contour();
  return agreement * std::sqrt(agreement) * std::pow(visible_fraction(), 0.2F);
}

namespace {

/// The model as one image's camera sees it.
struct Posed {
  Pose T_camera_model;
  std::size_t view_word;
  std::uint64_t view_bit;

  Posed(const RangeImage& image, const ModelSamples& samples, const Pose& T_scene_model)
      : T_camera_model(image.geometry.T_camera_scene * T_scene_model) {
    const Eigen::Vector3f camera_in_model = T_camera_model.inverse().translation();
    const std::size_t view = nearest_view((camera_in_model - samples.centre).normalized());
    view_word = view / 64;
    view_bit = std::uint64_t{1} << (view % 64);
  }
  bool sees(const ViewMask& mask) const noexcept { return (mask[view_word] & view_bit) != 0; }
};

constexpr float kGrazing = 0.15F;  // cosine below which a surface is too oblique to be measured
constexpr float kUnknownNormal =
    0.8F;  // cosine taken where the scene has no normal: below that of a good fit
constexpr int kOutlineSide = 96;  // cells; a diameter is some 50
constexpr std::array<std::array<int, 2>, 5> kCross{
    {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}};  // a pixel, neighbours

}  // namespace

Evidence verify_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                     std::size_t num_samples, const Pose& T_scene_model,
                     const VerifyOptions& options, std::vector<std::uint32_t>* explained) {
  Evidence evidence;
  const float min_normal_cosine = std::cos(options.max_normal_angle_rad);
  std::uint32_t first_pixel = 0;
  for (const RangeImage& image : images) {
    const ImageGeometry& geometry = image.geometry;
    const Posed posed(image, samples, T_scene_model);
    const Eigen::Matrix3f R = posed.T_camera_model.linear();
    const auto width = static_cast<std::int64_t>(geometry.width),
               height = static_cast<std::int64_t>(geometry.height);
    const std::size_t n = std::min(num_samples, samples.points.size());
    for (std::size_t i = 0; i < n; ++i) {
      if (!posed.sees(samples.views[i])) continue;
      const Eigen::Vector3f p = posed.T_camera_model * samples.points[i];
      const Eigen::Vector3f normal = R * samples.normals[i];
      const float facing = -normal.dot(p) / p.norm();
      if (!(facing > kGrazing)) continue;
      const std::int64_t pixel = geometry.pixel_of(p);
      if (pixel < 0) {
        ++evidence.outside;
        continue;
      }
      ++evidence.visible;

      // The pixel or a neighbour, whichever fits best: half a pixel of error must not look like a
      // hole.
      float best = std::numeric_limits<float>::infinity();
      std::int64_t best_pixel = -1;
      const std::int64_t u = pixel % width, v = pixel / width;
      for (const auto& [du, dv] : kCross) {
        if (u + du < 0 || u + du >= width || v + dv < 0 || v + dv >= height) continue;
        const std::int64_t at = pixel + dv * width + du;
        const float d = image.depth[static_cast<std::size_t>(at)];
        if (!(d > 0)) continue;
        const float r = (d - p.z()) * facing;
        if (std::abs(r) < std::abs(best)) {
          best = r;
          best_pixel = at;
        }
        if (at == pixel && std::abs(r) <= options.tolerance) break;
      }
      if (best_pixel < 0) {
        ++evidence.unknown;
        continue;
      }
      const auto at = static_cast<std::size_t>(best_pixel);
      const bool background = options.is_background(image.plane[at]);
      if (best > options.tolerance) {
        ++evidence.violation;
      } else if (best < -options.tolerance) {
        ++(background ? evidence.violation : evidence.occluded);  // nothing reaches through a table
      } else if (background) {
        ++evidence.background;
      } else {
        const Eigen::Vector3f scene_normal = image.normals[at];
        const float cosine = normal.dot(scene_normal);
        if (cosine < min_normal_cosine) {  // also false without a scene normal
          ++evidence.oblique;
        } else {
          ++evidence.consistent;
          const float share = best / options.tolerance;
          const float agreement = std::isfinite(cosine) ? cosine : kUnknownNormal;
          evidence.weight += (1 - share * share) * agreement;
          evidence.squared_residuals += best * best;
          if (explained) explained->push_back(first_pixel + static_cast<std::uint32_t>(pixel));
        }
      }
    }
    first_pixel += static_cast<std::uint32_t>(image.depth.size());
  }
  return evidence;
}

void judge_contour(std::span<const RangeImage> images, const ModelSamples& samples,
                   std::size_t num_samples, const Pose& T_scene_model, const VerifyOptions& options,
                   ContourScratch& scratch, Evidence& evidence) {
  const std::size_t n = std::min(num_samples, samples.points.size());
  if (n == 0) return;
  const float spacing = samples.spacing * std::sqrt(static_cast<float>(samples.points.size()) /
                                                    static_cast<float>(n));
  for (const RangeImage& image : images) {
    const ImageGeometry& geometry = image.geometry;
    const Posed posed(image, samples, T_scene_model);
    const Eigen::Vector3f centre = posed.T_camera_model * samples.centre;
    if (!(centre.z() > samples.diameter * 0.1F)) continue;

    // A coarse image of the model alone, around its centre. Each sample covers 3 x 3 cells of 0.8
    // spacings, which leaves no holes inside the outline and widens it by about one cell.
    const float cell = std::max(1.0F, 0.8F * spacing * geometry.fx / centre.z());
    const int side = std::min(
        kOutlineSide,
        static_cast<int>(std::ceil(2 * samples.diameter * geometry.fx / (centre.z() * cell))) + 8);
    const float u0 =
        geometry.fx * centre.x() / centre.z() + geometry.cx - cell * static_cast<float>(side) / 2;
    const float v0 =
        geometry.fy * centre.y() / centre.z() + geometry.cy - cell * static_cast<float>(side) / 2;
    const auto row_length = static_cast<std::size_t>(side);
    scratch.depth.assign(row_length * row_length, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (!posed.sees(samples.views[i])) continue;
      const Eigen::Vector3f p = posed.T_camera_model * samples.points[i];
      if (!(p.z() > 0)) continue;
      const float u = (geometry.fx * p.x() / p.z() + geometry.cx - u0) / cell;
      const float v = (geometry.fy * p.y() / p.z() + geometry.cy - v0) / cell;
      if (!(u >= 3 && v >= 3 && u < static_cast<float>(side - 3) &&
            v < static_cast<float>(side - 3)))
        continue;
      const std::size_t at = static_cast<std::size_t>(v) * row_length + static_cast<std::size_t>(u);
      for (const std::size_t row : {at - row_length, at, at + row_length}) {
        for (const std::size_t k : {row - 1, row, row + 1}) {
          float& depth = scratch.depth[k];
          if (depth == 0 || p.z() < depth) depth = p.z();
        }
      }
    }

    // Beyond each border cell of the outline, one cell out, look at the scene.
    const float jump = std::max(2 * options.tolerance, 0.03F * samples.diameter);
    constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (int v = 2; v < side - 2; ++v) {
      for (int u = 2; u < side - 2; ++u) {
        const float z = scratch.depth[static_cast<std::size_t>(v * side + u)];
        if (z == 0) continue;
        for (const auto& [du, dv] : kSteps) {
          const auto filled = [&](int k) {
            return scratch.depth[static_cast<std::size_t>((v + k * dv) * side + u + k * du)] != 0;
          };
          if (filled(1) || filled(2)) continue;
          const float pu = u0 + (static_cast<float>(u + du) + 0.5F) * cell;
          const float pv = v0 + (static_cast<float>(v + dv) + 0.5F) * cell;
          if (!(pu >= 0 && pv >= 0 && pu + 0.5F < static_cast<float>(geometry.width) &&
                pv + 0.5F < static_cast<float>(geometry.height))) {
            continue;
          }
          const std::size_t pixel = static_cast<std::size_t>(pv + 0.5F) * geometry.width +
                                    static_cast<std::size_t>(pu + 0.5F);
          const float d = image.depth[pixel];
          if (d > 0 && d < z - jump) continue;  // hidden by something nearer
          if (!(d > 0) || d > z + jump) {
            ++evidence.contour_free;
          } else if (!options.is_background(image.near_plane[pixel])) {
            ++evidence.contour_crossed;
          }
        }
      }
    }
  }
}

}  // namespace trivet::kernels
