/// Index of a library's Tri-Spin-Images for matching.
#pragma once

#include <cstddef>

#include "kernels/spin_images/code_index.hpp"
#include "storage/common/result.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Build the index of a library whose file has none, in memory. Same bytes for any number of
/// threads. Errors: damaged.
Result<FeatureIndex> index_features(const Library& library);

/// Append the index of all models' features to a library. Same bytes for any number of threads and
/// any size of pieces. Uses the memory of one piece and 4 bytes per feature of a level, regardless
/// of the number of models. Errors: those of the writer.
Result<void> add_index(LibraryWriter& writer, std::size_t piece_bytes = LibraryWriter::kPieceBytes);

/// The codes of a level in the form that kernels search.
kernels::CodeIndexView code_index(const FeatureLevel& level) noexcept;

}  // namespace trivet::engine
