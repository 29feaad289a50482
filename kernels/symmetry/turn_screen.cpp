#include "kernels/symmetry/turn_screen.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "kernels/symmetry/angles.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr int kNumAxes = 3000;           // on a half sphere: 2.6 degrees apart, none farther than 2
constexpr std::size_t kNumScored = 128;  // number of samples scored
constexpr float kMaxScore = 0.022F;
constexpr float kOneAxis = 0.1F;            // [rad]
constexpr std::size_t kMaxCandidates = 24;  // candidates of one order

constexpr std::size_t kRowLanes = 8;

/// Lower the values of voxels in a row to their distances from a disc; `first` is the vector from
/// the disc's center to the first voxel. Pre: n is a multiple of kRowLanes.
TRIVET_SIMD_CLONES
void mark_row(const Eigen::Vector3f& first, const Eigen::Vector3f& normal, float step, float slack,
              std::size_t n, float* __restrict row) noexcept {
  const float across = first.y() * first.y() + first.z() * first.z();
  const float along = normal.y() * first.y() + normal.z() * first.z();
  const float x0 = first.x(), nx = normal.x();
  for (std::size_t first_lane = 0; first_lane < n; first_lane += kRowLanes) {
    for (std::size_t k = first_lane; k < first_lane + kRowLanes; ++k) {
      const float x = x0 + static_cast<float>(k) * step;
      const float plane = nx * x + along;
      const float lateral = std::sqrt(std::max(0.0F, x * x + across - plane * plane));
      const float excess = std::max(0.0F, lateral - slack);
      row[k] = std::min(row[k], std::sqrt(plane * plane + excess * excess));
    }
  }
}

constexpr std::size_t kBlock = 16;  // points scored at a time

/// The indices of the voxels that contain transformed points; points outside count as at the
/// border.
TRIVET_SIMD_CLONES
void read_field(const float* __restrict field, int size, const Eigen::Matrix3f& turn,
                const Eigen::Vector3f& shift, const PointsView& points,
                float* __restrict out) noexcept {
  const float *const xs = points.x.data(), *const ys = points.y.data(), *const zs = points.z.data();
  const float xx = turn(0, 0), xy = turn(0, 1), xz = turn(0, 2), sx = shift.x();
  const float yx = turn(1, 0), yy = turn(1, 1), yz = turn(1, 2), sy = shift.y();
  const float zx = turn(2, 0), zy = turn(2, 1), zz = turn(2, 2), sz = shift.z();
  const float last = static_cast<float>(size) - 1;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float x = xx * xs[k] + xy * ys[k] + xz * zs[k] + sx;
    const float y = yx * xs[k] + yy * ys[k] + yz * zs[k] + sy;
    const float z = zx * xs[k] + zy * ys[k] + zz * zs[k] + sz;
    const auto i = static_cast<std::int32_t>(std::min(std::max(x, 0.0F), last));
    const auto j = static_cast<std::int32_t>(std::min(std::max(y, 0.0F), last));
    const auto h = static_cast<std::int32_t>(std::min(std::max(z, 0.0F), last));
    out[k] = field[(h * size + j) * size + i];
  }
}

}  // namespace

