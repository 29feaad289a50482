/// The Tri-Spin-Images of a library's models, made ready to be matched.
#pragma once

#include <cstddef>

#include "kernels/spin_images/code_index.hpp"
#include "storage/common/result.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// The index of a library whose file has none, in memory. Same bytes for any number of threads.
/// Errors: bad_data (damaged).
Result<FeatureIndex> index_features(const Library& library);

/// Add the index over the features of all models that a library is made of, after them: the same
/// bytes for any number of threads and any size of pieces. Takes those of a piece and 4 a feature
/// of a level, whatever the number of models. Errors: of the writer.
Result<void> add_index(LibraryWriter& writer, std::size_t piece_bytes = LibraryWriter::kPieceBytes);

/// As kernels search it.
kernels::CodeIndexView code_index(const FeatureLevel& level) noexcept;

}  // namespace trivet::engine
