#include "storage/library/library_format.hpp"

#include <algorithm>
#include <span>

#include "storage/files/file.hpp"

namespace trivet::format {
namespace {

/// The canonical byte string of docs/format.md, "The checksum of the whole": name, NUL, length,
/// bytes.
class Canonical {
 public:
  void add(std::string_view name, std::span<const std::byte> bytes) {
    text_.append(name).push_back('\0');
    const std::uint64_t length = bytes.size();
    append(std::as_bytes(std::span(&length, 1)));
    append(bytes);
  }
  void add(const StoredAttributes& attributes) {
    for (const auto& [name, attribute] : attributes) {
      if (name != kChecksum) add(name, attribute.bytes);
    }
  }
  std::string digest() const { return xxh3_hex(std::as_bytes(std::span(text_))); }

 private:
  void append(std::span<const std::byte> bytes) {
    text_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  std::string text_;
};

}  // namespace

std::array<std::uint64_t, 3> shape_of(const DatasetSpec& spec, const RowSizes& sizes) noexcept {
  std::array<std::uint64_t, 3> shape = spec.shape;
  std::ranges::replace(shape, kComponents, sizes.components);
  std::ranges::replace(shape, kStride, sizes.stride);
  return shape;
}

std::uint64_t row_bytes(const DatasetSpec& spec, const RowSizes& sizes) noexcept {
  const std::array<std::uint64_t, 3> shape = shape_of(spec, sizes);
  std::uint64_t bytes = size_of(spec.type);
  for (std::size_t i = 0; i < spec.rank; ++i) bytes *= shape[i] == kRows ? 1 : shape[i];
  return bytes;
}

std::string digest(const StoredDataset& dataset) {
  Canonical canonical;
  canonical.add(dataset.attributes);
  canonical.add("/type", std::as_bytes(std::span(std::string_view(name_of(dataset.type)))));
  canonical.add("/shape", std::as_bytes(std::span(dataset.shape)));
  return canonical.digest();
}

std::string digest(const StoredAttributes& attributes,
                   const std::map<std::string, std::string>& children) {
  Canonical canonical;
  canonical.add(attributes);
  for (const auto& [name, child] : children)
    canonical.add("/" + name, std::as_bytes(std::span(child)));
  return canonical.digest();
}

std::string digest(const StoredGroup& group) {
  std::map<std::string, std::string> children;
  for (const auto& [name, dataset] : group.datasets) children.emplace(name, digest(dataset));
  for (const auto& [name, below] : group.groups) children.emplace(name, digest(below));
  return digest(group.attributes, children);
}

}  // namespace trivet::format
