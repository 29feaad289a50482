/// Changes a library as a hostile or careless writer would, and corrects its checksums afterwards.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "storage/library/hdf5.hpp"

namespace trivet::test {

/// Opens the file for writing, passes its root group to `change`, and closes the file.
void edit_library(const std::filesystem::path& file, const std::function<void(hid_t root)>& change);

/// Replaces a dataset's bytes (same number of them) and its checksum.
void replace_data(hid_t root, const std::string& path, std::span<const std::byte> bytes);

/// Replaces a dataset by an empty one of this type and shape, created with these properties.
void replace_dataset(hid_t root, const std::string& path, hid_t type,
                     std::span<const hsize_t> shape, hid_t creation = H5P_DEFAULT);

/// Replaces the value of an attribute; the type in memory is `type`.
void replace_attribute(hid_t root, const std::string& object, const std::string& name, hid_t type,
                       const void* value);

/// Removes the directory and the index, so that readers use the groups of the models, and corrects
/// the checksum of the whole; the structure must be one that the reader accepts.
void seal_library(const std::filesystem::path& file);

/// Corrects the checksum of the whole where the directory stays, and the models' groups as they were.
void seal_beside_directory(const std::filesystem::path& file);

}  // namespace trivet::test
