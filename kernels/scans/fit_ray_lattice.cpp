#include "kernels/scans/fit_ray_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/common/counter_random.hpp"
#include "kernels/common/median.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kFewestPoints = 100;
constexpr std::size_t kSampled = 8000;
constexpr float kLargestTangent = 4;  // 76 degrees off the axis
constexpr std::size_t kFewestLines = 8, kMostLines = 1 << 14;
// Of the extent of the lines: gaps that are tried between them.
constexpr int kFewestHalvings = 4, kMostHalvings = 18;
constexpr double kMostPixels = 16;  // per point
// RMS distance from the rays [pixel]. Points that know nothing of a lattice have 0.29, and those of
// a camera, rounded to a tenth of a millimeter at a pitch of one, 0.03.
constexpr double kResidual = 0.08;
// Share of the pixels to the right of and below a measured one that are measured too. Surfaces end
// somewhere, but of points that were thinned at random the share is that of the points kept.
constexpr double kNeighbors = 0.6;

/// Tangents of a ray to the right and down.
using Tangents = std::array<double, 2>;

/// Equidistant lines: first + pitch * k.
struct Lines {
  double first = 0, pitch = 0;
  std::size_t count = 0;  ///< set once all points are known

  double position_of(double value) const noexcept { return (value - first) / pitch; }
};

/// Fit lines to values that lie on them. `gap` separates the values of neighboring lines.
std::optional<Lines> fit_lines(std::span<const double> sorted, double gap) {
  struct Line {
    double mean = 0, count = 0;
  };
  std::vector<Line> lines;
  lines.reserve(sorted.size() / 2 + 1);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted[i] - sorted[i - 1] > gap) {
      // A line has several values, unless the gap is smaller than their errors.
      if (2 * lines.size() >= sorted.size()) return std::nullopt;
      lines.emplace_back();
    }
    Line& line = lines.back();
    line.count += 1;
    line.mean += (sorted[i] - line.mean) / line.count;
  }
  if (lines.size() < kFewestLines) return std::nullopt;
  std::vector<double> steps;
  for (std::size_t i = 1; i < lines.size(); ++i) steps.push_back(lines[i].mean - lines[i - 1].mean);
  const double step = median(std::span(steps));

  // The number of each line comes from its neighbor's, so that an error of the pitch does not add up.
  double n = 0, sk = 0, skk = 0, sv = 0, skv = 0, k = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i > 0) k += std::round((lines[i].mean - lines[i - 1].mean) / step);
    const double w = lines[i].count, v = lines[i].mean - lines[0].mean;
    n += w, sk += w * k, skk += w * k * k, sv += w * v, skv += w * k * v;
  }
  const double det = n * skk - sk * sk;
  if (!(det > 0) || k >= static_cast<double>(kMostLines)) return std::nullopt;
  Lines fitted;
  fitted.pitch = (n * skv - sk * sv) / det;
  fitted.first = lines[0].mean + (sv - fitted.pitch * sk) / n;
  return fitted;
}

/// Squared distance of a value from the nearest line [pitch^2].
double distance2(const Lines& lines, double value) noexcept {
  const double at = lines.position_of(value);
  const double apart = at - std::round(at);
  return apart * apart;
}

/// The lines of values, whatever their errors: gaps between lines are tried from tiny ones on.
std::optional<Lines> find_lines(std::vector<double> values) {
  std::ranges::sort(values);
  const double extent = values.back() - values.front();
  if (!(extent > 0)) return std::nullopt;
  for (int halvings = kMostHalvings; halvings >= kFewestHalvings; --halvings) {
    const std::optional<Lines> lines = fit_lines(values, std::ldexp(extent, -halvings));
    if (!lines || !(lines->pitch > 0)) continue;
    double sum = 0;
    for (const double value : values) sum += distance2(*lines, value);
    if (sum <= kResidual * kResidual * static_cast<double>(values.size())) return lines;
  }
  return std::nullopt;
}

/// Axes of a camera at the viewpoint that looks along an axis of the frame.
Pose pose_of_axis(Eigen::Index axis, float sign, const Eigen::Vector3f& viewpoint) {
  Pose T_camera_scene = Pose::Identity();
  const Eigen::Vector3f forward = sign * Eigen::Vector3f::Unit(axis),
                        right = Eigen::Vector3f::Unit((axis + 1) % 3);
  T_camera_scene.linear().row(0) = right.transpose();
  T_camera_scene.linear().row(1) = forward.cross(right).transpose();
  T_camera_scene.linear().row(2) = forward.transpose();
  T_camera_scene.translation() = -(T_camera_scene.linear() * viewpoint);
  return T_camera_scene;
}

/// Tangents of all points, or none if one is not in front of the camera.
std::vector<Tangents> tangents_of(PointsView points, const Pose& T_camera_scene) {
  std::vector<Tangents> tangents;
  tangents.reserve(points.size());
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_stop();
    const Eigen::Vector3f p = T_camera_scene * points[i];
    if (!(p.z() > 0) || !(p.head<2>().cwiseAbs().maxCoeff() < kLargestTangent * p.z())) return {};
    const auto z = static_cast<double>(p.z());
    tangents.push_back({static_cast<double>(p.x()) / z, static_cast<double>(p.y()) / z});
  }
  return tangents;
}

