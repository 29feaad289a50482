/// Many queries to an inverted file at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernels/spin_images/code_index.hpp"

namespace trivet::engine {

/// The nearest codes to each query.
struct CodeNeighbors {
  std::size_t per_query = 0;
  std::vector<kernels::CodeNeighbor> all;  ///< per_query of each query, the nearest first

  std::span<const kernels::CodeNeighbor> of(std::size_t query) const {
    return std::span(all).subspan(query * per_query, per_query);
  }
};

/// Compare each query with the codes of its `probes` nearest lists. All queries are known at once,
/// so the index is read list by list, each for all queries that ask for it.
///
/// index       of at least one code
/// queries     n of the index's stride
/// after_part  called after each 64 MiB of codes that were read, by no other thread: where the index
///             is mapped it may let go of their pages
/// Same bytes for any number of threads.
CodeNeighbors search_codes(const kernels::CodeIndexView& index,
                           std::span<const std::uint8_t> queries, std::size_t probes,
                           std::size_t num_neighbors, const std::function<void()>& after_part = {});

}  // namespace trivet::engine
