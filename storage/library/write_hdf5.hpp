/// Representation of values and columns in HDF5, and their writing.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/columns.hpp"
#include "storage/data/model.hpp"
#include "storage/library/hdf5.hpp"
#include "storage/library/library.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet::hdf5 {

// ---- values as attributes

template <class T, std::size_t N>
StoredAttribute attribute(ElementType type, const std::array<T, N>& values) {
  StoredAttribute out{type, {N}, std::vector<std::byte>(sizeof(values))};
  std::memcpy(out.bytes.data(), values.data(), sizeof(values));
  return out;
}

template <class T>
StoredAttribute attribute(ElementType type, T value) {
  StoredAttribute out = attribute(type, std::array{value});
  out.shape.clear();
  return out;
}

StoredAttribute attribute(float value);
StoredAttribute attribute(std::uint32_t value);
StoredAttribute attribute(bool value);
StoredAttribute attribute(const char*) = delete;  // a pointer would become a bool
StoredAttribute attribute(const Eigen::Vector3f& v);
StoredAttribute attribute(std::string_view text);

// ---- columns as bytes

/// Gathers separate columns into the contiguous rows of the file.
template <class T>
Column<std::byte> gather(std::initializer_list<std::span<const T>> rows) {
  Column<std::byte> out;
  for (const auto row : rows) {
    const auto bytes = std::as_bytes(row);
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
  return out;
}
Column<std::byte> gather(PointsView points);
Column<std::byte> gather(const std::vector<Pose>& poses);
Column<std::byte> gather(const std::optional<Symmetry::Axis>& axis);

/// Description of a dataset to be written.
///
/// checksum  checksum of its bytes
/// unit      unit of length
/// stride    stride of codes in the index
StoredDataset describe(const format::DatasetSpec& spec, std::uint64_t num_bytes,
                       std::string_view checksum, std::string_view unit, std::size_t num_components,
                       std::size_t stride);

// ---- to a file; an HDF5 failure gives false or an invalid handle

/// Creation properties that make objects the same bytes in every run.
Handle creation_of(hid_t kind);
Handle create_group(hid_t parent, const std::string& name, const NamesToCome& groups = {});
bool write_attributes(hid_t object, const StoredAttributes& attributes);
/// Records the position of the dataset.
bool write_dataset(hid_t group, const std::string& name, StoredDataset& dataset,
                   std::span<const std::byte> bytes);
/// Create a dataset to be written in blocks; records its position.
Handle create_dataset(hid_t group, const std::string& name, StoredDataset& dataset);
/// Write a block of a dataset: along each dimension, `count` elements from `first` on.
bool write_block(hid_t dataset, ElementType type, std::span<const hsize_t> first,
                 std::span<const hsize_t> count, const void* elements);
/// Replace the value of an attribute by one of the same size.
bool rewrite_attribute(hid_t object, const std::string& name, const StoredAttribute& value);

}  // namespace trivet::hdf5
