#include "kernels/verification/examine_pose.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "kernels/common/slope_fit.hpp"
#include "kernels/verification/ray_crop.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kMargin = 4;              // rays beyond an outline, wider than any hole of a cloud
constexpr float kFoldCosine = 0.866F;   // 30 degrees: noise turns normals by less
constexpr int kRounded = 3;             // largest width of a crease rounded by sensors, in windows
constexpr double kFewestResiduals = 6;  // residuals of a window needed for a slope
constexpr int kAcross = 3;  // rays around an outline's position that determine its direction
constexpr float kSameCosine = 0.985F;  // 10 degrees: directions of outlines err by less
// An edge is located to about a pixel, some twice the noise of depth: squared, a quarter. It
// weights the outline's mean, since the outline's share of the pixels falls with the resolution.
constexpr double kOutlineShare = 0.25;
// Buried parts extend deeper beneath the measured surface than distorted depth and the rims of
// clouds: by more than this many tolerances, within these limits of the number of rays.
constexpr float kDeep = 3;
constexpr int kLeastRays = 3, kMostRays = 16;
// A surface at a smaller height above the model may be mistaken for it [tolerances].
constexpr float kShallow = 6;
// If neighbors err alike, depth is locally wrong by a few tolerances: only measurements this much
// more than a tolerance behind the model are certain violations.
constexpr float kSoftness = 1.5F;

// The distance of an outline from an edge of the scan errs by half a pixel, alike for the next two
// pixels along it. What a whole side errs by, since sensors shift edges and cameras are calibrated
// to about a pixel, no number of pixels reduces.
constexpr double kEdgeError = 0.5, kEdgeRun = 2, kSharedEdgeError = 0.7, kSides = 4;
constexpr int kEdgeReach = 12;       // pixels from the model's end to that of the surface
constexpr int kCertain = 2;          // pixels measured beyond the model before a gap
constexpr float kFlatCosine = 0.3F;  // of incidence: a surface that is continued in its plane
constexpr float kLeastAlong = 0.3F;  // cosine between a step and the direction across an outline

constexpr int kMostReach = 4096;  // pixels; unbounded for a surface next to the camera

enum State : std::uint8_t { kMissed, kOutside, kHidden, kJudged, kConsistent };

/// Rows of the equations of a pose.
struct Equations {
  PoseEquations sums;
  double count = 0;

  /// Add a row: J x is to be `distance`, up to this standard deviation.
  void add(const Vector6& J, double distance, double deviation) {
    const double weight = 1 / (deviation * deviation);
    sums.information.noalias() += weight * J * J.transpose();
    sums.gradient.noalias() += weight * distance * J;
    count += 1;
  }
};

/// Sums over the consistent pixels and the outlines of all images.
struct Sums {
  double count = 0, squares = 0, smooth = 0, slope = 0, num_slopes = 0, area = 0;
  Matrix6 covariance = Matrix6::Zero();
  Eigen::Vector3d places = Eigen::Vector3d::Zero();  // relative to the model's center
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double outline = 0;  // number of outline positions
  Matrix6 outline_covariance = Matrix6::Zero();
  Equations surfaces, edges;
};

/// A ray, and the direction along the image in which the surface that it hit ends.
struct RayEnd {
  int i, j;    // index of the ray in the crop
  int di, dj;  // one of the four steps to a neighbor
};

/// What a pixel near an end of the model measures.
enum class Place : std::uint8_t {
  surface,  // the surface before the end, continued in its plane
  behind,   // something farther
  unmeasured,
  elsewhere,  // something nearer, or in contact
};

/// One image's share of an examination.
class Examiner {
 public:
  Examiner(const RangeImage& image, const PosedModel& model, const PixelBox& box,
           const ExamineOptions& options, ExamineScratch& scratch, std::vector<JudgedRay>* rays)
      : image_(image),
        g_(image.geometry),
        options_(options),
        s_(scratch),
        rays_(rays),
        surface_(model.surface),
        T_camera_model_(g_.T_camera_scene * model.T_scene_model),
        R_scene_camera_(g_.T_camera_scene.linear().transpose()),
        diameter_(model.samples.diameter),
        jump_(std::max(2 * options.verify.tolerance, 0.03F * diameter_)),
        center_(T_camera_model_ * model.samples.center),
        edge_(options.edge_pixels),
        softness_(std::max(1e-6F, kSoftness * options.correlation)),
        crop_(box, kMargin),
        pixel_error_(pixel_error()) {}

