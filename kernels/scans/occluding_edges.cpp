#include "kernels/scans/occluding_edges.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace trivet::kernels {
namespace {

// Between a face's normal and the ray. A steeper surface rather bends away than ends.
constexpr float kLeastFacing = 0.5F;
// What lies within so many standard deviations of a face's plane belongs to it.
constexpr float kEdgeDeviations = 3;
// Pixels without a measurement beyond an edge: many sensors lose those that see both sides of it.
constexpr int kWidestGap = 2;
constexpr int kDiskRadius = 5;  // of the disk by which an edge's direction is measured [pixel]
// Shares of that disk: of what lies on the face and behind it, at least, and before it, at most, or
// something nearer hides where the face ends.
constexpr float kLeastFace = 0.2F, kLeastBehind = 0.15F, kMostBefore = 0.1F;

/// The plane of a face, in the camera's frame.
struct Face {
  Eigen::Vector3f normal;
  float offset;
  float tolerance;

  float height(const Eigen::Vector3f& p) const noexcept { return normal.dot(p) - offset; }
};

class EdgeFinder {
 public:
  EdgeFinder(const RangeImage& image, const OccludingEdgeOptions& options)
      : image_(image),
        options_(options),
        least_step_(kEdgeDeviations * options.sensor.error_at(options.nearest)) {}

  /// The face whose last pixel in a direction this is.
  std::optional<Face> face_ending_at(int u, int v, int du, int dv) const noexcept {
    int x = u + du, y = v + dv;
    for (int gap = 0; gap < kWidestGap && !(depth(x, y) > 0); ++gap) x += du, y += dv;
    if (!(depth(x, y) > depth(u, v) + least_step_)) return std::nullopt;
    const int away = options_.window + 1;  // no normal is fitted to both sides
    const std::optional<Face> face = face_at(u - away * du, v - away * dv);
    if (!face) return std::nullopt;
    const float last = face->height(point(u, v)), beyond = face->height(point(x, y));
    // A surface that bends away falls back a little from each pixel to the next.
    const bool ends =
        std::abs(last) <= face->tolerance && beyond < std::min(last, 0.0F) - face->tolerance;
    if (!ends) return std::nullopt;
    return face;
  }

  /// The direction out of a face in its plane; empty where no straight edge is.
  std::optional<Eigen::Vector3f> direction(int u, int v, const Face& face) const noexcept {
    const ImageGeometry& camera = image_.geometry;
    // Depth z at the pixel (u + i, v + j) is the point z * (ray + (i / fx, j / fy, 0)).
    const Eigen::Vector3f center = point(u, v), ray = center / center.z();
    const float along = face.normal.dot(ray), along_u = face.normal.x() / camera.fx,
                along_v = face.normal.y() / camera.fy;
    float sum_u = 0, sum_v = 0, sum_z = 0;
    int on_face = 0, behind = 0, before = 0, all = 0;
    for (int j = -kDiskRadius; j <= kDiskRadius; ++j) {
      for (int i = -kDiskRadius; i <= kDiskRadius; ++i) {
        if (i * i + j * j > kDiskRadius * kDiskRadius) continue;
        ++all;
        const float z = depth(u + i, v + j);
        if (!(z > 0)) continue;
        const auto di = static_cast<float>(i), dj = static_cast<float>(j);
        const float height = z * (along + di * along_u + dj * along_v) - face.offset;
        if (height < -face.tolerance) {
          ++behind;
        } else if (height > face.tolerance) {
          ++before;
        } else {
          ++on_face;
          sum_u += z * di;
          sum_v += z * dj;
          sum_z += z;
        }
      }
    }
    const auto share = [all](float of) { return of * static_cast<float>(all); };
    if (static_cast<float>(on_face) < share(kLeastFace) ||
        static_cast<float>(behind) < share(kLeastBehind) ||
        static_cast<float>(before) > share(kMostBefore))
      return std::nullopt;
    const Eigen::Vector3f sum = sum_z * ray - static_cast<float>(on_face) * center +
                                Eigen::Vector3f(sum_u / camera.fx, sum_v / camera.fy, 0);
    const Eigen::Vector3f out = face.normal * face.normal.dot(sum) - sum;
    const float length = out.norm();
    if (!(length > 0)) return std::nullopt;
    return out / length;
  }

  Eigen::Vector3f point(int u, int v) const noexcept {
    return image_.geometry.back_project(index(u, v), image_.depth[index(u, v)]);
  }

  float depth(int u, int v) const noexcept {
    if (u < 0 || v < 0 || u >= static_cast<int>(image_.geometry.width) ||
        v >= static_cast<int>(image_.geometry.height))
      return 0;
    return image_.depth[index(u, v)];
  }

 private:
  std::size_t index(int u, int v) const noexcept {
    return static_cast<std::size_t>(v) * image_.geometry.width + static_cast<std::size_t>(u);
  }

  std::optional<Face> face_at(int u, int v) const noexcept {
    if (!(depth(u, v) > 0)) return std::nullopt;
    const Eigen::Vector3f n = image_.normals[index(u, v)], p = point(u, v);
    if (!(-n.dot(p) > kLeastFacing * p.norm())) return std::nullopt;  // false for NaN, too
    return Face{n, n.dot(p), kEdgeDeviations * options_.sensor.error_at(p.z())};
  }

  const RangeImage& image_;
  const OccludingEdgeOptions& options_;
  float least_step_;  // nowhere are smaller steps more than errors
};

}  // namespace

void find_occluding_edges(const RangeImage& image, const OccludingEdgeOptions& options,
                          std::size_t first_row, std::size_t num_rows, Points& points,
                          Normals& directions) {
  const EdgeFinder finder(image, options);
  for (std::size_t row = first_row; row < first_row + num_rows; ++row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < static_cast<int>(image.geometry.width); ++u) {
      if (!(finder.depth(u, v) > 0)) continue;
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const std::optional<Face> face = finder.face_ending_at(u, v, du, dv);
        if (!face) continue;
        const std::optional<Eigen::Vector3f> out = finder.direction(u, v, *face);
        if (!out) continue;
        points.push_back(finder.point(u, v));
        directions.push_back(*out);
        break;
      }
    }
  }
}

}  // namespace trivet::kernels
