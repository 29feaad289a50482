/// Change a library as a hostile or careless writer would, with its checksums set right afterwards.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "storage/library/hdf5.hpp"

namespace trivet::test {

/// Open the file for writing, hand its root group to `change`, close it.
void edit_library(const std::filesystem::path& file, const std::function<void(hid_t root)>& change);

/// Replace a dataset's bytes (same number of them) and its checksum.
void replace_data(hid_t root, const std::string& path, std::span<const std::byte> bytes);

/// Replace a dataset by an empty one of this type and shape, made with these creation properties.
void replace_dataset(hid_t root, const std::string& path, hid_t type,
                     std::span<const hsize_t> shape, hid_t creation = H5P_DEFAULT);

/// Replace the value of an attribute; the type in memory is `type`.
void replace_attribute(hid_t root, const std::string& object, const std::string& name, hid_t type,
                       const void* value);

/// Take out the directory and the index, so that the groups of the models are what counts, and make
/// the checksum of the whole right again; the structure must be one that the reader accepts.
void seal_library(const std::filesystem::path& file);

}  // namespace trivet::test
