/// An HDF5 group that is prepared in memory before it is written.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/columns.hpp"
#include "storage/library/hdf5.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// Datasets with their checksums, in the order of their positions in the file.
class PackedGroup {
 public:
  /// unit            unit of length
  /// num_components  size of the features' basis
  PackedGroup(std::string_view unit, std::size_t num_components)
      : unit_(unit), num_components_(num_components) {}

  void add(const format::DatasetSpec& spec, Column<std::byte> bytes);
  /// bytes  not copied; must live until the group is written
  void add(const format::DatasetSpec& spec, std::span<const std::byte> bytes);

  /// Create the group and write all of it; records the positions of the datasets. Returns an
  /// invalid handle if HDF5 failed.
  hdf5::Handle write(hid_t parent, const std::string& name);

  StoredGroup described;

 private:
  struct Dataset {
    std::string name;
    Column<std::byte> gathered;
    std::span<const std::byte> bytes;
  };
  std::string unit_;
  std::size_t num_components_;
  std::vector<Dataset> datasets_;
};

}  // namespace trivet
