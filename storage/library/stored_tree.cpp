#include "storage/library/stored_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "storage/library/hdf5.hpp"
#include "storage/library/library.hpp"
#include "storage/library/library_format.hpp"

namespace trivet {
namespace {

static_assert(std::endian::native == std::endian::little,
              "columns are stored as they are in memory");

constexpr int kMaxRank = 4;
constexpr int kMaxDepth = 6;  // the format needs four: /models/NAME/ppf/DATASET
constexpr std::uint64_t kMaxAttributeBytes = 1 << 20;
constexpr std::uint64_t kMostPacking = 1100;  // deflate compresses by at most 1032
constexpr std::uint64_t kUnpackedAlignment = 64;
__extension__ typedef unsigned __int128 Wide;

/// Permitted layouts of datasets.
enum class Storing {
  in_place,  ///< contiguous, as in memory
  packed,    ///< chunked or filtered: HDF5 has to decode them
};

/// Traverses the objects of one file; every error names the object.
class Scanner {
 public:
  /// left_out  a group of the root that is not traversed
  Scanner(const std::filesystem::path& file, std::uint64_t file_bytes, Storing storing,
          std::string_view left_out = {})
      : file_(file), file_bytes_(file_bytes), storing_(storing), left_out_(left_out) {}

  /// End of the last dataset after decoding.
  std::uint64_t unpacked_bytes() const noexcept { return unpacked_bytes_; }

  Result<StoredGroup> group(hid_t id, const std::string& path, int depth);
  Result<StoredAttribute> attribute(hid_t object, const std::string& name,
                                    const std::string& path) const;
  Error bad(const std::string& path, const std::string& what) const {
    return {ErrorCode::bad_data,
            fmt::format("{}: {}: {}", file_.string(), path.empty() ? "/" : path, what)};
  }

 private:
  Result<StoredDataset> dataset(hid_t id, const std::string& path);
  Result<void> check_in_place(hid_t creation, const std::string& path) const;
  Result<void> check_packed(hid_t creation, const std::string& path) const;
  Result<void> place(hid_t id, const std::string& path, StoredDataset& dataset);
  Result<StoredAttributes> attributes(hid_t object, const std::string& path) const;
  Result<void> type_and_shape(hid_t type, hid_t space, const std::string& path,
                              StoredAttribute& out) const;
  Result<void> visit_once(hid_t object, const std::string& path);
  std::uint64_t most_unpacked() const noexcept {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62U;
    return file_bytes_ < kMost / kMostPacking ? kMostPacking * file_bytes_ : kMost;
  }

  const std::filesystem::path& file_;
  std::uint64_t file_bytes_;
  Storing storing_;
  std::string_view left_out_;
  std::uint64_t dataset_bytes_ = 0, unpacked_bytes_ = 0;
  std::set<haddr_t> visited_;
};

/// The element type, if the format knows it.
std::optional<ElementType> element_type(hid_t type) {
  const std::pair<hid_t, ElementType> numbers[] = {
      {H5T_IEEE_F32LE, ElementType::f32}, {H5T_STD_U8LE, ElementType::u8},
      {H5T_STD_U16LE, ElementType::u16},  {H5T_STD_U32LE, ElementType::u32},
      {H5T_STD_U64LE, ElementType::u64},
  };
  for (const auto& [known, element] : numbers) {
    if (H5Tequal(type, known) > 0) return element;
  }
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) return ElementType::text;
  return std::nullopt;
}

Result<void> Scanner::type_and_shape(hid_t type, hid_t space, const std::string& path,
                                     StoredAttribute& out) const {
  const auto element = element_type(type);
  if (!element) {
    return bad(
        path,
        fmt::format(
            "expected a little-endian float32, an unsigned integer or a text of fixed length, "
            "found another type of {} bytes",
            H5Tget_size(type)));
  }
  out.type = *element;

  const int rank = H5Sget_simple_extent_ndims(space);
  const H5S_class_t extent = H5Sget_simple_extent_type(space);
  if (rank < 0 || rank > kMaxRank || (extent != H5S_SCALAR && extent != H5S_SIMPLE)) {
    return bad(path,
               fmt::format("expected an array of at most {} dimensions, found {}", kMaxRank, rank));
  }
  std::array<hsize_t, kMaxRank> shape{};
  if (rank > 0 && H5Sget_simple_extent_dims(space, shape.data(), nullptr) != rank) {
    return bad(path, "the shape cannot be read");
  }
  out.shape.assign(shape.begin(), shape.begin() + rank);
  return {};
}

/// Product of the shape and the element size; empty if it exceeds `limit`.
std::optional<std::uint64_t> bytes_of(const std::vector<std::uint64_t>& shape,
                                      std::uint64_t element, std::uint64_t limit) {
  if (std::ranges::find(shape, 0U) != shape.end()) return 0;
  Wide bytes = element;
  for (const std::uint64_t n : shape) {
    bytes *= n;
    if (bytes > limit) return std::nullopt;
  }
  return bytes > limit ? std::nullopt : std::optional(static_cast<std::uint64_t>(bytes));
}

Result<StoredAttribute> Scanner::attribute(hid_t object, const std::string& name,
                                           const std::string& path) const {
  const std::string place = fmt::format("{}@{}", path, name);
  const hdf5::Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT));
  if (!attribute) return bad(place, "expected this attribute, found none that can be read");
  const hdf5::Handle type(H5Aget_type(attribute.get()));
  const hdf5::Handle space(H5Aget_space(attribute.get()));

  StoredAttribute out;
  TRIVET_TRY(type_and_shape(type.get(), space.get(), place, out));
  const auto bytes = bytes_of(out.shape, H5Tget_size(type.get()), kMaxAttributeBytes);
  if (!bytes)
    return bad(place, fmt::format("expected at most {} bytes, found more", kMaxAttributeBytes));
  out.bytes.resize(*bytes);
  if (*bytes > 0 && H5Aread(attribute.get(), type.get(), out.bytes.data()) < 0)
    return bad(place, "cannot be read");
  return out;
}

