#include "support/reference_matrices.hpp"

#include <Eigen/Dense>

namespace trivet::reference {

EigenSystem eigen_system(const Eigen::Matrix3d& m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

double least_eigenvalue(const Eigen::Matrix<double, 6, 6>& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(m, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

}  // namespace trivet::reference
