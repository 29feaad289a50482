#include "kernels/symmetry/turn_screen.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trivet::kernels {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kNumAxes = 3000;           // on a half sphere: 2.6 degrees apart, none farther than 2
constexpr std::size_t kNumScored = 128;  // samples that are looked up
constexpr float kMaxScore = 0.022F;
constexpr float kSameAxis = 0.1F;           // [rad]
constexpr std::size_t kMaxCandidates = 24;  // of one order

}  // namespace

TurnScreen::TurnScreen(const SampledSurface& surface) : points_(surface.points()) {
  const std::size_t stride = std::max<std::size_t>(1, points_.size() / kNumScored);
  for (std::size_t i = 0; i < points_.size(); i += stride) scored_.push_back(points_[i]);
  float radius = 1e-3F;  // of the cloud; above 0 for samples that are all one place
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3f p = points_[i];
    radius = std::max(radius, p.norm());
    moments += (p * p.transpose()).cast<double>();
  }
  inertia_ = (moments / static_cast<double>(points_.size())).cast<float>();
  scale_ = (0.5F * kSize - 1) / radius;

  // Each sample marks the voxels within the cap of its disc.
  field_.assign(std::size_t{kSize} * kSize * kSize, kCap);
  const NormalsView normals = surface.normals();
  const float slack = surface.slack();
  const int reach = static_cast<int>(std::ceil((kCap + slack) * scale_));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3f p = points_[i], n = normals[i];
    const Eigen::Array3i center = (p.array() * scale_ + 0.5F * kSize).floor().cast<int>();
    const Eigen::Array3i low = (center - reach).max(0), high = (center + reach).min(kSize - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        float* row = &field_[static_cast<std::size_t>((z * kSize + y) * kSize)];
        for (int x = low.x(); x <= high.x(); ++x) {
          const Eigen::Vector3f voxel =
              (Eigen::Vector3f(float(x), float(y), float(z)).array() + 0.5F - 0.5F * kSize) /
              scale_;
          const Eigen::Vector3f d = voxel - p;
          const float plane = n.dot(d);
          const float excess =
              std::max(0.0F, std::sqrt(std::max(0.0F, d.squaredNorm() - plane * plane)) - slack);
          row[x] = std::min(row[x], std::sqrt(plane * plane + excess * excess));
        }
      }
    }
  }
}

float TurnScreen::score(const Pose& motion, float limit) const noexcept {
  return score(scored_, motion, limit);
}

float TurnScreen::score(PointsView points, const Pose& motion, float limit) const noexcept {
  const float stop = limit * static_cast<float>(points.size());
  float sum = 0;
  for (std::size_t i = 0; i < points.size() && sum <= stop; ++i) {
    const Eigen::Array3i voxel = ((motion * points[i]).array() * scale_ + 0.5F * kSize)
                                     .max(0.0F)
                                     .min(kSize - 1.0F)
                                     .cast<int>();
    sum += field_[static_cast<std::size_t>((voxel.z() * kSize + voxel.y()) * kSize + voxel.x())];
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
    const float angle = 2 * kPi / static_cast<float>(order);
    rated.clear();
    const auto rate = [&](const Eigen::Vector3f& direction) {
      const float s = score(Pose(Eigen::AngleAxisf(angle, direction)), kMaxScore);
      if (s <= kMaxScore) rated.push_back({direction, order, s});
    };
    for (int k = 0; k < 3; ++k) rate(principal.col(k));
    for (int k = 0; order <= 5 && k < kNumAxes; ++k) {
      const float z = 1 - (static_cast<float>(k) + 0.5F) / kNumAxes;
      const float r = std::sqrt(1 - z * z), longitude = 2.3999632F * static_cast<float>(k);
      rate({r * std::cos(longitude), r * std::sin(longitude), z});
    }

    // The best of each bundle of neighboring axes.
    std::stable_sort(rated.begin(), rated.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    const std::size_t first = result.size();
    for (const Candidate& candidate : rated) {
      if (result.size() - first == kMaxCandidates) break;
      const auto same = [&](const Candidate& other) {
        return std::abs(other.direction.dot(candidate.direction)) > std::cos(kSameAxis);
      };
      if (std::none_of(result.begin() + static_cast<std::ptrdiff_t>(first), result.end(), same)) {
        result.push_back(candidate);
      }
    }
  }
  return result;
}

}  // namespace trivet::kernels
