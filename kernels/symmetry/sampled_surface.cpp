#include "kernels/symmetry/sampled_surface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernels/common/pose_math.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A step through n samples that visits all of them, with neighbors in the list far apart in time,
/// so that an early exit has sampled the whole object.
std::size_t coprime_step(std::size_t n) {
  auto step = static_cast<std::size_t>(0.618 * static_cast<double>(n)) + 1;
  while (std::gcd(step, n) != 1) ++step;
  return step;
}

/// Distances in units of the tolerance: sum of squares, numbers beyond 3 and beyond 6.
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

// Searches extend to kCap and kMaxSlack: runs of this length are fastest.
constexpr float kCell = 0.1F;
constexpr std::size_t kLanes = 16;
constexpr std::uint32_t kNowhere = 0xFFFF'FFFFU;

struct Oriented {
  Eigen::Vector3f point, normal;
};

/// Samples in the grid's order.
struct Columns {
  const float *x, *y, *z, *nx, *ny, *nz;
};

/// Runs of samples, as half-open ranges, that are processed in whole vectors: the entries after a
/// run are samples too.
struct Runs {
  static_assert(2 * (SampledSurface::kCap + SampledSurface::kMaxSlack) < 3 * kCell);
  static constexpr std::size_t kMost = 4 * 4;  // rows of voxels that such a small ball touches
  std::array<std::pair<std::uint32_t, std::uint32_t>, kMost> places;
  std::size_t count = 0;
};

/// Per lane the nearest sample so far: its squared distance and its index.
struct Nearest {
  explicit Nearest(float cap) noexcept {
    squared.fill(cap * cap);
    places.fill(kNowhere);
  }

  alignas(64) std::array<float, kLanes> squared;
  alignas(64) std::array<std::uint32_t, kLanes> places;
};

TRIVET_SIMD_CLONES
void keep_nearest(const Columns& samples, const Runs& runs, const Oriented& query, float slack,
                  std::uint32_t excluded, Nearest& nearest) noexcept {
  const float *const xs = samples.x, *const ys = samples.y, *const zs = samples.z;
  const float *const nxs = samples.nx, *const nys = samples.ny, *const nzs = samples.nz;
  const float qx = query.point.x(), qy = query.point.y(), qz = query.point.z();
  const float mx = query.normal.x(), my = query.normal.y(), mz = query.normal.z();
  Nearest kept = nearest;
  for (std::size_t r = 0; r < runs.count; ++r) {
    for (std::size_t i = runs.places[r].first; i < runs.places[r].second; i += kLanes) {
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
        const bool nearer = (cosine >= SampledSurface::kMinCosine) & (distance < kept.squared[k]) &
                            (place != excluded);
        kept.squared[k] = nearer ? distance : kept.squared[k];
        kept.places[k] = nearer ? place : kept.places[k];
      }
    }
  }
  // Reduce all lanes to the first: the nearest, ties to the first.
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t k = 0; k < width; ++k) {
      const float mine = kept.squared[k], other = kept.squared[k + width];
      const std::uint32_t place = kept.places[k], other_place = kept.places[k + width];
      const bool better = (other < mine) | ((other == mine) & (other_place < place));
      kept.squared[k] = better ? other : mine;
      kept.places[k] = better ? other_place : place;
    }
  }
  nearest = kept;
}

/// Squared distances of a sample from others: per lane from the nearest, and from the nearest two
/// of the same sheet.
struct Gaps {
  explicit Gaps(float cap) noexcept {
    nearest.fill(cap * cap);
    first = second = nearest;
  }

  alignas(64) std::array<float, kLanes> nearest, first, second;
};

