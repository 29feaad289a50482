/// Values and columns as HDF5 stores them, and their writing.
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

#include "storage/columns.hpp"
#include "storage/library/hdf5.hpp"
#include "storage/library/stored_tree.hpp"
#include "storage/model.hpp"

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
StoredAttribute attribute(const Eigen::Vector3f& v);
StoredAttribute attribute(std::string_view text);

// ---- columns as bytes

/// Rows that lie apart in memory, gathered as they lie in the file.
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

// ---- to a file; false, or no handle, when HDF5 failed

/// Properties for creating objects that are the same bytes whenever they are written.
Handle creation_of(hid_t kind);
Handle create_group(hid_t parent, const std::string& name);
bool write_attributes(hid_t object, const StoredAttributes& attributes);
/// Takes up where the dataset lies.
bool write_dataset(hid_t group, const std::string& name, StoredDataset& dataset,
                   std::span<const std::byte> bytes);

}  // namespace trivet::hdf5