TurnScreen::TurnScreen(const SampledSurface& surface) : points_(surface.points()) {
  const std::size_t stride = std::max<std::size_t>(1, points_.size() / kNumScored);
  std::vector<Eigen::Vector3f> scored;
  for (std::size_t i = 0; i < points_.size(); i += stride) scored.push_back(points_[i]);
  // Outer points move most, so they show first that a transform does not fit.
  std::ranges::stable_sort(scored, std::ranges::greater(),
                           [](const Eigen::Vector3f& p) { return p.squaredNorm(); });
  for (const Eigen::Vector3f& p : scored) scored_.push_back(p);
  float radius = 1e-3F;  // radius of the cloud; above 0 even if all samples coincide
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3f p = points_[i];
    radius = std::max(radius, p.norm());
    moments += (p * p.transpose()).cast<double>();
  }
  inertia_ = (moments / static_cast<double>(points_.size())).cast<float>();
  scale_ = (0.5F * kSize - 1) / radius;

  // Each sample updates the voxels within the cap of its disc.
  field_.assign(std::size_t{kSize} * kSize * kSize, kCap);
  const NormalsView normals = surface.normals();
  const float slack = surface.slack();
  const int reach = static_cast<int>(std::ceil((kCap + slack) * scale_));
  const float step = 1 / scale_;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3f p = points_[i], n = normals[i];
    const Eigen::Array3i center = (p.array() * scale_ + 0.5F * kSize).floor().cast<int>();
    Eigen::Array3i low = (center - reach).max(0), high = (center + reach).min(kSize - 1);
    // Rows are padded to whole vectors with voxels out of reach.
    const auto width =
        static_cast<std::size_t>(high.x() - low.x()) / kRowLanes * kRowLanes + kRowLanes;
    low.x() = std::min(low.x(), kSize - static_cast<int>(width));
    const auto offset = [&](int voxel, float of_point) {
      return (static_cast<float>(voxel) + 0.5F - 0.5F * kSize) * step - of_point;
    };
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        float* const row = &field_[static_cast<std::size_t>((z * kSize + y) * kSize + low.x())];
        mark_row({offset(low.x(), p.x()), offset(y, p.y()), offset(z, p.z())}, n, step, slack,
                 width, row);
      }
    }
  }
}

float TurnScreen::score(const Pose& motion, float limit) const noexcept {
  return score(scored_, motion, limit);
}

float TurnScreen::score(PointsView points, const Pose& motion, float limit) const noexcept {
  const Eigen::Matrix3f turn = scale_ * motion.linear();
  const Eigen::Vector3f shift =
      scale_ * motion.translation() + Eigen::Vector3f::Constant(0.5F * kSize);
  const float stop = limit * static_cast<float>(points.size());
  std::array<float, kBlock> distances;
  float sum = 0;
  for (std::size_t first = 0; first < points.size() && sum <= stop; first += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - first);
    read_field(field_.data(), kSize, turn, shift, points.slice(first, count), distances.data());
    sum = std::accumulate(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count),
                          sum);
  }
  return sum / static_cast<float>(points.size());
}

Eigen::Matrix3f TurnScreen::principal_axes() const {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(inertia_).eigenvectors();
}

std::vector<TurnScreen::Candidate> TurnScreen::candidates() const {
  const Eigen::Matrix3f principal = principal_axes();
  std::vector<Candidate> result, rated;
  for (const int order : {31, 29, 23, 19, 17, 13, 11, 7, 5, 3, 2}) {
    const float angle = 2 * std::numbers::pi_v<float> / static_cast<float>(order);
    rated.clear();
    const auto rate = [&](const Eigen::Vector3f& direction) {
      const float s = score(Pose(Eigen::AngleAxisf(angle, direction)), kMaxScore);
      if (s <= kMaxScore) rated.push_back({direction, order, s});
    };
    for (int k = 0; k < 3; ++k) rate(principal.col(k));
    for (int k = 0; order <= 5 && k < kNumAxes; ++k) {
      const float z = 1 - (static_cast<float>(k) + 0.5F) / kNumAxes;
      const float r = std::sqrt(1 - z * z), longitude = kGoldenAngle * static_cast<float>(k);
      rate({r * std::cos(longitude), r * std::sin(longitude), z});
    }

    // The best of each bundle of neighboring axes.
    std::stable_sort(rated.begin(), rated.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    const std::size_t first = result.size();
    for (const Candidate& candidate : rated) {
      if (result.size() - first == kMaxCandidates) break;
      const auto same = [&](const Candidate& other) {
        return std::abs(other.direction.dot(candidate.direction)) > std::cos(kOneAxis);
      };
      if (std::none_of(result.begin() + static_cast<std::ptrdiff_t>(first), result.end(), same)) {
        result.push_back(candidate);
      }
    }
  }
  return result;
}

}  // namespace trivet::kernels
