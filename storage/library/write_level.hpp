/// Writing of index levels whose features are not in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/library/hdf5.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// Destination of a level.
struct LevelPlace {
  std::filesystem::path file;
  std::size_t num_models = 0;
  std::string_view unit;        ///< unit of length
  std::size_t piece_bytes = 0;  ///< limit on features in memory at a time; at least one feature is
};

/// Write a level into a group of that name below /index.
///
/// stored  receives the positions in the file
/// Errors: io (HDF5 failed; the caller explains it), internal (a level that breaks the format).
Result<void> write_level(const LevelInPieces& level, const std::string& name, hid_t index,
                         const LevelPlace& place, StoredGroup& stored);

}  // namespace trivet
