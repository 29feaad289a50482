#include "engine/libraries/code_source.hpp"

#include <algorithm>

#include "engine/common/parallel.hpp"
#include "storage/common/columns.hpp"

namespace trivet::engine {

CodeSource source_of(std::span<const std::uint8_t> codes, std::size_t stride) {
  return {codes.size() / stride, stride,
          [codes, stride](std::size_t first, std::span<std::uint8_t> some) {
            std::ranges::copy(codes.subspan(first * stride, some.size()), some.begin());
          }};
}

void for_blocks(
    const CodeSource& codes, std::size_t at_once,
    const std::function<void(std::size_t first, std::span<const std::uint8_t> block)>& body) {
  PerThread<Column<std::uint8_t>> blocks(
      [&] { return Column<std::uint8_t>(std::min(at_once, codes.size) * codes.stride); });
  for_each_index((codes.size + at_once - 1) / at_once, [&](std::size_t b) {
    const std::size_t first = b * at_once, count = std::min(at_once, codes.size - first);
    const auto block = std::span(blocks.local()).first(count * codes.stride);
    codes.read(first, block);
    body(first, block);
  });
}

}  // namespace trivet::engine