/// Collects names for H5Aiterate and H5Literate; no exception may pass through C.
herr_t collect(void* names, const char* name) noexcept {
  try {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
  } catch (...) {
    return -1;
  }
}

Result<StoredAttributes> Scanner::attributes(hid_t object, const std::string& path) const {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5A_info_t*, void* out) {
    return collect(out, name);
  };
  if (H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names) < 0) {
    return bad(path, "the attributes cannot be listed: the file is damaged");
  }
  StoredAttributes out;
  for (const std::string& name : names) {
    TRIVET_TRY_ASSIGN(auto read, attribute(object, name, path));
    out.emplace(name, std::move(read));
  }
  return out;
}

// An object that is reached twice is part of a cycle or of a file that expands without end.
Result<void> Scanner::visit_once(hid_t object, const std::string& path) {
  H5O_info_t info;
  if (H5Oget_info(object, &info) < 0)
    return bad(path, "the object cannot be read: the file is damaged");
  if (!visited_.insert(info.addr).second)
    return bad(path, "expected an object of its own, found a second link to one");
  return {};
}

Result<void> Scanner::check_in_place(hid_t creation, const std::string& path) const {
  constexpr const char* kMend = "; `trivet library import` imports such a file";
  if (H5Pget_layout(creation) != H5D_CONTIGUOUS)
    return bad(path, fmt::format("expected a contiguous dataset, found another layout{}", kMend));
  if (H5Pget_nfilters(creation) != 0) {
    return bad(path, fmt::format("expected a dataset without filters, found compression or another "
                                 "filter{}",
                                 kMend));
  }
  return {};
}

/// Check that no filter would be loaded from outside of HDF5.
Result<void> Scanner::check_packed(hid_t creation, const std::string& path) const {
  const H5D_layout_t layout = H5Pget_layout(creation);
  if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
    return bad(path, "expected a contiguous, chunked or compact dataset, found another layout");
  const int num_filters = H5Pget_nfilters(creation);
  for (int k = 0; k < num_filters; ++k) {
    unsigned flags = 0, config = 0;
    std::size_t num_values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(k), &flags,
                                               &num_values, nullptr, 0, nullptr, &config);
    if (filter < 0 || filter > H5Z_FILTER_SCALEOFFSET || H5Zfilter_avail(filter) <= 0) {
      return bad(path, fmt::format("expected filters of HDF5 itself, found filter {}; unpack the "
                                   "file with h5repack -f NONE where that filter is known",
                                   filter));
    }
  }
  return {};
}

