#include "storage/library/group_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace trivet {

std::string wrong_checksum(const Xxh3& expected, const Xxh3& found) {
  return fmt::format(
      "expected checksum {}, found {}: the data is damaged; copy the library again or train it "
      "anew",
      expected.hex(), found.hex());
}

void GroupReader::refuse(const std::string& place, const std::string& what) {
  if (!fault_)
    fault_ = Error{ErrorCode::bad_data, fmt::format("{}: {}: {}", file_.string(), place, what)};
}

void GroupReader::refuse(const Error& error) {
  if (!fault_) fault_ = Error{error.code, fmt::format("{}: {}", file_.string(), error.message)};
}

void GroupReader::refuse_size(const std::string& place, std::size_t expected, std::size_t bytes) {
  refuse(place, fmt::format("expected {} numbers, found {} bytes", expected, bytes));
}

std::string GroupReader::text(const StoredAttributes& from, const std::string& name,
                              const std::string& path) {
  const StoredAttribute* found = find(from, name, ElementType::text, path);
  if (found == nullptr) return {};
  std::string out(reinterpret_cast<const char*>(found->bytes.data()), found->bytes.size());
  out.resize(std::min(out.size(), out.find('\0')));
  return out;
}

const StoredAttribute* GroupReader::find(const StoredAttributes& from, const std::string& name,
                                         ElementType type, const std::string& path) {
  const auto found = from.find(name);
  if (found != from.end() && found->second.type == type) return &found->second;
  refuse(path + "@" + name,
         fmt::format("expected an attribute of type {}, found {}", name_of(type),
                     found == from.end() ? "none" : name_of(found->second.type)));
  return nullptr;
}

std::optional<StoredColumn> GroupReader::column(const StoredGroup& group,
                                                const format::DatasetSpec& spec,
                                                const std::string& path,
                                                const format::RowSizes& sizes) {
  if (spec.since > minor_) return std::nullopt;
  const std::string place = path + "/" + std::string(spec.name);
  const auto found = group.datasets.find(std::string(spec.name));
  if (found == group.datasets.end()) {
    refuse(place, "expected this dataset, found none");
    return std::nullopt;
  }
  const StoredDataset& dataset = found->second;
  const std::array<std::uint64_t, 3> expected_shape = format::shape_of(spec, sizes);
  bool fits = dataset.type == spec.type && dataset.shape.size() == spec.rank;
  for (std::size_t i = 0; fits && i < spec.rank; ++i)
    fits = spec.shape[i] == format::kRows || expected_shape[i] == dataset.shape[i];
  if (!fits) {
    const auto expected = std::span(expected_shape).first(spec.rank);
    refuse(place,
           fmt::format("expected {} of shape ({}) with 0 for any number, found {} of shape ({})",
                       name_of(spec.type), fmt::join(expected, ", "), name_of(dataset.type),
                       fmt::join(dataset.shape, ", ")));
    return std::nullopt;
  }
  const std::string sum = text(dataset.attributes, std::string(format::kDataChecksum), place);
  const std::optional<Xxh3> checksum = Xxh3::parse(sum);
  if (!checksum) {
    refuse(place + "@" + std::string(format::kDataChecksum),
           fmt::format("expected 32 hexadecimal digits, found '{}'", sum));
    return std::nullopt;
  }
  return StoredColumn{dataset.offset, dataset.bytes, *checksum};
}

std::span<const std::byte> GroupReader::data(const StoredGroup& group,
                                             const format::DatasetSpec& spec,
                                             const std::string& path) {
  const std::optional<StoredColumn> found = column(group, spec, path);
  if (!found) return {};
  const auto bytes = bytes_.subspan(found->offset, found->bytes);
  if (const Xxh3 sum = xxh3(bytes); sum != found->checksum) {
    refuse(path + "/" + std::string(spec.name), wrong_checksum(found->checksum, sum));
    return {};
  }
  return bytes;
}

void GroupReader::expect_only(const StoredGroup& group, std::string_view spec_group,
                              std::initializer_list<std::string_view> below,
                              const std::string& path) {
  if (minor_ > kLibraryVersionMinor) return;
  for (const auto& entry : group.datasets) {
    const std::string& name = entry.first;
    const bool known = std::ranges::any_of(format::kDatasets, [&](const format::DatasetSpec& spec) {
      return spec.group == spec_group && spec.name == name && spec.since <= minor_;
    });
    if (!known) refuse(path + "/" + name, "the format has no such dataset");
  }
  for (const auto& [name, child] : group.groups) {
    const bool newer =
        (name == "trisi" && minor_ < format::kFeatures.since) ||
        ((name == "directory" || name == "index" || name == "trisi_2x" || name == "trisi_4x") &&
         minor_ < format::kDirectorySince);
    if (newer || std::ranges::find(below, name) == below.end())
      refuse(path + "/" + name, "the format has no such group");
  }
}

}  // namespace trivet
