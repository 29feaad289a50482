#include "kernels/common/pca.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows =
    Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

constexpr Eigen::Index kBlock = 256;  // vectors converted to double at a time

}  // namespace

PcaBasis find_components(std::span<const float> vectors, std::size_t dimension,
                         std::size_t max_components, double energy) {
  TRIVET_REQUIRE(dimension > 0 && !vectors.empty() && vectors.size() % dimension == 0,
                 "whole vectors");
  const auto d = static_cast<Eigen::Index>(dimension);
  const Rows rows(vectors.data(), static_cast<Eigen::Index>(vectors.size() / dimension), d);
  VectorXd mean = VectorXd::Zero(d);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) mean += rows.row(i).transpose().cast<double>();
  mean /= static_cast<double>(rows.rows());
  MatrixXd covariance = MatrixXd::Zero(d, d);
  for (Eigen::Index first = 0; first < rows.rows(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, rows.rows() - first);
    MatrixXd block = rows.middleRows(first, count).cast<double>().transpose();
    block.colwise() -= mean;
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(block);
  }
  covariance /= static_cast<double>(rows.rows());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(covariance);  // ascending

  PcaBasis basis;
  basis.dimension = dimension;
  for (const double value : mean) basis.mean.push_back(static_cast<float>(value));
  basis.all_energy = std::max(0.0, covariance.trace());
  double kept = 0;
  for (Eigen::Index k = d - 1; k >= 0 && basis.size() < max_components; --k) {
    if (basis.size() > 0 && kept >= energy * basis.all_energy) break;
    VectorXd component = solver.eigenvectors().col(k);
    Eigen::Index largest = 0;
    component.cwiseAbs().maxCoeff(&largest);
    if (component[largest] < 0) component = -component;
    for (const double value : component) basis.components.push_back(static_cast<float>(value));
    const double variance = std::max(0.0, solver.eigenvalues()[k]);
    basis.energies.push_back(static_cast<float>(variance));
    kept += variance;
  }
  return basis;
}

}  // namespace trivet::kernels
