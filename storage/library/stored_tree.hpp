/// Contents of an HDF5 file as plain data: names, types, shapes, positions and attributes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/columns.hpp"
#include "storage/common/result.hpp"

namespace trivet {

enum class ElementType : std::uint8_t { f32, u8, u16, u32, u64, text };

/// Bytes of one element; 1 for text, whose length is that of the attribute.
std::size_t size_of(ElementType type) noexcept;
const char* name_of(ElementType type) noexcept;

struct StoredAttribute {
  ElementType type = ElementType::text;
  std::vector<std::uint64_t> shape;  ///< empty: a single value
  std::vector<std::byte> bytes;      ///< little-endian, row-major
};
using StoredAttributes = std::map<std::string, StoredAttribute>;

struct StoredDataset {
  ElementType type = ElementType::f32;
  std::vector<std::uint64_t> shape;
  std::uint64_t offset = 0;  ///< offset from the beginning of the file
  std::uint64_t bytes = 0;   ///< product of the shape and the size of an element
  StoredAttributes attributes;
};

struct StoredGroup {
  StoredAttributes attributes;
  std::map<std::string, StoredDataset> datasets;
  std::map<std::string, StoredGroup> groups;
};

/// Read the structure of a library's HDF5 file. No dataset is read, and HDF5 is closed on return.
///
/// Accepted are hard links, each to a separate object; contiguous unfiltered datasets inside the
/// file; and little-endian numbers and texts of fixed length. All else is refused. So is a file
/// whose root does not have the text attribute `format` with this value and this major version.
/// file_bytes   size of the file: bounds every extent and the sum of all datasets
/// left_out     a group of the root that is not traversed: it is returned empty
/// Errors: bad_data (names the object), io.
Result<StoredGroup> read_stored_tree(const std::filesystem::path& file, std::uint64_t file_bytes,
                                     std::string_view left_out = {});

/// A library's structure, and all its data as decompressed by HDF5.
struct UnpackedTree {
  StoredGroup root;         ///< offsets of datasets count from the beginning of `bytes`
  Column<std::byte> bytes;  ///< each dataset is aligned to 64 bytes
};

/// Read a file that another program has rewritten, with any superblock, chunks, and HDF5's built-in
/// filters. Otherwise as read_stored_tree, except that datasets may be larger than the file, up to
/// the largest compression ratio of their filters.
/// Errors: bad_data (names the object), io (no memory).
Result<UnpackedTree> read_unpacked_tree(const std::filesystem::path& file,
                                        std::uint64_t file_bytes);

}  // namespace trivet
