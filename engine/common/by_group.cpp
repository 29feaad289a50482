#include "engine/common/by_group.hpp"

#include "engine/common/parallel.hpp"

namespace trivet::engine {

ByGroup by_group(std::span<const std::uint32_t> group_of, std::size_t num_groups) {
  ByGroup out;
  out.offsets.assign(num_groups + 1, 0);
  for (const std::uint32_t group : group_of) ++out.offsets[group];
  (void)counts_to_offsets(out.offsets);
  out.items.resize(group_of.size());
  std::vector<std::uint32_t> next(out.offsets.begin(), out.offsets.end() - 1);
  for (std::uint32_t item = 0; item < group_of.size(); ++item)
    out.items[next[group_of[item]]++] = item;
  return out;
}

}  // namespace trivet::engine
