/// Items sorted by group.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trivet::engine {

struct ByGroup {
  std::vector<std::uint32_t> offsets;  ///< start of each group, and the end of the last one
  std::vector<std::uint32_t> items;    ///< rising within each group

  std::span<const std::uint32_t> of(std::size_t group) const {
    return std::span(items).subspan(offsets[group], offsets[group + 1] - offsets[group]);
  }
};

/// group_of  group of each item
ByGroup by_group(std::span<const std::uint32_t> group_of, std::size_t num_groups);

}  // namespace trivet::engine
