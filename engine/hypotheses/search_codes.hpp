/// Batched search of an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernels/spin_images/code_index.hpp"

namespace trivet::engine {

/// Nearest codes of each query.
struct CodeNeighbors {
  std::size_t per_query = 0;
  std::vector<kernels::CodeNeighbor> all;  ///< per_query per query, the nearest first

  std::span<const kernels::CodeNeighbor> of(std::size_t query) const {
    return std::span(all).subspan(query * per_query, per_query);
  }
};

/// Compare each query with the codes of its `probes` nearest lists. Since all queries are known at
/// once, the index is read list by list, each list once for all queries that need it.
///
/// index       contains at least one code
/// queries     n vectors of the index's stride
/// after_part  called after each 64 MiB of codes read, by one thread at a time; if the index is a
///             mapped file, the caller may release its pages there
/// Same bytes for any number of threads.
CodeNeighbors search_codes(const kernels::CodeIndexView& index,
                           std::span<const std::uint8_t> queries, std::size_t probes,
                           std::size_t num_neighbors, const std::function<void()>& after_part = {});

}  // namespace trivet::engine
