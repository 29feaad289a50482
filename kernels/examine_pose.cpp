#include "kernels/examine_pose.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernels/ray_crop.hpp"

namespace trivet::kernels {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr float kGrazing = 0.17F;      // cosine below which a surface is too oblique to be measured
constexpr int kMargin = 4;             // rays beyond an outline, which no hole of a cloud is wide
constexpr float kFoldCosine = 0.866F;  // 30 degrees: noise turns normals by less
constexpr double kFewest = 6;          // residuals of a window that give a slope

enum State : std::uint8_t { kMissed, kOutside, kHidden, kJudged, kConsistent };

/// Sums over the consistent pixels of all images.
struct Sums {
  double count = 0, squares = 0, smooth = 0, slope = 0, num_slopes = 0, area = 0;
  Matrix6 covariance = Matrix6::Zero();
};

/// One image's share of an examination.
class Examiner {
 public:
  Examiner(const RangeImage& image, const ModelSamples& samples, const Pose& T_scene_model,
           const PixelBox& box, const ExamineOptions& options, ExamineScratch& scratch)
      : image_(image),
        g_(image.geometry),
        options_(options),
        s_(scratch),
        T_camera_model_(g_.T_camera_scene * T_scene_model),
        diameter_(samples.diameter),
        centre_(T_camera_model_ * samples.centre),
        crop_(box, kMargin) {}

  const RayCrop& crop() const noexcept { return crop_; }

  void compare(const RayScene& surface, std::uint32_t first_pixel, Examination& out, Sums& sums,
               ExplainedPixels* explained) {
    shoot_rays(g_, crop_, surface, T_camera_model_, s_.directions, s_.distance, s_.normals);
    s_.state.assign(crop_.size(), kMissed);
    s_.residual.assign(crop_.size(), 0);
    const Eigen::Matrix3f R_scene_camera = g_.T_camera_scene.linear().transpose();
    const Eigen::Matrix3f R_camera_model = T_camera_model_.linear();
    const auto square = static_cast<float>(crop_.stride * crop_.stride);
    for (int j = 0; j < crop_.height; ++j) {
      for (int i = 0; i < crop_.width; ++i) {
        const std::size_t at = crop_.at(i, j);
        const float z = s_.distance[at];
        if (!std::isfinite(z)) continue;
        const int u = crop_.u(i), v = crop_.v(j);
        if (!inside(u, v)) {
          s_.state[at] = kOutside;
          out.outside += square;
          continue;
        }
        s_.state[at] = kJudged;
        out.covered += square;
        const Eigen::Vector3f ray = ray_through(g_, u, v);
        Eigen::Vector3f normal = (R_camera_model * s_.normals[at]).normalized();
        const float length = ray.norm();
        if (normal.dot(ray) > 0) normal = -normal;
        const float facing = -normal.dot(ray) / length;
        if (!(facing > kGrazing)) continue;

        const auto [r, pixel] =
            measure_along(image_, u, v, z, length * facing, options_.verify.tolerance);
        if (pixel < 0) {
          out.unknown += square;
          continue;
        }
        const bool background =
            options_.verify.is_background(image_.plane[static_cast<std::size_t>(pixel)]);
        const float tolerance = options_.verify.tolerance;
        if (r > tolerance) {
          out.violation += square;
        } else if (r < -tolerance) {
          (background ? out.violation : out.occluded) += square;  // nothing reaches through a table
          if (!background) s_.state[at] = kHidden;
        } else if (background) {
          out.background += square;
        } else {
          s_.state[at] = kConsistent;
          s_.residual[at] = r;
          out.consistent += square;
          const double share = static_cast<double>(r / tolerance);
          sums.count += 1;
          sums.squares += share * share;
          sums.area += static_cast<double>(square * z * z / (g_.fx * g_.fy * facing));
          const Eigen::Vector3f n = R_scene_camera * normal;
          const Eigen::Vector3f arm = R_scene_camera * (ray * z - centre_) / (0.5F * diameter_);
          Vector6 J;
          J << arm.cross(n).cast<double>(), n.cast<double>();
          sums.covariance.noalias() += J * J.transpose();
          if (explained)
            explained->pixels.push_back(first_pixel + static_cast<std::uint32_t>(v) * g_.width +
                                        static_cast<std::uint32_t>(u));
        }
      }
    }
  }