/// Determine the offset of a dataset's bytes.
Result<void> Scanner::place(hid_t id, const std::string& path, StoredDataset& dataset) {
  if (storing_ == Storing::packed) {
    dataset.offset = unpacked_bytes_;
    unpacked_bytes_ += (dataset.bytes + kUnpackedAlignment - 1) & ~(kUnpackedAlignment - 1);
    return {};
  }
  if (dataset.bytes == 0) return {};
  const haddr_t offset = H5Dget_offset(id);
  if (H5Dget_storage_size(id) != dataset.bytes || offset == HADDR_UNDEF || offset > file_bytes_ ||
      dataset.bytes > file_bytes_ - offset) {
    return bad(path,
               fmt::format("expected {} bytes inside the file of {}, found them to lie elsewhere",
                           dataset.bytes, file_bytes_));
  }
  dataset.offset = offset;
  return {};
}

Result<StoredDataset> Scanner::dataset(hid_t id, const std::string& path) {
  TRIVET_TRY(visit_once(id, path));

  // Check the location of the data before any call that could follow it out of the file.
  const hdf5::Handle creation(H5Dget_create_plist(id));
  if (H5Pget_external_count(creation.get()) != 0)
    return bad(path, "expected data inside the file, found external storage");
  TRIVET_TRY(storing_ == Storing::in_place ? check_in_place(creation.get(), path)
                                           : check_packed(creation.get(), path));

  const hdf5::Handle type(H5Dget_type(id));
  const hdf5::Handle space(H5Dget_space(id));
  StoredAttribute shaped;
  TRIVET_TRY(type_and_shape(type.get(), space.get(), path, shaped));

  StoredDataset out{shaped.type, shaped.shape, 0, 0, {}};
  const std::uint64_t most = storing_ == Storing::in_place ? file_bytes_ : most_unpacked();
  const auto bytes = bytes_of(out.shape, H5Tget_size(type.get()), most);
  if (!bytes)
    return bad(path, fmt::format("declares more bytes than the {} that the file can hold", most));
  out.bytes = *bytes;
  dataset_bytes_ += out.bytes;  // both are at most `most` here: no overflow
  if (dataset_bytes_ > most)
    return bad(
        path,
        fmt::format("the datasets declare more bytes than the {} that the file can hold", most));
  TRIVET_TRY(place(id, path, out));

  TRIVET_TRY_ASSIGN(out.attributes, attributes(id, path));
  return out;
}

Result<StoredGroup> Scanner::group(hid_t id, const std::string& path, int depth) {
  TRIVET_TRY(visit_once(id, path));
  if (depth > kMaxDepth)
    return bad(path, fmt::format("expected at most {} nested groups, found more", kMaxDepth));

  StoredGroup out;
  TRIVET_TRY_ASSIGN(out.attributes, attributes(id, path));

  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* list) {
    return collect(list, name);
  };
  if (H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names) < 0) {
    return bad(path, "the group cannot be listed: the file is damaged");
  }
  for (const std::string& name : names) {
    const std::string child = path + "/" + name;
    H5L_info_t link;
    if (H5Lget_info(id, name.c_str(), &link, H5P_DEFAULT) < 0)
      return bad(child, "the link cannot be read: the file is damaged");
    if (link.type != H5L_TYPE_HARD)
      return bad(child, "expected an object of this file, found a soft or external link");

    if (depth == 0 && name == left_out_) {
      out.groups.emplace(name, StoredGroup{});
      continue;
    }
    const hdf5::Handle object(H5Oopen(id, name.c_str(), H5P_DEFAULT));
    if (!object) return bad(child, "the object cannot be opened: the file is damaged");
    const H5I_type_t kind = H5Iget_type(object.get());
    if (kind == H5I_GROUP) {
      TRIVET_TRY_ASSIGN(auto below, group(object.get(), child, depth + 1));
      out.groups.emplace(name, std::move(below));
    } else if (kind == H5I_DATASET) {
      TRIVET_TRY_ASSIGN(auto below, dataset(object.get(), child));
      out.datasets.emplace(name, std::move(below));
    } else {
      return bad(child, "expected a group or a dataset, found another object");
    }
  }
  return out;
}

/// Let HDF5 decode all datasets below a group to their offsets.
Result<void> read_datasets(const Scanner& scanner, hid_t id, const StoredGroup& group,
                           const std::string& path, std::span<std::byte> out) {
  for (const auto& [name, dataset] : group.datasets) {
    const hdf5::Handle opened(H5Dopen2(id, name.c_str(), H5P_DEFAULT));
    const hdf5::Handle type(H5Dget_type(opened.get()));
    if (!opened || !type ||
        (dataset.bytes > 0 && H5Dread(opened.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                      out.data() + dataset.offset) < 0)) {
      return scanner.bad(path + "/" + name, "HDF5 cannot unpack it: the file is damaged");
    }
  }
  for (const auto& [name, below] : group.groups) {
    const hdf5::Handle opened(H5Gopen2(id, name.c_str(), H5P_DEFAULT));
    const Result<void> read = read_datasets(scanner, opened.get(), below, path + "/" + name, out);
    if (!read) return read;
  }
  return {};
}

