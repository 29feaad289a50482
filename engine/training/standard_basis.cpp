#include "engine/training/standard_basis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "kernels/spin_images/tri_spin_image.hpp"

namespace trivet::engine {

/// standard_basis.bin, embedded in the program by the build.
std::span<const std::pair<std::string_view, std::string_view>> embedded_basis();

namespace {

static_assert(std::endian::native == std::endian::little);

struct Head {
  float support = 0, code_step = 0, all_energy = 0;
  std::uint32_t num_components = 0;
};

/// The number of first components that together keep the share of the variance, up to the limit.
std::size_t num_wanted(const PcaBasis& all, const TrainOptions& options) {
  const std::size_t most = std::min<std::size_t>(all.size(), options.num_components);
  double kept = 0;
  std::size_t n = 0;
  while (n < most &&
         (n == 0 || kept < static_cast<double>(options.component_energy) * all.all_energy))
    kept += static_cast<double>(all.energies[n++]);
  return n;
}

}  // namespace

TriSpinBasis standard_basis(const TrainOptions& options) {
  static const TriSpinBasis kAll = *parse_basis(embedded_basis().front().second);
  TriSpinBasis basis;
  if (!options.tri_spin_images) return basis;
  basis = kAll;
  PcaBasis& pca = basis.components;
  const std::size_t n = num_wanted(pca, options);
  pca.energies.resize(n);
  pca.components.resize(n * pca.dimension);
  return basis;
}

std::string basis_bytes(const TriSpinBasis& basis) {
  const PcaBasis& pca = basis.components;
  const Head head{basis.support, basis.code_step, static_cast<float>(pca.all_energy),
                  static_cast<std::uint32_t>(pca.size())};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof(head));
  for (const Column<float>* const column : {&pca.mean, &pca.energies, &pca.components})
    bytes.append(reinterpret_cast<const char*>(column->data()), column->size() * sizeof(float));
  return bytes;
}

Result<TriSpinBasis> parse_basis(std::string_view bytes) {
  Head head;
  if (bytes.size() >= sizeof(head)) std::memcpy(&head, bytes.data(), sizeof(head));
  const std::size_t n = head.num_components, dimension = kernels::kTriSpinSize;
  const std::size_t expected = sizeof(head) + (dimension + n + n * dimension) * sizeof(float);
  if (n == 0 || n > dimension || bytes.size() != expected) {
    return Error{ErrorCode::bad_data,
                 fmt::format("expected {} bytes of a basis of {} components, found {}", expected, n,
                             bytes.size())};
  }
  TriSpinBasis basis{head.support, {}, head.code_step};
  PcaBasis& pca = basis.components;
  pca.dimension = dimension;
  pca.all_energy = static_cast<double>(head.all_energy);
  const char* from = bytes.data() + sizeof(head);
  for (const auto& [column, size] : {std::pair(&pca.mean, dimension), std::pair(&pca.energies, n),
                                     std::pair(&pca.components, n * dimension)}) {
    column->resize(size);
    std::memcpy(column->data(), from, size * sizeof(float));
    from += size * sizeof(float);
  }
  return basis;
}

}  // namespace trivet::engine