  /// Average the residuals over windows, and fit planes to them.
  void smooth(Sums& sums) {
    sum_up();
    const int half = std::max(
        1, static_cast<int>(std::lround(options_.window / static_cast<float>(crop_.stride))));
    const double tolerance = static_cast<double>(options_.verify.tolerance);
    for (int j = 0; j < crop_.height; ++j) {
      for (int i = 0; i < crop_.width; ++i) {
        const std::size_t at = crop_.at(i, j);
        if (s_.state[at] != kConsistent) continue;
        const std::array<double, 9> w =
            window_sums(std::max(0, i - half), std::max(0, j - half),
                        std::min(crop_.width - 1, i + half), std::min(crop_.height - 1, j + half));
        const double n = w[0], mean = w[1] / n;
        sums.smooth += mean * mean / (tolerance * tolerance);
        if (n < kFewest) continue;
        const double xx = w[4] - w[2] * w[2] / n, yy = w[5] - w[3] * w[3] / n;
        const double xy = w[6] - w[2] * w[3] / n;
        const double rx = w[7] - w[1] * w[2] / n, ry = w[8] - w[1] * w[3] / n;
        const double determinant = xx * yy - xy * xy;
        if (!(determinant > 1e-3 * n * n)) continue;
        const double gx = (rx * yy - ry * xy) / determinant, gy = (ry * xx - rx * xy) / determinant;
        const double step =
            static_cast<double>(s_.distance[at] / g_.fx * static_cast<float>(crop_.stride));
        sums.slope += std::atan(std::sqrt(gx * gx + gy * gy) / step);
        sums.num_slopes += 1;
      }
    }
  }

  /// Beyond the outline a real object's scene falls back or is not measured, within the few pixels
  /// that sensors blur edges over; a wrong fit on a larger surface finds that surface running on.
  void follow_outline(Examination& out) const {
    const float jump = std::max(2 * options_.verify.tolerance, 0.03F * diameter_);
    constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (int j = kMargin; j < crop_.height - kMargin; ++j) {
      for (int i = kMargin; i < crop_.width - kMargin; ++i) {
        if (s_.state[crop_.at(i, j)] < kJudged) continue;
        for (const auto& [di, dj] : kSteps) {
          if (ends_at(i, j, di, dj)) judge_beyond(i, j, di, dj, jump, out);
        }
      }
    }
  }

 private:
  bool inside(int u, int v) const noexcept {
    return u >= 0 && v >= 0 && u < static_cast<int>(g_.width) && v < static_cast<int>(g_.height);
  }

  /// Summed-area table of 1, r, x, y, xx, yy, xy, rx and ry over consistent pixels.
  void sum_up() {
    const std::size_t row = static_cast<std::size_t>(crop_.width) + 1;
    s_.sums.assign(row * (static_cast<std::size_t>(crop_.height) + 1), {});
    for (int j = 0; j < crop_.height; ++j) {
      std::array<double, 9> line{};
      for (int i = 0; i < crop_.width; ++i) {
        const std::size_t at = crop_.at(i, j);
        if (s_.state[at] == kConsistent) {
          const double r = static_cast<double>(s_.residual[at]), x = i, y = j;
          const std::array<double, 9> add{1, r, x, y, x * x, y * y, x * y, r * x, r * y};
          for (std::size_t k = 0; k < 9; ++k) line[k] += add[k];
        }
        const std::size_t below =
            (static_cast<std::size_t>(j) + 1) * row + static_cast<std::size_t>(i) + 1;
        for (std::size_t k = 0; k < 9; ++k) s_.sums[below][k] = s_.sums[below - row][k] + line[k];
      }
    }
  }

  std::array<double, 9> window_sums(int i0, int j0, int i1, int j1) const noexcept {
    const std::size_t row = static_cast<std::size_t>(crop_.width) + 1;
    const auto at = [&](int i, int j) -> const std::array<double, 9>& {
      return s_.sums[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i)];
    };
    std::array<double, 9> sum;
    for (std::size_t k = 0; k < 9; ++k)
      sum[k] = at(i1 + 1, j1 + 1)[k] - at(i0, j1 + 1)[k] - at(i1 + 1, j0)[k] + at(i0, j0)[k];
    return sum;
  }

  /// Whether the model ends here: nothing is met by the rays beyond. Clouds have holes a few rays
  /// wide.
  bool ends_at(int i, int j, int di, int dj) const noexcept {
    for (int k = 1; k <= kMargin; ++k) {
      if (s_.state[crop_.at(i + k * di, j + k * dj)] != kMissed) return false;
    }
    return true;
  }

