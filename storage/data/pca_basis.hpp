/// A basis of principal components.
#pragma once

#include <cstddef>

#include "storage/common/columns.hpp"

namespace trivet {

/// Principal components that reduce vectors of `dimension` numbers to fewer.
struct PcaBasis {
  std::size_t dimension = 0;
  Column<float> mean;        ///< mean vector, `dimension` numbers
  Column<float> components;  ///< orthogonal unit vectors, concatenated, by descending energy
  Column<float> energies;    ///< variance along each component
  double all_energy = 0;     ///< total variance along all directions

  std::size_t size() const noexcept { return energies.size(); }
};

}  // namespace trivet
