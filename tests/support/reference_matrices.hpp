/// Decompositions of small matrices by Eigen, compiled once: their templates cost seconds each.
#pragma once

#include <Eigen/Core>

namespace trivet::reference {

struct EigenSystem {
  Eigen::Vector3d values;   ///< ascending
  Eigen::Matrix3d vectors;  ///< unit columns
};

/// The eigenvalues and eigenvectors of a symmetric matrix.
EigenSystem eigen_system(const Eigen::Matrix3d& m);
double least_eigenvalue(const Eigen::Matrix<double, 6, 6>& m);
/// The nearest rotation in the Frobenius norm, by singular values.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m);

}  // namespace trivet::reference
