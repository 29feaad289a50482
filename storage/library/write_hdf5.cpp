#include "storage/library/write_hdf5.hpp"

#include <algorithm>

namespace trivet::hdf5 {
namespace {

hid_t number_type(ElementType type) {
  switch (type) {
    case ElementType::f32:
      return H5T_IEEE_F32LE;
    case ElementType::u8:
      return H5T_STD_U8LE;
    case ElementType::u16:
      return H5T_STD_U16LE;
    case ElementType::u32:
      return H5T_STD_U32LE;
    case ElementType::u64:
      return H5T_STD_U64LE;
    case ElementType::text:
      return H5T_C_S1;
  }
  return H5I_INVALID_HID;
}

Handle space_of(const std::vector<std::uint64_t>& shape) {
  if (shape.empty()) return Handle(H5Screate(H5S_SCALAR));
  const std::vector<hsize_t> dims(shape.begin(), shape.end());
  return Handle(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr));
}

}  // namespace

StoredAttribute attribute(float value) { return attribute(ElementType::f32, value); }
StoredAttribute attribute(std::uint32_t value) { return attribute(ElementType::u32, value); }
StoredAttribute attribute(bool value) {
  return attribute(ElementType::u8, static_cast<std::uint8_t>(value));
}
StoredAttribute attribute(const Eigen::Vector3f& v) {
  return attribute(ElementType::f32, std::array{v.x(), v.y(), v.z()});
}

// HDF5 has no text of length 0: the empty text is one NUL.
StoredAttribute attribute(std::string_view text) {
  StoredAttribute out{
      ElementType::text, {}, std::vector<std::byte>(std::max<std::size_t>(text.size(), 1))};
  std::ranges::copy(std::as_bytes(std::span(text)), out.bytes.begin());
  return out;
}

Column<std::byte> gather(PointsView points) {
  return gather<float>({points.x, points.y, points.z});
}

Column<std::byte> gather(const std::vector<Pose>& poses) {
  Column<std::byte> out;
  for (const Pose& pose : poses) {
    const Eigen::Matrix<float, 4, 4, Eigen::RowMajor> rows = pose.matrix();
    const auto bytes = std::as_bytes(std::span(rows.data(), 16));
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
  return out;
}

Column<std::byte> gather(const std::optional<Symmetry::Axis>& axis) {
  if (!axis) return {};
  const Eigen::Vector3f direction = axis->direction, point = axis->point;
  return gather<float>({std::span(direction.data(), 3), std::span(point.data(), 3)});
}

StoredDataset describe(const format::DatasetSpec& spec, std::uint64_t num_bytes,
                       std::string_view checksum, std::string_view unit, std::size_t num_components,
                       std::size_t stride) {
  const format::RowSizes sizes{num_components, stride};
  const std::array<std::uint64_t, 3> shape = format::shape_of(spec, sizes);
  StoredDataset out{spec.type, {shape.begin(), shape.begin() + spec.rank}, 0, num_bytes, {}};
  const std::uint64_t num_rows = num_bytes / format::row_bytes(spec, sizes);
  std::ranges::replace(out.shape, format::kRows, num_rows);
  out.attributes.emplace("long_name", attribute(spec.long_name));
  out.attributes.emplace("units", attribute(spec.units.empty() ? unit : spec.units));
  out.attributes.emplace(format::kDataChecksum, attribute(checksum));
  return out;
}

bool write_attributes(hid_t object, const StoredAttributes& attributes) {
  for (const auto& [name, value] : attributes) {
    const Handle type(H5Tcopy(number_type(value.type)));
    if (value.type == ElementType::text && (H5Tset_size(type.get(), value.bytes.size()) < 0 ||
                                            H5Tset_strpad(type.get(), H5T_STR_NULLPAD) < 0 ||
                                            H5Tset_cset(type.get(), H5T_CSET_UTF8) < 0)) {
      return false;
    }
    const Handle space = space_of(value.shape);
    const Handle stored(
        H5Acreate2(object, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
    if (!stored || H5Awrite(stored.get(), type.get(), value.bytes.data()) < 0) return false;
  }
  return true;
}

// No times, and all attributes inside the checksummed object header: the same model gives the same
// bytes.
Handle creation_of(hid_t kind) {
  Handle creation(H5Pcreate(kind));
  const bool ok = H5Pset_obj_track_times(creation.get(), false) >= 0 &&
                  H5Pset_attr_phase_change(creation.get(), 64, 0) >= 0;
  return ok ? std::move(creation) : Handle();
}

// All links also go into the checksummed object header, which may be continued. HDF5 would store
// more than 8 links in the other kind of group, and HDF5 1.10 crashes when it lists a damaged one.
// A header that grows link by link takes more than quadratic time, so its space is reserved.
Handle create_group(hid_t parent, const std::string& name, const NamesToCome& groups) {
  constexpr std::size_t kMostLinks = 65535;
  const auto count = static_cast<unsigned>(std::min(groups.count, kMostLinks));
  const auto length = static_cast<unsigned>(groups.bytes / std::max<std::size_t>(groups.count, 1));
  const Handle creation = creation_of(H5P_GROUP_CREATE);
  if (!creation || H5Pset_link_phase_change(creation.get(), kMostLinks, 0) < 0 ||
      (count > 0 && H5Pset_est_link_info(creation.get(), count, length) < 0)) {
    return {};
  }
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
}

Handle create_dataset(hid_t group, const std::string& name, StoredDataset& dataset) {
  const Handle creation = creation_of(H5P_DATASET_CREATE);
  if (H5Pset_layout(creation.get(), H5D_CONTIGUOUS) < 0 ||
      H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY) < 0 ||
      H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER) < 0) {
    return {};
  }
  const Handle space = space_of(dataset.shape);
  Handle stored(H5Dcreate2(group, name.c_str(), number_type(dataset.type), space.get(), H5P_DEFAULT,
                           creation.get(), H5P_DEFAULT));
  if (!stored || !write_attributes(stored.get(), dataset.attributes)) return {};
  if (dataset.bytes == 0) return stored;
  dataset.offset = H5Dget_offset(stored.get());
  return dataset.offset != HADDR_UNDEF ? std::move(stored) : Handle();
}

bool write_dataset(hid_t group, const std::string& name, StoredDataset& dataset,
                   std::span<const std::byte> bytes) {
  const Handle stored = create_dataset(group, name, dataset);
  if (!stored || bytes.empty()) return static_cast<bool>(stored);
  return H5Dwrite(stored.get(), number_type(dataset.type), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  bytes.data()) >= 0;
}

bool write_block(hid_t dataset, ElementType type, std::span<const hsize_t> first,
                 std::span<const hsize_t> count, const void* elements) {
  const Handle in_file(H5Dget_space(dataset));
  const Handle in_memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  return in_file && in_memory &&
         H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, first.data(), nullptr, count.data(),
                             nullptr) >= 0 &&
         H5Dwrite(dataset, number_type(type), in_memory.get(), in_file.get(), H5P_DEFAULT,
                  elements) >= 0;
}

bool rewrite_attribute(hid_t object, const std::string& name, const StoredAttribute& value) {
  const Handle stored(H5Aopen(object, name.c_str(), H5P_DEFAULT));
  const Handle type(H5Aget_type(stored.get()));
  return stored && type && H5Awrite(stored.get(), type.get(), value.bytes.data()) >= 0;
}

}  // namespace trivet::hdf5
