#include "storage/library/packed_group.hpp"

#include <utility>

#include "storage/files/file.hpp"
#include "storage/library/write_hdf5.hpp"

namespace trivet {

void PackedGroup::add(const format::DatasetSpec& spec, Column<std::byte> bytes) {
  add(spec, std::span<const std::byte>(bytes));
  datasets_.back().gathered = std::move(bytes);  // moving does not change their addresses
}

void PackedGroup::add(const format::DatasetSpec& spec, std::span<const std::byte> bytes) {
  std::string name(spec.name);
  described.datasets.emplace(
      name, hdf5::describe(spec, bytes.size(), xxh3_hex(bytes), unit_, num_components_, 0));
  datasets_.push_back({std::move(name), {}, bytes});
}

hdf5::Handle PackedGroup::write(hid_t parent, const std::string& name) {
  hdf5::Handle group = hdf5::create_group(parent, name);
  if (!group || !hdf5::write_attributes(group.get(), described.attributes)) return {};
  for (const Dataset& one : datasets_) {
    if (!hdf5::write_dataset(group.get(), one.name, described.datasets.at(one.name), one.bytes))
      return {};
  }
  return group;
}

}  // namespace trivet
