#include "kernels/common/pca.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cassert>

#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows =
    Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

constexpr Eigen::Index kBlock = 256;  // vectors that are widened to double at a time
constexpr std::size_t kLanes = 16;

/// Sixteen partial sums, added up in one order on any processor.
TRIVET_SIMD_CLONES
float dot_less_mean(const float* __restrict vector, const float* __restrict mean,
                    const float* __restrict component, std::size_t n) noexcept {
  alignas(64) std::array<float, kLanes> sums{};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k)
      sums[k] += (vector[i + k] - mean[i + k]) * component[i + k];
  }
  for (std::size_t k = 0; i + k < n; ++k)
    sums[k] += (vector[i + k] - mean[i + k]) * component[i + k];
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) sums[k] += sums[k + half];
  }
  return sums[0];
}

}  // namespace

PcaBasis find_components(std::span<const float> vectors, std::size_t dimension,
                         std::size_t max_components, double energy) {
  assert(dimension > 0 && !vectors.empty() && vectors.size() % dimension == 0);
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
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(covariance);  // rising

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

void project(const PcaBasis& basis, std::span<const float> vectors, std::span<float> out) noexcept {
  const std::size_t d = basis.dimension, k = basis.size();
  assert(vectors.size() * k == out.size() * d);
  for (std::size_t i = 0; i * d < vectors.size(); ++i) {
    for (std::size_t c = 0; c < k; ++c) {
      out[i * k + c] = dot_less_mean(vectors.data() + i * d, basis.mean.data(),
                                     basis.components.data() + c * d, d);
    }
  }
}

}  // namespace trivet::kernels
