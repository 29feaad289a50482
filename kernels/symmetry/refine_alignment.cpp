#include "kernels/symmetry/refine_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "kernels/common/pose_math.hpp"
#include "kernels/common/voxel_hash.hpp"

namespace trivet::kernels {
namespace {

// A prefix of the samples covers the surface evenly. 200 samples fix six numbers well.
constexpr std::size_t kNumAligned = 200;
constexpr int kAlignSteps = 8;
constexpr float kFirstGate = 0.06F;    // [diameters]
constexpr float kFacingAlike = 0.87F;  // cosine: 30 degrees
// Weight of a sample in a thousand: it holds directions that the surface leaves free.
constexpr double kAlignDamping = 1e-3;

struct Partner {
  Eigen::Vector3f height_axis{0, 0, 0};  ///< mean of both normals, unit
  float height = 0;                      ///< distance along it, signed
  float distance = 0;
};

/// The nearest sample that faces the same way, by the distance along both normals and what the
/// distance along the surface exceeds the spacing by; none beyond `reach`. Ties go to the first.
///
/// places  the surface's points
std::optional<Partner> partner_of(const ModelSamples& surface, const VoxelHash& places,
                                  const Eigen::Vector3f& q, const Eigen::Vector3f& m, float reach) {
  const PointsView p = surface.points;
  const NormalsView n = surface.normals;
  float least = reach * reach;
  std::uint32_t first = 0;
  std::optional<Partner> best;
  places.visit_within(q, reach + 2 * surface.spacing, [&](std::uint32_t k, float squared) {
    const Eigen::Vector3f normal = n[k];
    if (!(normal.dot(m) > kFacingAlike)) return;
    const Eigen::Vector3f axis = (normal + m).normalized();
    const float height = (q - p[k]).dot(axis);
    const float along =
        std::max(std::sqrt(std::max(squared - height * height, 0.0F)) - 2 * surface.spacing, 0.0F);
    const float distance = height * height + along * along;
    if (!(distance < least) && !(best && distance == least && k < first)) return;
    least = distance;
    first = k;
    best = Partner{axis, height, std::sqrt(distance)};
  });
  return best;
}

}  // namespace

RefinedAlignment refine_alignment(const ModelSamples& surface, const ModelSamples& other,
                                  float tolerance, const Pose& start) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  const std::size_t n = std::min(other.points.size(), kNumAligned);
  const float radius = 0.5F * surface.diameter;
  const VoxelHash places(surface.points, tolerance + 2 * surface.spacing);
  RefinedAlignment out{start, 0};
  float gate = std::max(kFirstGate * surface.diameter, tolerance);
  const float shrink = std::pow(tolerance / gate, 1.0F / static_cast<float>(kAlignSteps - 2));
  for (int step = 0; step < kAlignSteps; ++step, gate = std::max(gate * shrink, tolerance)) {
    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    Vector6d gradient = Vector6d::Zero();
    const Eigen::Vector3f pivot = surface.center;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3f q = out.T_this_other * other.points[i];
      const Eigen::Vector3f m = out.T_this_other.linear() * other.normals[i];
      const auto partner = partner_of(surface, places, q, m, gate);
      if (!partner) continue;
      const float part = partner->distance / gate;
      const double weight = std::pow(1 - static_cast<double>(part * part), 2);
      Vector6d row;  // of the turn in lengths at the surface, and of the shift
      row << ((q - pivot).cross(partner->height_axis) / radius).cast<double>(),
          partner->height_axis.cast<double>();
      information.noalias() += weight * row * row.transpose();
      gradient -= weight * static_cast<double>(partner->height) * row;
    }
    information.diagonal().array() += kAlignDamping * static_cast<double>(n);
    const Vector6d change = information.ldlt().solve(gradient);
    out.T_this_other = small_motion((change.head<3>() / static_cast<double>(radius)).cast<float>(),
                                    change.tail<3>().cast<float>(), pivot) *
                       out.T_this_other;
    out.T_this_other.linear() =
        Eigen::Quaternionf(out.T_this_other.linear()).normalized().toRotationMatrix();
  }
  std::size_t agreeing = 0;
  for (std::size_t i = 0; i < n; ++i) {
    agreeing += partner_of(surface, places, out.T_this_other * other.points[i],
                           out.T_this_other.linear() * other.normals[i], tolerance)
                    ? 1
                    : 0;
  }
  if (n > 0) out.agreeing = static_cast<float>(agreeing) / static_cast<float>(n);
  return out;
}

}  // namespace trivet::kernels