TRIVET_SIMD_CLONES
void keep_gaps(const Columns& samples, const Runs& runs, const Oriented& query,
               std::uint32_t excluded, float thickness, Gaps& gaps) noexcept {
  const float *const xs = samples.x, *const ys = samples.y, *const zs = samples.z;
  const float *const nxs = samples.nx, *const nys = samples.ny, *const nzs = samples.nz;
  const float qx = query.point.x(), qy = query.point.y(), qz = query.point.z();
  const float mx = query.normal.x(), my = query.normal.y(), mz = query.normal.z();
  constexpr float kNone = std::numeric_limits<float>::infinity();
  Gaps kept = gaps;
  for (std::size_t r = 0; r < runs.count; ++r) {
    for (std::size_t i = runs.places[r].first; i < runs.places[r].second; i += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const float dx = xs[i + k] - qx, dy = ys[i + k] - qy, dz = zs[i + k] - qz;
        const float nx = nxs[i + k], ny = nys[i + k], nz = nzs[i + k];
        const bool other = static_cast<std::uint32_t>(i + k) != excluded;
        const bool same_sheet = (nx * mx + ny * my + nz * mz >= SampledSurface::kMinCosine) &
                                (std::abs(nx * dx + ny * dy + nz * dz) <= thickness);
        const float squared = other ? dx * dx + dy * dy + dz * dz : kNone;
        const float on_sheet = same_sheet ? squared : kNone;
        kept.nearest[k] = std::min(kept.nearest[k], squared);
        kept.second[k] = std::min(kept.second[k], std::max(kept.first[k], on_sheet));
        kept.first[k] = std::min(kept.first[k], on_sheet);
      }
    }
  }
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t k = 0; k < width; ++k) {
      const float first = kept.first[k], other = kept.first[k + width];
      kept.nearest[k] = std::min(kept.nearest[k], kept.nearest[k + width]);
      kept.second[k] =
          std::min(std::max(first, other), std::min(kept.second[k], kept.second[k + width]));
      kept.first[k] = std::min(first, other);
    }
  }
  gaps = kept;
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

  grid_ = VoxelHash(points_, kCell);
  constexpr float kFar = 1000;  // far from all: fills the last vector's lanes
  for (const std::uint32_t i : grid_.order()) sorted_normals_.push_back(normals_[i]);
  for (std::size_t place = 0; place < used; ++place)
    sorted_points_.push_back(grid_.ordered_points()[place]);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    sorted_points_.push_back(Eigen::Vector3f::Constant(kFar));
    sorted_normals_.push_back(Eigen::Vector3f::Zero());
  }

  constexpr float kThickness = 0.01F;  // thickness of one sheet
  slacks_.resize(used);
  double sum_nearest = 0;
  for (std::uint32_t place = 0; place < used; ++place) {
    const std::uint32_t i = grid_.order()[place];
    Gaps gaps(kMaxSlack);
    visit_runs(points_[i], kMaxSlack, [&](const Columns& samples, const Runs& runs) {
      keep_gaps(samples, runs, {points_[i], normals_[i]}, place, kThickness, gaps);
    });
    sum_nearest += std::sqrt(gaps.nearest[0]);
    slacks_[i] = std::sqrt(gaps.second[0]);
  }
  slack_ = std::min(kMaxSlack, static_cast<float>(2 * sum_nearest / static_cast<double>(used)));
  for (float& slack : slacks_) slack = std::clamp(1.5F * slack, slack_, kMaxSlack);

  own_distances_.resize(used);
  for (std::uint32_t place = 0; place < used; ++place) {
    const std::uint32_t i = grid_.order()[place];
    own_distances_[i] = match(points_[i], normals_[i], slacks_[i], place).distance;
  }
}

template <class Visit>
void SampledSurface::visit_runs(const Eigen::Vector3f& point, float radius,
                                Visit&& visit) const noexcept {
  const PointsView at = sorted_points_;
  const NormalsView along = sorted_normals_;
  const Columns samples{at.x.data(),    at.y.data(),    at.z.data(),
                        along.x.data(), along.y.data(), along.z.data()};
  Runs runs;
  grid_.visit_runs_within(point, radius, [&](PointsView run, const std::uint32_t* indices) {
    assert(runs.count < Runs::kMost && "the ball is larger than any that is asked for");
    const auto first = static_cast<std::uint32_t>(indices - grid_.order().data());
    runs.places[runs.count++] = {first, first + static_cast<std::uint32_t>(run.size())};
  });
  visit(samples, runs);
}

SampledSurface::Match SampledSurface::match(const Eigen::Vector3f& point,
                                            const Eigen::Vector3f& normal, float slack,
                                            std::uint32_t excluded, float cap) const noexcept {
  Nearest nearest(cap);
  visit_runs(point, slack + cap, [&](const Columns& samples, const Runs& runs) {
    keep_nearest(samples, runs, {point, normal}, slack, excluded, nearest);
  });
  Match match;
  match.distance = std::sqrt(nearest.squared[0]);
  if (nearest.places[0] != kNowhere) match.index = grid_.order()[nearest.places[0]];
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
    // Least squares in (w, t): the distance along h changes by h . (w x q + t). The damping has the
    // weight of one query in a thousand: it constrains directions that the surface leaves free.
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
