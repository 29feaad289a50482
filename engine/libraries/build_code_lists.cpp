#include "engine/libraries/build_code_lists.hpp"

#include <algorithm>

#include "engine/common/parallel.hpp"
#include "engine/libraries/centroids.hpp"

namespace trivet::engine {

CodeLists build_code_lists(const CodeSource& codes) {
  constexpr std::size_t kListLength = 2000;  // average number of codes per list
  CodeLists lists;
  const std::size_t num_lists = std::max<std::size_t>(1, codes.size / kListLength);
  lists.centroids = find_centroids(codes, num_lists);
  lists.list.resize(codes.size);
  const CentroidFinder finder(lists.centroids, codes.stride);
  for_blocks(codes, finder.at_once(), [&](std::size_t first, std::span<const std::uint8_t> block) {
    finder.find(block, std::span(lists.list).subspan(first, block.size() / codes.stride));
  });
  lists.offsets.assign(num_lists + 1, 0);
  for (const std::uint32_t l : lists.list) ++lists.offsets[l];
  (void)counts_to_offsets(lists.offsets);
  return lists;
}

CodeLists build_code_lists(std::span<const std::uint8_t> codes, std::size_t stride) {
  return build_code_lists(source_of(codes, stride));
}

}  // namespace trivet::engine