  void judge_beyond(int i, int j, int di, int dj, float jump, Examination& out) const noexcept {
    const float z = s_.distance[crop_.at(i, j)];
    // The outline is somewhere between this ray and the next one.
    const int reach =
        crop_.stride - 1 + std::max(3, static_cast<int>(0.03F * diameter_ * g_.fx / z));
    bool any = false, open = false, judged = true;
    for (int step = 1; step <= reach; ++step) {
      const int u = crop_.u(i) + step * di, v = crop_.v(j) + step * dj;
      if (!inside(u, v)) break;
      any = true;
      const std::size_t pixel =
          static_cast<std::size_t>(v) * g_.width + static_cast<std::size_t>(u);
      const float d = image_.depth[pixel];
      if (d > 0 && d < z - jump) {
        judged = false;  // hidden by something nearer
      } else if (!(d > 0) || d > z + jump) {
        open = true;
      } else if (options_.verify.is_background(image_.near_plane[pixel])) {
        judged = false;  // things stand on it
      }
    }
    if (!any) return;
    const auto length = static_cast<float>(crop_.stride);
    if (open) {
      out.outline_free += length;
    } else if (judged) {
      const bool folded = folds(crop_.u(i), crop_.v(j), di, dj);
      (folded ? out.outline_touching : out.outline_crossed) += length;
    }
  }

  /// Whether the scene's surface bends between both sides of a pixel, as where two bodies touch;
  /// false where either side has no normal. The normals lie far enough apart that none is fitted
  /// to both sides.
  bool folds(int u, int v, int du, int dv) const noexcept {
    const int away = static_cast<int>(options_.window) + 1;
    const int u0 = u - away * du, v0 = v - away * dv, u1 = u + away * du, v1 = v + away * dv;
    if (!inside(u0, v0) || !inside(u1, v1)) return false;
    const auto normal = [&](int x, int y) {
      return image_.normals[static_cast<std::size_t>(y) * g_.width + static_cast<std::size_t>(x)];
    };
    return normal(u0, v0).dot(normal(u1, v1)) < kFoldCosine;
  }

  const RangeImage& image_;
  const ImageGeometry& g_;
  const ExamineOptions& options_;
  ExamineScratch& s_;
  Pose T_camera_model_;
  float diameter_;
  Eigen::Vector3f centre_;
  RayCrop crop_;
};

/// What turning about the symmetry axis does to J, as a unit vector; zero without an axis.
Vector6 free_turn(const ModelSamples& samples, const Symmetry& symmetry,
                  const Pose& T_scene_model) noexcept {
  Vector6 turn = Vector6::Zero();
  if (!symmetry.axis) return turn;
  const Eigen::Vector3f axis = T_scene_model.linear() * symmetry.axis->direction;
  const Eigen::Vector3f arm =
      T_scene_model * samples.centre - T_scene_model * Eigen::Vector3f(symmetry.axis->point);
  turn << axis.cast<double>(), (axis.cross(arm) / (0.5F * samples.diameter)).cast<double>();
  return turn.normalized();
}

}  // namespace

void examine_pose(std::span<const RangeImage> images, const RayScene& surface,
                  const ModelSamples& samples, const Symmetry& symmetry, const Pose& T_scene_model,
                  const ExamineOptions& options, ExamineScratch& scratch, Examination& out,
                  ExplainedPixels* explained) {
  out = {};
  if (explained) *explained = {};
  const float radius = 0.5F * ball_diameter(samples);
  Sums sums;
  std::uint32_t first_pixel = 0;
  for (const RangeImage& image : images) {
    const std::optional<PixelBox> box = project_ball(
        image.geometry, image.geometry.T_camera_scene * (T_scene_model * samples.centre), radius);
    if (box) {
      Examiner examiner(image, samples, T_scene_model, *box, options, scratch);
      examiner.compare(surface, first_pixel, out, sums, explained);
      examiner.smooth(sums);
      examiner.follow_outline(out);
      if (explained) explained->square = static_cast<std::uint32_t>(examiner.crop().stride);
    }
    first_pixel += static_cast<std::uint32_t>(image.depth.size());
  }
  if (sums.count == 0) return;
  out.residual = static_cast<float>(sums.squares / sums.count);
  out.smooth = static_cast<float>(sums.smooth / sums.count);
  out.slope = static_cast<float>(sums.slope / std::max(1.0, sums.num_slopes));
  out.area = static_cast<float>(sums.area) / (samples.diameter * samples.diameter);
  const Vector6 turn = free_turn(samples, symmetry, T_scene_model);
  const Matrix6 held = sums.covariance / sums.count + turn * turn.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(held, Eigen::EigenvaluesOnly);
  out.hold = static_cast<float>(std::max(0.0, solver.eigenvalues()(0)));
}

}  // namespace trivet::kernels
