/// Slow reference implementation of point pair features: in double precision, written from the
/// definitions, without code of the kernels.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "storage/data/model.hpp"
#include "storage/data/ppf_table.hpp"
#include "support/random.hpp"
#include "support/reference_matrices.hpp"

namespace trivet::reference {

inline constexpr double kPi = std::numbers::pi;

/// Angle between two vectors by Kahan's formula, accurate to the last digits everywhere; 0 if one
/// is 0.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  if (a.norm() == 0 || b.norm() == 0) return 0;
  const Eigen::Vector3d u = a.normalized(), v = b.normalized();
  return 2 * std::atan2((u - v).norm(), (u + v).norm());
}

/// The feature of Drost et al., CVPR 2010, eq. (1), and the rotation about +x that moves the second
/// point into the half plane y >= 0, z = 0 of the reference point's frame, in [-pi, pi].
struct PairFeature {
  double distance, angle_n1_d, angle_n2_d, angle_n1_n2, rotation;
};

inline PairFeature pair_feature(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1,
                                const Eigen::Vector3f& p2, const Eigen::Vector3f& n2,
                                const Pose& T_frame_model) {
  const Eigen::Vector3d d = p2.cast<double>() - p1.cast<double>();
  const Eigen::Vector3d m1 = n1.cast<double>(), m2 = n2.cast<double>();
  const Eigen::Vector3d local = T_frame_model.linear().cast<double>() * d;
  return {d.norm(), angle_between(m1, d), angle_between(m2, d), angle_between(m1, m2),
          -std::atan2(local.z(), local.y())};
}

/// The bin of a component, and the position of the value inside the bin, as a fraction.
struct Bin {
  std::int64_t index;
  double fraction;
};

inline Bin bin_of(double value, double width) {
  const double position = value / width;
  return {static_cast<std::int64_t>(std::floor(position)), position - std::floor(position)};
}

/// The bins of the four components of a feature; an angle of exactly pi is in the last bin.
inline std::array<Bin, 4> bins_of(const PairFeature& f, const PpfQuantization& q) {
  const auto angle = [&](double value) {
    const Bin bin = bin_of(value, kPi / q.num_angle_bins);
    return bin.index == q.num_angle_bins ? Bin{bin.index - 1, 1} : bin;
  };
  return {bin_of(f.distance, static_cast<double>(q.distance_step)), angle(f.angle_n1_d),
          angle(f.angle_n2_d), angle(f.angle_n1_n2)};
}

/// The cell of four bins; none beyond the last distance bin.
inline std::optional<std::uint32_t> cell_of_bins(const std::array<std::int64_t, 4>& bin,
                                                 const PpfQuantization& q) {
  if (bin[0] >= q.num_distance_bins) return std::nullopt;
  std::int64_t cell = 0;
  for (std::size_t k = 0; k < 4; ++k) cell = (k > 0 ? cell * q.num_angle_bins : 0) + bin[k];
  return static_cast<std::uint32_t>(cell);
}

inline std::optional<std::uint32_t> cell_of(const PairFeature& f, const PpfQuantization& q) {
  if (f.distance == 0) return std::nullopt;
  const auto bins = bins_of(f, q);
  return cell_of_bins({bins[0].index, bins[1].index, bins[2].index, bins[3].index}, q);
}

/// Whether a component is so near a border (`edges`: fractions of a bin) that the result depends on
/// rounding.
inline bool near_border(const PairFeature& f, const PpfQuantization& q,
                        std::initializer_list<double> edges = {0, 1}) {
  for (const Bin& bin : bins_of(f, q)) {
    for (const double edge : edges) {
      if (std::abs(bin.fraction - edge) < 1e-4) return true;
    }
  }
  return false;
}

/// An angle in units of a 2^16th of a turn, not rounded, in [0, 65536).
inline double turn_units(double angle) {
  const double units = angle / (2 * kPi) * 65536;
  return units - 65536 * std::floor(units / 65536);
}

/// The shorter distance between two angles in these units.
inline double units_between(double a, double b) {
  const double d = std::abs(a - b);
  return std::min(d, 65536 - d);
}

/// The rotation that minimizes sum w |R - R_i|^2 in the Frobenius norm: by singular values, which
/// is equivalent to the definition of the mean quaternion.
inline Eigen::Matrix3d mean_rotation(const std::vector<Eigen::Matrix3d>& rotations,
                                     const std::vector<double>& weights) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rotations.size(); ++i) sum += weights[i] * rotations[i];
  return nearest_rotation(sum);
}

inline double rotation_angle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return std::abs(Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle());
}
inline double rotation_angle(const Pose& a, const Pose& b) {
  return rotation_angle(Eigen::Matrix3d(a.linear().cast<double>()),
                        Eigen::Matrix3d(b.linear().cast<double>()));
}

}  // namespace trivet::reference

namespace trivet::test {

/// Points with independent unit normals: no two pairs have similar features.
struct OrientedCloud {
  Points points;
  Normals normals;
};

inline OrientedCloud random_oriented(Random& random, std::size_t n, float extent = 1) {
  OrientedCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    cloud.points.push_back({random.uniform(-extent, extent), random.uniform(-extent, extent),
                            random.uniform(-extent, extent)});
    cloud.normals.push_back(random.direction());
  }
  return cloud;
}

inline OrientedCloud moved(const OrientedCloud& cloud, const Pose& T) {
  const Eigen::Matrix3f R = T.linear();
  return {transformed(cloud.points, R, T.translation()),
          transformed(cloud.normals, R, Eigen::Vector3f::Zero())};
}

/// The rotation by an angle about an axis through a point, as a pose.
inline Pose turn_about(const Eigen::Vector3f& axis, float angle, const Eigen::Vector3f& point) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisf(angle, axis).toRotationMatrix();
  T.translation() = point - T.linear() * point;
  return T;
}

/// The n - 1 rotations of an n-fold axis.
inline std::vector<Pose> turns(int n, const Eigen::Vector3f& axis, const Eigen::Vector3f& point) {
  std::vector<Pose> poses;
  for (int k = 1; k < n; ++k) {
    poses.push_back(turn_about(axis, static_cast<float>(2 * reference::kPi * k / n), point));
  }
  return poses;
}

}  // namespace trivet::test
