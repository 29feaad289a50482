#include "kernels/symmetry/sampled_surface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernels/common/pose_math.hpp"
#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A step through n samples that visits all of them, neighbors in the list far apart in time: an
/// early look sees the whole object.
std::size_t coprime_step(std::size_t n) {
  auto step = static_cast<std::size_t>(0.618 * static_cast<double>(n)) + 1;
  while (std::gcd(step, n) != 1) ++step;
  return step;
}

/// Distances in units of the tolerance: sum of squares, number beyond 3 and beyond 6.
struct Tally {
  double squares = 0;
  int wide = 0, gross = 0;

  void add(float distance, float tolerance) {
    const float d = distance / tolerance;
    squares += d * d;
    wide += d > 3;
    gross += d > 6;
  }
  float misfit(const Tally& own, std::size_t n) const {
    const double excess = std::max(
        {squares - own.squares, (wide - own.wide) / 0.02, (gross - own.gross) / 0.0025, 0.0});
    return static_cast<float>(excess / static_cast<double>(n));
  }
};

constexpr std::size_t kLanes = 16;
constexpr std::uint32_t kNowhere = 0xFFFF'FFFFU;

struct Oriented {
  Eigen::Vector3f point, normal;
};

/// Per lane the nearest sample so far: its squared distance and its place.
struct Nearest {
  explicit Nearest(float cap) noexcept {
    squared.fill(cap * cap);
    places.fill(kNowhere);
  }

  alignas(64) std::array<float, kLanes> squared;
  alignas(64) std::array<std::uint32_t, kLanes> places;
};

/// Look at samples [first, last) as SampledSurface has them, and at some more, so that all lanes are
/// filled: these are samples too.
TRIVET_SIMD_CLONES
void keep_nearest(const float* __restrict xs, const float* __restrict ys,
                  const float* __restrict zs, const float* __restrict nxs,
                  const float* __restrict nys, const float* __restrict nzs, std::size_t first,
                  std::size_t last, const Oriented& query, float slack, std::uint32_t excluded,
                  Nearest& nearest) noexcept {
  const float qx = query.point.x(), qy = query.point.y(), qz = query.point.z();
  const float mx = query.normal.x(), my = query.normal.y(), mz = query.normal.z();
  float* __restrict squared = nearest.squared.data();
  std::uint32_t* __restrict places = nearest.places.data();
  for (std::size_t i = first; i < last; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float dx = qx - xs[i + k], dy = qy - ys[i + k], dz = qz - zs[i + k];
      const float nx = nxs[i + k], ny = nys[i + k], nz = nzs[i + k];
      const float cosine = nx * mx + ny * my + nz * mz;
      const float along = dx * (nx + mx) + dy * (ny + my) + dz * (nz + mz);
      const float agreeing = std::max(cosine, SampledSurface::kMinCosine);
      const float plane = along * along / (2 + 2 * agreeing);
      const float lateral = std::max(0.0F, dx * dx + dy * dy + dz * dz - plane);
      const float excess = std::max(0.0F, std::sqrt(lateral) - slack);
      const float distance = plane + excess * excess;
      const auto place = static_cast<std::uint32_t>(i + k);
      const bool nearer =
          (cosine >= SampledSurface::kMinCosine) & (distance < squared[k]) & (place != excluded);
      squared[k] = nearer ? distance : squared[k];
      places[k] = nearer ? place : places[k];
    }
  }
}

}  // namespace

SampledSurface::SampledSurface(PointsView points, NormalsView normals, float diameter)
    : diameter_(diameter) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t used = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!normals[i].allFinite()) continue;
    sum += points[i].cast<double>();
    ++used;
  }
  if (used == 0) return;
  center_ = (sum / static_cast<double>(used)).cast<float>();
  points_.reserve(used);
  normals_.reserve(used);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!normals[i].allFinite()) continue;
    points_.push_back((points[i] - center_) / diameter);
    normals_.push_back(normals[i]);
  }

  // Samples are looked for as far as kCap and kMaxSlack: runs of this length are read fastest.
  constexpr float kCell = 0.1F;
  grid_ = VoxelHash(points_, kCell);
  for (std::size_t k = 0; k < used + kLanes; ++k) {
    const bool exists = k < used;
    sorted_points_.push_back(exists ? grid_.ordered_points()[k] : Eigen::Vector3f::Zero());
    sorted_normals_.push_back(exists ? normals_[grid_.order()[k]] : Eigen::Vector3f::Zero());
  }
  double sum_nearest = 0;
  for (std::uint32_t i = 0; i < used; ++i) {
    float nearest = kCell * kCell;
    grid_.visit_within(points_[i], kCell, [&](std::uint32_t k, float d2) {
      if (k != i) nearest = std::min(nearest, d2);
    });
    sum_nearest += std::sqrt(nearest);
  }
  slack_ = std::min(kMaxSlack, static_cast<float>(2 * sum_nearest / static_cast<double>(used)));

  slacks_.resize(used);
  own_distances_.resize(used);
  for (std::uint32_t place = 0; place < used; ++place) {
    const std::uint32_t i = grid_.order()[place];
    slacks_[i] = std::clamp(1.5F * second_gap(i), slack_, kMaxSlack);
    own_distances_[i] = match(points_[i], normals_[i], slacks_[i], place).distance;
  }
}