/// Points chosen by chance: evenly chosen ones might all be of the same columns.
Points choose_sample(PointsView points) {
  Points sample;
  const std::size_t n = points.size();
  sample.reserve(std::min(n, kSampled));
  CounterRandom random(0, 0, n);
  for (std::size_t i = 0; i < std::min(n, kSampled); ++i)
    sample.push_back(points[n <= kSampled ? i : random.next() % n]);
  return sample;
}

std::vector<double> values_of(std::span<const Tangents> tangents, std::size_t direction) {
  std::vector<double> values;
  values.reserve(tangents.size());
  for (const Tangents& tangent : tangents) values.push_back(tangent[direction]);
  return values;
}

/// Share of the right and lower neighbors of measured pixels that are measured; 0 if a point lies
/// outside the image.
double neighbor_share(std::span<const Tangents> tangents, const Lines& columns, const Lines& rows) {
  std::vector<std::uint8_t> measured(columns.count * rows.count, 0);
  for (const Tangents& tangent : tangents) {
    const double u = std::round(columns.position_of(tangent[0])),
                 v = std::round(rows.position_of(tangent[1]));
    if (!(u >= 0 && v >= 0 && u < static_cast<double>(columns.count) &&
          v < static_cast<double>(rows.count)))
      return 0;
    measured[static_cast<std::size_t>(v) * columns.count + static_cast<std::size_t>(u)] = 1;
  }
  double pairs = 0, pixels = 0;
  for (std::size_t v = 0; v + 1 < rows.count; ++v) {
    check_stop();
    for (std::size_t u = 0; u + 1 < columns.count; ++u) {
      const std::size_t at = v * columns.count + u;
      if (measured[at] == 0) continue;
      pixels += 1;
      pairs += measured[at + 1] + measured[at + columns.count];
    }
  }
  return pixels > 0 ? pairs / (2 * pixels) : 0;
}

std::optional<PosedCamera> fit_along(PointsView points, PointsView sample,
                                     const Pose& T_camera_scene) {
  const std::vector<Tangents> sampled = tangents_of(sample, T_camera_scene);
  if (sampled.empty()) return std::nullopt;
  std::optional<Lines> columns = find_lines(values_of(sampled, 0));
  std::optional<Lines> rows = columns ? find_lines(values_of(sampled, 1)) : std::nullopt;
  if (!rows) return std::nullopt;
  const std::vector<Tangents> tangents = tangents_of(points, T_camera_scene);
  if (tangents.empty()) return std::nullopt;
  double sum = 0;
  Tangents low = tangents.front(), high = low;
  for (const Tangents& tangent : tangents) {
    sum += distance2(*columns, tangent[0]) + distance2(*rows, tangent[1]);
    for (std::size_t d = 0; d < 2; ++d) {
      low[d] = std::min(low[d], tangent[d]);
      high[d] = std::max(high[d], tangent[d]);
    }
  }
  const double residual = std::sqrt(sum / static_cast<double>(tangents.size()));
  if (!(residual <= std::sqrt(2.0) * kResidual) ||
      std::min(columns->pitch, rows->pitch) * kLargestFocalLength < 1)
    return std::nullopt;
  // The sample may lack the outermost lines.
  for (std::size_t d = 0; d < 2; ++d) {
    Lines& lines = d == 0 ? *columns : *rows;
    const double first = std::round(lines.position_of(low[d])),
                 last = std::round(lines.position_of(high[d]));
    lines.first += first * lines.pitch;
    lines.count = static_cast<std::size_t>(last - first) + 1;
  }
  const auto num_pixels = static_cast<double>(columns->count) * static_cast<double>(rows->count);
  if (num_pixels > kMostPixels * static_cast<double>(points.size()) ||
      neighbor_share(tangents, *columns, *rows) < kNeighbors)
    return std::nullopt;
  PosedCamera camera;
  camera.residual = residual;
  ImageGeometry& geometry = camera.geometry;
  geometry.T_camera_scene = T_camera_scene;
  geometry.fx = static_cast<float>(1 / columns->pitch);
  geometry.fy = static_cast<float>(1 / rows->pitch);
  geometry.cx = static_cast<float>(-columns->first / columns->pitch);
  geometry.cy = static_cast<float>(-rows->first / rows->pitch);
  geometry.width = static_cast<std::uint32_t>(columns->count);
  geometry.height = static_cast<std::uint32_t>(rows->count);
  return camera;
}

}  // namespace

std::optional<PosedCamera> fit_ray_lattice(PointsView points, const Eigen::Vector3f& viewpoint) {
  if (points.size() < kFewestPoints) return std::nullopt;
  const Points sample = choose_sample(points);
  for (const Eigen::Index axis : {2, 0, 1}) {
    for (const float sign : {1.0F, -1.0F}) {
      std::optional<PosedCamera> camera =
          fit_along(points, sample, pose_of_axis(axis, sign, viewpoint));
      if (!camera) continue;
      camera->center = viewpoint.cast<double>();
      return camera;
    }
  }
  return std::nullopt;
}

}  // namespace trivet::kernels