  const RayCrop& crop() const noexcept { return crop_; }

  void compare(std::uint32_t first_pixel, Examination& out, Sums& sums,
               ExplainedPixels* explained) {
    shoot_rays(g_, crop_, surface_, T_camera_model_, s_.directions, s_.hits);
    s_.state.assign(crop_.size(), kMissed);
    s_.residual.assign(crop_.size(), 0);
    const Eigen::Matrix3f R_camera_model = T_camera_model_.linear();
    const auto square = static_cast<float>(crop_.stride * crop_.stride);
    for (int j = 0; j < crop_.height; ++j) {
      for (int i = 0; i < crop_.width; ++i) {
        const std::size_t at = crop_.at(i, j);
        const float z = s_.hits.depths[at];
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
        Eigen::Vector3f normal = (R_camera_model * s_.hits.normals[at]).normalized();
        const float length = ray.norm();
        if (normal.dot(ray) > 0) normal = -normal;
        const float facing = -normal.dot(ray) / length;
        if (!(facing > kMinRayCosine)) continue;

        const float tolerance = options_.verify.tolerance;
        const ExpectedPoint expected{u, v, z, length * facing};
        const auto [r, pixel] = measure_along(image_, expected, tolerance);
        if (pixel < 0) {
          out.unknown += square;
          record(RayVerdict::unmeasured, ray * z);
          continue;
        }
        const bool background =
            options_.verify.is_background(image_.plane[static_cast<std::size_t>(pixel)]);
        if (std::abs(r) > tolerance) {
          if (measured_beside(image_, expected, tolerance, edge_)) continue;
          if (r > 0 || background) {  // nothing penetrates a table
            out.violation += square * std::min(1.0F, (std::abs(r) / tolerance - 1) / softness_);
            record(RayVerdict::looked_through, ray * z);
          } else {
            out.occluded += square;
            if (r > -kShallow * tolerance) out.sunk += square;
            s_.state[at] = kHidden;
            s_.residual[at] = r;
            record(RayVerdict::hidden, ray * z);
          }
        } else if (background) {
          out.background += square;
          record(RayVerdict::background, ray * z);
        } else {
          s_.state[at] = kConsistent;
          s_.residual[at] = r;
          out.consistent += square;
          record(RayVerdict::agrees, ray * z);
          const double share = static_cast<double>(r / tolerance);
          sums.count += 1;
          sums.squares += share * share;
          sums.area += static_cast<double>(square * z * z / (g_.fx * g_.fy * facing));
          const Eigen::Vector3d place = (R_scene_camera_ * (ray * z - center_)).cast<double>();
          sums.places += place;
          sums.spread.noalias() += place * place.transpose();
          const Vector6 J = constraint(ray * z, normal);
          sums.covariance.noalias() += J * J.transpose();
          sums.surfaces.add(J, static_cast<double>(-r), pixel_error_);
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
    const int half = clamped_integer(std::round(options_.window / static_cast<float>(crop_.stride)),
                                     1, kMostReach);
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
        if (n < kFewestResiduals) continue;
        const SlopeFit fit = fit_slope({n, w[2], w[3], w[4], w[6], w[5], w[1], w[7], w[8]});
        if (!(fit.determinant > 1e-3 * n * n)) continue;
        const double step =
            static_cast<double>(s_.hits.depths[at] / g_.fx * static_cast<float>(crop_.stride));
        sums.slope += std::atan(std::sqrt(fit.gx * fit.gx + fit.gy * fit.gy) / step);
        sums.num_slopes += 1;
      }
    }
  }

  /// Beyond the outline, the scene of a real object falls back or is not measured, within the few
  /// pixels over which sensors blur edges; for a wrong fit on a larger surface that surface
  /// continues.
  void follow_outline(Examination& out, Sums& sums) const {
    constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (int j = kMargin; j < crop_.height - kMargin; ++j) {
      for (int i = kMargin; i < crop_.width - kMargin; ++i) {
        if (s_.state[crop_.at(i, j)] < kJudged) continue;
        for (const auto& [di, dj] : kSteps) {
          const RayEnd end{i, j, di, dj};
          if (ends_at(end)) {
            judge_end(end, out, sums);
          } else if (dips_at(end) && runs_on(end)) {
            out.buried += static_cast<float>(crop_.stride);
          }
        }
      }
    }
  }

 private:
  /// at  position in the camera's frame
  void record(RayVerdict verdict, const Eigen::Vector3f& at) const {
    if (rays_ != nullptr) rays_->push_back({g_.T_camera_scene.inverse() * at, verdict});
  }

  float depth_at(int i, int j) const noexcept { return s_.hits.depths[crop_.at(i, j)]; }

  bool inside(int u, int v) const noexcept {
    return u >= 0 && v >= 0 && u < static_cast<int>(g_.width) && v < static_cast<int>(g_.height);
  }

  std::size_t pixel_at(int u, int v) const noexcept {
    return static_cast<std::size_t>(v) * g_.width + static_cast<std::size_t>(u);
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

  /// Whether the model ends here: the rays beyond hit nothing. Clouds have holes a few rays wide.
  bool ends_at(const RayEnd& end) const noexcept {
    for (int k = 1; k <= kMargin; ++k) {
      if (s_.state[crop_.at(end.i + k * end.di, end.j + k * end.dj)] != kMissed) return false;
    }
    return true;
  }

  /// Whether the visible part ends here, and the model continues deep beneath the measured surface.
  bool dips_at(const RayEnd& end) const noexcept {
    if (s_.state[crop_.at(end.i, end.j)] != kConsistent) return false;
    const float deep = -kDeep * options_.verify.tolerance;
    const int least = kLeastRays + edge_ / crop_.stride;
    for (int k = 1; k <= kMostRays; ++k) {
      const int x = end.i + k * end.di, y = end.j + k * end.dj;
      if (x < 0 || y < 0 || x >= crop_.width || y >= crop_.height) return false;
      const std::size_t at = crop_.at(x, y);
      if (s_.state[at] != kHidden) return false;
      if (k >= least && s_.residual[at] < deep) return true;
    }
    return false;
  }

  /// Whether the scene continues in the plane before this ray: no edge, no fold.
  bool runs_on(const RayEnd& end) const noexcept {
    const auto [i, j, di, dj] = end;
    const int u = crop_.u(i), v = crop_.v(j);
    const int away = static_cast<int>(options_.window) + 1;  // no normal is fitted to both sides
    if (folds(u, v, away * di, away * dj)) return false;
    const int u0 = u - away * di, v0 = v - away * dj;
    if (!inside(u0, v0)) return false;
    const std::size_t before = pixel_at(u0, v0);
    const Eigen::Vector3f n = image_.normals[before];
    if (!(image_.depth[before] > 0) || !std::isfinite(n.x())) return false;
    const float offset = n.dot(g_.back_project(before, image_.depth[before]));
    const int last = reach(depth_at(i, j));
    for (int step = 1; step <= last; ++step) {
      const int x = u + step * di, y = v + step * dj;
      if (!inside(x, y)) return false;
      const float d = image_.depth[pixel_at(x, y)];
      if (!(d > 0) || std::abs(n.dot(g_.back_project(pixel_at(x, y), d)) - offset) > jump_)
        return false;
    }
    return true;
  }

  /// Evaluate an end of the model: the scene beyond, and the constraint on the pose.
  void judge_end(const RayEnd& end, Examination& out, Sums& sums) const {
    const bool free = judge_beyond(end, out);
    sums.outline += 1;
    add_edge(end, sums);
    if (!free || !agrees_within(end)) return;
    const Vector6 J = outline_constraint(end.i, end.j);
    sums.outline_covariance.noalias() += J * J.transpose();
  }

  /// Width in pixels over which sensors blur an outline. The outline is somewhere between the last
  /// ray that hits the model and the next one.
  int reach(float z) const noexcept {
    return crop_.stride - 1 +
           std::max({3, edge_ + 1, clamped_integer(0.03F * diameter_ * g_.fx / z, 0, kMostReach)});
  }

  /// Count the scene beyond a position of the outline; returns whether that is free.
  bool judge_beyond(const RayEnd& end, Examination& out) const {
    const auto [i, j, di, dj] = end;
    const float z = depth_at(i, j);
    const int last = reach(z);
    bool any = false, open = false, judged = true;
    for (int step = 1; step <= last; ++step) {
      const int u = crop_.u(i) + step * di, v = crop_.v(j) + step * dj;
      if (!inside(u, v)) break;
      any = true;
      const std::size_t pixel = pixel_at(u, v);
      const float d = image_.depth[pixel];
      if (!(d > 0) || d > z + jump_) {
        open = true;
      } else if (d < z - jump_ || options_.verify.is_background(image_.near_plane[pixel])) {
        judged = false;  // hidden by something nearer, or standing on a table
      }
    }
    if (!any) return false;
    const auto length = static_cast<float>(crop_.stride);
    out.outline += length;
    if (open) {
      out.outline_free += length;
    } else if (judged) {
      const bool touches = creases(crop_.u(i), crop_.v(j), di, dj);
      (touches ? out.outline_touching : out.outline_crossed) += length;
      if (!touches) record(RayVerdict::runs_on, ray_through(g_, crop_.u(i), crop_.v(j)) * z);
    }
    return open;
  }

  /// Standard deviation of a pixel that counts for the rays around it: errors that neighbors share
  /// do not average out within a window.
  double pixel_error() const noexcept {
    const double side = std::max(
        1.0, (2 * static_cast<double>(options_.window) + 1) / static_cast<double>(crop_.stride));
    const auto own = static_cast<double>(options_.error),
               shared = static_cast<double>(options_.correlated_noise.height);
    return std::sqrt(own * own + side * side * shared * shared);
  }

  /// Add the distance between the model's end and that of the measured surface before it, if the
  /// surface ends nearby, before something farther.
  void add_edge(const RayEnd& end, Sums& sums) const {
    const bool is_wanted = options_.error > 0;
    const std::optional<float> pixels = is_wanted ? distance_to_edge(end) : std::nullopt;
    if (!pixels) return;
    const Eigen::Vector2f across = direction_away(end.i, end.j);
    const float along =
        across.x() * static_cast<float>(end.di) + across.y() * static_cast<float>(end.dj);
    if (!(along > kLeastAlong)) return;
    const float z = depth_at(end.i, end.j);
    const float pixel = z / g_.fx;
    // Steps in both directions meet a slanted outline more often than a straight one.
    const auto share = static_cast<double>(along * static_cast<float>(crop_.stride));
    const double deviation = static_cast<double>(pixel) *
                             (kEdgeError + static_cast<double>(edge_)) *
                             std::sqrt(kEdgeRun / share);
    sums.edges.add(edge_constraint(end, across), static_cast<double>(*pixels * along * pixel),
                   deviation);
  }

  /// Number of pixels from the model's end to that of the measured surface, beyond it or negative.
  /// Empty if the surface does not end nearby before something farther; or if it is oblique, since
  /// sensors do not measure it up to its end.
  std::optional<float> distance_to_edge(const RayEnd& end) const noexcept {
    const int u = crop_.u(end.i), v = crop_.v(end.j);
    const Eigen::Vector3f ray = ray_through(g_, u, v);
    const std::size_t at = crop_.at(end.i, end.j);
    Eigen::Vector3f normal = (T_camera_model_.linear() * s_.hits.normals[at]).normalized();
    if (normal.dot(ray) > 0) normal = -normal;
    if (!(-normal.dot(ray) > kFlatCosine * ray.norm())) return std::nullopt;
    const float offset = normal.dot(ray) * depth_at(end.i, end.j);
    const auto place_at = [&](int step) {
      const int x = u + step * end.di, y = v + step * end.dj;
      if (!inside(x, y)) return Place::elsewhere;
      const std::size_t pixel = pixel_at(x, y);
      const float d = image_.depth[pixel];
      if (!(d > 0)) return Place::unmeasured;
      const float behind = d - offset / normal.dot(ray_through(g_, x, y));
      if (std::abs(behind) > jump_) return behind > 0 ? Place::behind : Place::elsewhere;
      const float cosine = image_.normals[pixel].dot(normal);
      return cosine < kFoldCosine ? Place::elsewhere : Place::surface;  // NaN: no normal
    };
    const Place own = place_at(0);
    if (own != Place::surface && own != Place::behind) return std::nullopt;
    const int side = own == Place::surface ? 1 : -1;
    for (int step = side; std::abs(step) <= kEdgeReach; step += side) {
      const Place place = place_at(step);
      if (place == own) continue;
      // The surface may go on where nothing is measured.
      const bool is_end =
          side > 0 ? place == Place::behind || (place == Place::unmeasured && step > kCertain)
                   : place == Place::surface;
      if (!is_end) return std::nullopt;
      return static_cast<float>((side > 0 ? step - 1 : step) - pixels_beyond(end));
    }
    return std::nullopt;
  }

  /// Number of pixels beyond the last ray of the crop that still hit the model, by bisection. Both
  /// ends are then rounded alike to pixels, and a right pose has distances of 0.
  int pixels_beyond(const RayEnd& end) const noexcept {
    const Pose T_model_camera = T_camera_model_.inverse();
    int hit_at = 0, missed_at = crop_.stride;
    while (missed_at - hit_at > 1) {
      const int middle = (hit_at + missed_at) / 2;
      const Eigen::Vector3f ray =
          ray_through(g_, crop_.u(end.i) + middle * end.di, crop_.v(end.j) + middle * end.dj);
      const bool is_hit = static_cast<bool>(
          surface_.intersect(T_model_camera.translation(), T_model_camera.linear() * ray, 0,
                             std::numeric_limits<float>::infinity()));
      (is_hit ? hit_at : missed_at) = middle;
    }
    return hit_at;
  }

  /// The direction in the image perpendicular to the outline, away from the model; a unit vector or
  /// zero.
  Eigen::Vector2f direction_away(int i, int j) const noexcept {
    Eigen::Vector2f missed(0, 0);
    for (int dj = -kAcross; dj <= kAcross; ++dj) {
      for (int di = -kAcross; di <= kAcross; ++di) {
        if (di * di + dj * dj > kAcross * kAcross + 1) continue;
        if (s_.state[crop_.at(i + di, j + dj)] == kMissed)
          missed += Eigen::Vector2f(static_cast<float>(di), static_cast<float>(dj));
      }
    }
    return missed.norm() > 0 ? missed.normalized() : Eigen::Vector2f::Zero();
  }

  /// J of a point of the outline for motion across it.
  Vector6 edge_constraint(const RayEnd& end, const Eigen::Vector2f& across) const noexcept {
    const float z = depth_at(end.i, end.j);
    const Eigen::Vector3f ray = ray_through(g_, crop_.u(end.i), crop_.v(end.j));
    const Eigen::Vector2f a(across.x() * g_.fx, across.y() * g_.fy);
    const Eigen::Vector3f n(a.x(), a.y(), -a.dot(ray.head<2>()));
    return constraint(ray * z, n.normalized());
  }

  /// Whether the sensor saw the model up to its end here, except for grazing rays and those over
  /// which edges are blurred.
  bool agrees_within(const RayEnd& end) const noexcept {
    const int last = reach(depth_at(end.i, end.j)) / crop_.stride;
    for (int k = 0; k <= last; ++k) {
      const int x = end.i - k * end.di, y = end.j - k * end.dj;
      if (x < 0 || y < 0 || x >= crop_.width || y >= crop_.height) return false;
      if (s_.state[crop_.at(x, y)] == kConsistent) return true;
    }
    return false;
  }

  /// J of the outline, whose motion across itself would be visible.
  Vector6 outline_constraint(int i, int j) const noexcept {
    return edge_constraint({i, j, 0, 0}, direction_across(i, j));
  }

  /// The direction in the image perpendicular to the outline, to 4 degrees; a unit vector. Zero if
  /// the surrounding rays that miss the model lie elsewhere than those of them that hit something
  /// farther. Near a corner of the model that is hidden or continues, its sides would constrain the
  /// pose along themselves, as the steps of slanted sides would.
  Eigen::Vector2f direction_across(int i, int j) const noexcept {
    const float farther = depth_at(i, j) + jump_;
    Eigen::Vector2f missed(0, 0), measured(0, 0);
    for (int dj = -kAcross; dj <= kAcross; ++dj) {
      for (int di = -kAcross; di <= kAcross; ++di) {
        if (di * di + dj * dj > kAcross * kAcross + 1) continue;
        if (s_.state[crop_.at(i + di, j + dj)] != kMissed) continue;
        const Eigen::Vector2f step(static_cast<float>(di), static_cast<float>(dj));
        missed += step;
        const int u = crop_.u(i + di), v = crop_.v(j + dj);
        if (inside(u, v) && image_.depth[pixel_at(u, v)] > farther) measured += step;
      }
    }
    const bool agree = missed.dot(measured) > kSameCosine * missed.norm() * measured.norm();
    return agree ? missed.normalized() : Eigen::Vector2f::Zero();
  }

  /// J of a point and a direction in the camera's frame.
  Vector6 constraint(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const noexcept {
    const Eigen::Vector3f n = R_scene_camera_ * normal;
    const Eigen::Vector3f arm = R_scene_camera_ * (point - center_) / (0.5F * diameter_);
    Vector6 J;
    J << arm.cross(n).cast<double>(), n.cast<double>();
    return J;
  }

  /// Whether the scene's surface bends towards the sensor as at the contact of two bodies: sharply,
  /// or over the pixels over which sensors that match windows round off a crease. The far side of a
  /// body's own edge bends away.
  bool creases(int u, int v, int du, int dv) const noexcept {
    const int away = static_cast<int>(options_.window) + 1;
    for (int k = away; k <= kRounded * away; k += away) {
      if (!folds(u, v, k * du, k * dv)) continue;
      const std::size_t from = pixel_at(u - k * du, v - k * dv);
      const std::size_t to = pixel_at(u + k * du, v + k * dv);
      const Eigen::Vector3f across =
          g_.back_project(to, image_.depth[to]) - g_.back_project(from, image_.depth[from]);
      if (image_.normals[from].dot(across) > 0 && image_.normals[to].dot(across) < 0) return true;
    }
    return false;
  }

  /// Whether the scene's surface bends between both sides of a pixel, (du, dv) away from it; false
  /// if either side has no normal.
  bool folds(int u, int v, int du, int dv) const noexcept {
    const int u0 = u - du, v0 = v - dv, u1 = u + du, v1 = v + dv;
    if (!inside(u0, v0) || !inside(u1, v1)) return false;
    const auto normal = [&](int x, int y) { return image_.normals[pixel_at(x, y)]; };
    return normal(u0, v0).dot(normal(u1, v1)) < kFoldCosine;
  }

  const RangeImage& image_;
  const ImageGeometry& g_;
  const ExamineOptions& options_;
  ExamineScratch& s_;
  std::vector<JudgedRay>* rays_;
  const RayScene& surface_;
  Pose T_camera_model_;
  Eigen::Matrix3f R_scene_camera_;
  float diameter_;
  float jump_;  // smallest depth step between different objects
  Eigen::Vector3f center_;
  int edge_;        // [pixel]
  float softness_;  // [tolerances]
  RayCrop crop_;
  double pixel_error_;  // standard deviation of a row of the equations
};

/// Effect of rotation about the symmetry axis on J, as a unit vector; zero without an axis.
Vector6 free_turn(const PosedModel& model,
                  const std::optional<Symmetry::Axis>& free_axis) noexcept {
  Vector6 turn = Vector6::Zero();
  if (!free_axis) return turn;
  const Pose& T_scene_model = model.T_scene_model;
  const Eigen::Vector3f axis = T_scene_model.linear() * free_axis->direction;
  const Eigen::Vector3f arm =
      T_scene_model * model.samples.center - T_scene_model * Eigen::Vector3f(free_axis->point);
  turn << axis.cast<double>(), (axis.cross(arm) / (0.5F * model.samples.diameter)).cast<double>();
  return turn.normalized();
}

/// The equations of surfaces and edges, of which those of a side err alike.
PoseEquations joined(const Sums& sums) {
  const double weight = 1 / (1 + kSharedEdgeError * kSharedEdgeError * sums.edges.count /
                                     (kSides * kEdgeError * kEdgeError * kEdgeRun));
  PoseEquations all = sums.surfaces.sums;
  all.information += weight * sums.edges.sums.information;
  all.gradient += weight * sums.edges.sums.gradient;
  return all;
}

/// Standard deviation of the consistent points from their best-fit plane.
float off_plane(const Sums& sums) {
  const Eigen::Vector3d mean = sums.places / sums.count;
  const Eigen::Matrix3d spread = sums.spread / sums.count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread, Eigen::EigenvaluesOnly);
  return static_cast<float>(std::sqrt(std::max(0.0, solver.eigenvalues()(0))));
}

}  // namespace

Examination examine_pose(std::span<const RangeImage> images, const PosedModel& model,
                         const std::optional<Symmetry::Axis>& free_axis,
                         const ExamineOptions& options, ExamineScratch& scratch,
                         const ExamineLists& lists) {
  const auto [explained, rays, equations] = lists;
  if (equations) *equations = {};
  if (explained) *explained = {};
  if (rays) rays->clear();
  const ModelSamples& samples = model.samples;
  Examination out;
  const float radius = 0.5F * ball_diameter(samples);
  Sums sums;
  std::uint32_t first_pixel = 0;
  for (const RangeImage& image : images) {
    const std::optional<PixelBox> box = project_ball(
        image.geometry, image.geometry.T_camera_scene * (model.T_scene_model * samples.center),
        radius);
    if (box) {
      Examiner examiner(image, model, *box, options, scratch, rays);
      examiner.compare(first_pixel, out, sums, explained);
      examiner.smooth(sums);
      examiner.follow_outline(out, sums);
      if (explained) explained->square = static_cast<std::uint32_t>(examiner.crop().stride);
    }
    first_pixel += static_cast<std::uint32_t>(image.depth.size());
  }
  if (equations) *equations = joined(sums);
  if (sums.count == 0) return out;
  const float shared = options.correlated_noise.height / options.verify.tolerance;
  const auto beyond = [](double squares, float expected) {
    return std::max(0.0F, static_cast<float>(squares) - expected * expected);
  };
  out.mean_square = static_cast<float>(sums.squares / sums.count);
  out.residual = beyond(sums.squares / sums.count, shared);
  out.smooth = beyond(sums.smooth / sums.count, shared);
  const double slope = sums.slope / std::max(1.0, sums.num_slopes);
  out.slope = std::sqrt(beyond(slope * slope, options.correlated_noise.slope_rad));
  out.area = static_cast<float>(sums.area) / (samples.diameter * samples.diameter);
  out.relief = off_plane(sums) / options.verify.tolerance;
  const Vector6 turn = free_turn(model, free_axis);
  Matrix6 held = sums.covariance / sums.count + turn * turn.transpose();
  if (sums.outline > 0) held += kOutlineShare / sums.outline * sums.outline_covariance;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(held, Eigen::EigenvaluesOnly);
  out.stability = static_cast<float>(std::max(0.0, solver.eigenvalues()(0)));
  return out;
}

}  // namespace trivet::kernels