float SampledSurface::second_gap(std::uint32_t sample) const noexcept {
  constexpr float kThickness = 0.01F;  // of what counts as one sheet
  float nearest = kMaxSlack * kMaxSlack, second = nearest;
  grid_.visit_within(points_[sample], kMaxSlack, [&](std::uint32_t i, float d2) {
    if (i == sample || normals_[i].dot(normals_[sample]) < kMinCosine) return;
    if (std::abs(normals_[i].dot(points_[i] - points_[sample])) > kThickness) return;
    if (d2 < nearest) std::swap(d2, nearest);
    second = std::min(second, d2);
  });
  return std::sqrt(second);
}

SampledSurface::Match SampledSurface::match(const Eigen::Vector3f& point,
                                            const Eigen::Vector3f& normal, float slack,
                                            std::uint32_t excluded, float cap) const noexcept {
  Nearest nearest(cap);
  const PointsView at = sorted_points_;
  const NormalsView along = sorted_normals_;
  grid_.visit_runs_within(point, slack + cap, [&](PointsView run, const std::uint32_t* indices) {
    const auto first = static_cast<std::size_t>(indices - grid_.order().data());
    keep_nearest(at.x.data(), at.y.data(), at.z.data(), along.x.data(), along.y.data(),
                 along.z.data(), first, first + run.size(), {point, normal}, slack, excluded,
                 nearest);
  });
  std::size_t best = 0;
  for (std::size_t k = 1; k < kLanes; ++k) {
    if (std::pair(nearest.squared[k], nearest.places[k]) <
        std::pair(nearest.squared[best], nearest.places[best]))
      best = k;
  }
  Match match;
  match.distance = std::sqrt(nearest.squared[best]);
  if (nearest.places[best] != kNowhere) match.index = grid_.order()[nearest.places[best]];
  return match;
}

float SampledSurface::misfit(const Pose& motion, float tolerance, float give_up,
                             std::size_t num_queries) const noexcept {
  const std::size_t n = points_.size();
  const std::size_t step = coprime_step(n);
  num_queries = std::min(num_queries, n);
  Tally own, moved;
  for (std::size_t k = 0, i = 0; k < num_queries; ++k, i = (i + step) % n) {
    own.add(own_distances_[i], tolerance);
  }
  float result = 0;
  for (std::size_t k = 0, i = 0; k < num_queries && result <= give_up; ++k, i = (i + step) % n) {
    moved.add(
        match(motion * points_[i], motion.linear() * normals_[i], slacks_[i], kNowhere).distance,
        tolerance);
    result = moved.misfit(own, num_queries);
  }
  return result;
}

void SampledSurface::mark_matched(const Pose& motion, float distance,
                                  std::span<std::uint8_t> out) const noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Eigen::Vector3f normal = motion.linear() * normals_[i];
    const Match found = match(motion * points_[i], normal, slacks_[i], kNowhere, distance);
    out[i] = found.index != kNone ? 1 : 0;
  }
}

Pose SampledSurface::refine(Pose motion, std::size_t num_queries, int num_steps) const noexcept {
  const std::size_t n = points_.size();
  const std::size_t step = coprime_step(n);
  for (int iteration = 0; iteration < num_steps; ++iteration) {
    // Least squares in (w, t): the distance along h changes by h . (w x q + t). The damping is the
    // weight of one query in a thousand: it holds what the surface leaves free.
    Matrix6d normal_matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (std::size_t k = 0, i = 0; k < std::min(num_queries, n); ++k, i = (i + step) % n) {
      const Eigen::Vector3f q = motion * points_[i];
      const Eigen::Vector3f m = motion.linear() * normals_[i];
      const Match found = match(q, m, slacks_[i], kNowhere);
      if (found.index == kNone) continue;
      const Eigen::Vector3f h = (normals_[found.index] + m).normalized();
      Vector6d row;
      row << q.cross(h).cast<double>(), h.cast<double>();
      normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
      right -= row * static_cast<double>((q - points_[found.index]).dot(h));
    }
    const double damping = 1e-3 * static_cast<double>(num_queries);
    normal_matrix.diagonal().array() += damping;
    normal_matrix.diagonal().head<3>().array() -= 0.9 * damping;
    const Vector6d change = normal_matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    motion = small_motion(change.head<3>().cast<float>(), change.tail<3>().cast<float>(),
                          Eigen::Vector3f::Zero()) *
             motion;
  }
  return motion;
}

Pose SampledSurface::to_model(const Pose& motion) const noexcept {
  Pose result = motion;
  result.translation() =
      center_ + diameter_ * Eigen::Vector3f(motion.translation()) - motion.linear() * center_;
  return result;
}

}  // namespace trivet::kernels