std::string text_of(const StoredAttribute& attribute) {
  std::string text(reinterpret_cast<const char*>(attribute.bytes.data()), attribute.bytes.size());
  text.resize(std::min(text.size(), text.find('\0')));
  return text;
}

/// Refuse other kinds of files and other major versions before their structure is read.
Result<void> check_version(const Scanner& scanner, hid_t root) {
  const auto format = scanner.attribute(root, "format", "");
  if (!format || format->type != ElementType::text || text_of(*format) != format::kName) {
    return scanner.bad("@format",
                       fmt::format("expected \"{}\": this HDF5 file is no model library; "
                                   "make one with `trivet train`",
                                   format::kName));
  }
  TRIVET_TRY_ASSIGN(const auto major, scanner.attribute(root, "format_version_major", ""));
  std::uint32_t version = 0;
  if (major.type == ElementType::u32 && major.bytes.size() == 4)
    std::memcpy(&version, major.bytes.data(), 4);
  if (version != kLibraryVersionMajor) {
    const auto producer = scanner.attribute(root, "producer", "");
    return scanner.bad(
        "@format_version_major",
        fmt::format("expected format version {}, found {}, written by {}; use a program that reads "
                    "version {}, or train the library again",
                    kLibraryVersionMajor, version,
                    producer && producer->type == ElementType::text ? text_of(*producer)
                                                                    : "an unknown program",
                    version));
  }
  return {};
}

struct OpenFile {
  hdf5::Handle file, root;
};

/// Open a library of this major version.
Result<OpenFile> open_file(const std::filesystem::path& file, const Scanner& scanner) {
  hdf5::start();
  const hdf5::Handle access = hdf5::file_access();
  OpenFile out{hdf5::Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get())), {}};
  if (!out.file)
    return scanner.bad(
        "", "HDF5 cannot open the file: it is damaged; copy it again or train the library again");
  out.root = hdf5::Handle(H5Gopen2(out.file.get(), "/", H5P_DEFAULT));
  if (!out.root) return scanner.bad("", "the root group cannot be opened: the file is damaged");
  TRIVET_TRY(check_version(scanner, out.root.get()));
  return out;
}

}  // namespace

std::size_t size_of(ElementType type) noexcept {
  switch (type) {
    case ElementType::f32:
      return 4;
    case ElementType::u8:
      return 1;
    case ElementType::u16:
      return 2;
    case ElementType::u32:
      return 4;
    case ElementType::u64:
      return 8;
    case ElementType::text:
      return 1;
  }
  return 0;
}

const char* name_of(ElementType type) noexcept {
  switch (type) {
    case ElementType::f32:
      return "float32";
    case ElementType::u8:
      return "uint8";
    case ElementType::u16:
      return "uint16";
    case ElementType::u32:
      return "uint32";
    case ElementType::u64:
      return "uint64";
    case ElementType::text:
      return "text";
  }
  return "";
}

Result<StoredGroup> read_stored_tree(const std::filesystem::path& file, std::uint64_t file_bytes,
                                     std::string_view left_out) {
  Scanner scanner(file, file_bytes, Storing::in_place, left_out);
  TRIVET_TRY_ASSIGN(const OpenFile opened, open_file(file, scanner));
  return scanner.group(opened.root.get(), "", 0);
}

Result<UnpackedTree> read_unpacked_tree(const std::filesystem::path& file,
                                        std::uint64_t file_bytes) {
  Scanner scanner(file, file_bytes, Storing::packed);
  TRIVET_TRY_ASSIGN(const OpenFile opened, open_file(file, scanner));
  TRIVET_TRY_ASSIGN(StoredGroup root, scanner.group(opened.root.get(), "", 0));
  UnpackedTree tree{std::move(root), {}};
  tree.bytes.resize(scanner.unpacked_bytes());
  TRIVET_TRY(read_datasets(scanner, opened.root.get(), tree.root, "", tree.bytes));
  return tree;
}

}  // namespace trivet
