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

constexpr std::size_t kVectors = 2, kComponents = 4;  // that are taken together
// Components are read again for so many vectors, which meanwhile stay in the first cache.
constexpr std::size_t kVectorsInCache = 8;

using Lanes [[gnu::vector_size(kLanes * sizeof(float))]] = float;
/// The same anywhere in memory.
struct [[gnu::packed, gnu::may_alias]] Loaded {
  Lanes lanes;
};

/// The last numbers of a row, which do not fill all lanes; the others are 0.
struct Rest {
  Rest(const float* row, std::size_t n) noexcept {
    for (std::size_t i = n / kLanes * kLanes; i < n; ++i) numbers[i % kLanes] = row[i];
  }
  const Loaded& loaded() const noexcept { return *reinterpret_cast<const Loaded*>(&numbers); }

  alignas(64) std::array<float, kLanes> numbers{};
};

/// Products of vectors, less the mean, and components: of each pair sixteen partial sums, added up in
/// one order on any processor and in any company.
TRIVET_SIMD_CLONES
void dots_less_mean(const std::array<const float*, kVectors>& vectors, const float* mean,
                    const std::array<const float*, kComponents>& components, std::size_t n,
                    std::array<float, kVectors * kComponents>& out) noexcept {
  const auto* const m = reinterpret_cast<const Loaded*>(mean);
  const auto* const v0 = reinterpret_cast<const Loaded*>(vectors[0]);
  const auto* const v1 = reinterpret_cast<const Loaded*>(vectors[1]);
  alignas(64) Lanes sums[kVectors * kComponents] = {};
  for (std::size_t i = 0; i < n / kLanes; ++i) {
    const Lanes mean_here = m[i].lanes;
    const Lanes less0 = v0[i].lanes - mean_here, less1 = v1[i].lanes - mean_here;
    for (std::size_t c = 0; c < kComponents; ++c) {
      const Lanes component = reinterpret_cast<const Loaded*>(components[c])[i].lanes;
      sums[c] += less0 * component;
      sums[kComponents + c] += less1 * component;
    }
  }
  if (n % kLanes != 0) {
    const Rest mean_here(mean, n), rest0(vectors[0], n), rest1(vectors[1], n);
    const Lanes less0 = rest0.loaded().lanes - mean_here.loaded().lanes;
    const Lanes less1 = rest1.loaded().lanes - mean_here.loaded().lanes;
    for (std::size_t c = 0; c < kComponents; ++c) {
      const Rest component(components[c], n);
      sums[c] += less0 * component.loaded().lanes;
      sums[kComponents + c] += less1 * component.loaded().lanes;
    }
  }
  for (std::size_t pair = 0; pair < out.size(); ++pair) {
    alignas(64) std::array<float, kLanes> lanes;
    __builtin_memcpy(lanes.data(), &sums[pair], sizeof(lanes));
    for (std::size_t k = 0; k < 8; ++k) lanes[k] += lanes[k + 8];
    for (std::size_t k = 0; k < 4; ++k) lanes[k] += lanes[k + 4];
    out[pair] = (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
  }
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
  const std::size_t d = basis.dimension, k = basis.size(), n = vectors.size() / d;
  assert(vectors.size() * k == out.size() * d);
  std::array<const float*, kVectors> some{};
  std::array<const float*, kComponents> components{};
  std::array<float, kVectors * kComponents> dots{};
  for (std::size_t first = 0; first < n; first += kVectorsInCache) {
    const std::size_t last = std::min(n, first + kVectorsInCache);
    for (std::size_t j = 0; j < k; j += kComponents) {
      for (std::size_t c = 0; c < kComponents; ++c)  // the last one again where there are no more
        components[c] = basis.components.data() + std::min(j + c, k - 1) * d;
      for (std::size_t i = first; i < last; i += kVectors) {
        for (std::size_t v = 0; v < kVectors; ++v)
          some[v] = vectors.data() + std::min(i + v, n - 1) * d;
        dots_less_mean(some, basis.mean.data(), components, d, dots);
        for (std::size_t v = 0; v < kVectors && i + v < last; ++v) {
          for (std::size_t c = 0; c < kComponents && j + c < k; ++c)
            out[(i + v) * k + j + c] = dots[v * kComponents + c];
        }
      }
    }
  }
}

}  // namespace trivet::kernels
