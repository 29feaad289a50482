/// Reading of values from the tree of a library file.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/library/library.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// Position of a column in a file, and the checksum of its bytes.
struct StoredColumn {
  std::uint64_t offset = 0, bytes = 0;
  Xxh3 checksum;
  bool operator==(const StoredColumn&) const = default;
};

/// Keeps the first error; values read after it are empty. The caller checks for the error once, at
/// the end. Paths in errors are those of the HDF5 objects.
class GroupReader {
 public:
  /// bytes  bytes of the file, relative to which offsets are given
  /// minor  minor version of the file: older files have fewer datasets, newer ones may have more;
  ///        attributes are read alike in all
  GroupReader(const std::filesystem::path& file, std::span<const std::byte> bytes,
              std::uint32_t minor = kLibraryVersionMinor)
      : file_(file), bytes_(bytes), minor_(minor) {}

  const std::filesystem::path& file() const noexcept { return file_; }
  std::uint32_t version() const noexcept { return minor_; }
  const std::optional<Error>& fault() const noexcept { return fault_; }
  void refuse(const std::string& place, const std::string& what);
  void refuse(const Error& error);

  template <class T, std::size_t N>
  std::array<T, N> numbers(const StoredAttributes& from, const std::string& name, ElementType type,
                           const std::string& path) {
    std::array<T, N> out{};
    const StoredAttribute* found = find(from, name, type, path);
    if (found == nullptr) return out;
    if (found->bytes.size() != sizeof(out)) {
      refuse_size(path + "@" + name, N, found->bytes.size());
    } else {
      std::memcpy(out.data(), found->bytes.data(), sizeof(out));
    }
    return out;
  }
  float f32(const StoredAttributes& from, const std::string& name, const std::string& path) {
    return numbers<float, 1>(from, name, ElementType::f32, path)[0];
  }
  std::uint32_t u32(const StoredAttributes& from, const std::string& name,
                    const std::string& path) {
    return numbers<std::uint32_t, 1>(from, name, ElementType::u32, path)[0];
  }
  Eigen::Vector3f vector(const StoredAttributes& from, const std::string& name,
                         const std::string& path) {
    const auto v = numbers<float, 3>(from, name, ElementType::f32, path);
    return {v[0], v[1], v[2]};
  }
  std::string text(const StoredAttributes& from, const std::string& name, const std::string& path);

  /// Position of a dataset of the right type and shape; empty if the file's version did not have
  /// the dataset.
  std::optional<StoredColumn> column(const StoredGroup& group, const format::DatasetSpec& spec,
                                     const std::string& path, const format::RowSizes& sizes = {});
  /// The bytes of a dataset whose checksum is right.
  std::span<const std::byte> data(const StoredGroup& group, const format::DatasetSpec& spec,
                                  const std::string& path);
  /// As data(), as numbers.
  template <class T>
  std::vector<T> values(const StoredGroup& group, const format::DatasetSpec& spec,
                        const std::string& path) {
    const auto bytes = data(group, spec, path);
    std::vector<T> out(bytes.size() / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
    return out;
  }

  /// Refuse objects that the format of the file's version does not name.
  void expect_only(const StoredGroup& group, std::string_view spec_group,
                   std::initializer_list<std::string_view> below, const std::string& path);
  /// A subgroup of a group; null if absent.
  static const StoredGroup* below(const StoredGroup& group, const std::string& name) {
    const auto found = group.groups.find(name);
    return found == group.groups.end() ? nullptr : &found->second;
  }

 private:
  const StoredAttribute* find(const StoredAttributes& from, const std::string& name,
                              ElementType type, const std::string& path);
  void refuse_size(const std::string& place, std::size_t expected, std::size_t bytes);

  const std::filesystem::path& file_;
  std::span<const std::byte> bytes_;
  std::uint32_t minor_;
  std::optional<Error> fault_;
};

/// Error message for a wrong checksum of a column.
std::string wrong_checksum(const Xxh3& expected, const Xxh3& found);

}  // namespace trivet
