/// A basis of principal components.
#pragma once

#include <cstddef>

#include "storage/common/columns.hpp"

namespace trivet {

/// The directions of largest spread, which take vectors of `dimension` numbers to fewer.
struct PcaBasis {
  std::size_t dimension = 0;
  Column<float> mean;        ///< dimension numbers
  Column<float> components;  ///< unit vectors one after the other, by falling energy, orthogonal
  Column<float> energies;    ///< variance along each
  double all_energy = 0;     ///< the variance along all directions together

  std::size_t size() const noexcept { return energies.size(); }
};

}  // namespace trivet
