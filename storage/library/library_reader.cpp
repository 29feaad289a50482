#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <span>

#include "storage/file.hpp"
#include "storage/files/looks_like.hpp"
#include "storage/library.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/parse_library.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// Takes values out of the tree. The first fault is kept, and what is taken after it is empty:
/// whoever reads asks for the fault once, at the end.
class Taker {
 public:
  Taker(const fs::path& file, std::span<const std::byte> bytes) : file_(file), bytes_(bytes) {}

  const std::optional<Error>& fault() const noexcept { return fault_; }
  void refuse(const std::string& place, const std::string& what) {
    if (!fault_)
      fault_ = Error{ErrorCode::bad_data, fmt::format("{}: {}: {}", file_.string(), place, what)};
  }

  template <class T, std::size_t N>
  std::array<T, N> numbers(const StoredAttributes& from, const std::string& name, ElementType type,
                           const std::string& path) {
    std::array<T, N> out{};
    const StoredAttribute* found = find(from, name, type, path);
    if (found == nullptr) return out;
    if (found->bytes.size() != sizeof(out)) {
      refuse(path + "@" + name,
             fmt::format("expected {} numbers, found {} bytes", N, found->bytes.size()));
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
  std::string text(const StoredAttributes& from, const std::string& name, const std::string& path) {
    const StoredAttribute* found = find(from, name, ElementType::text, path);
    if (found == nullptr) return {};
    std::string out(reinterpret_cast<const char*>(found->bytes.data()), found->bytes.size());
    out.resize(std::min(out.size(), out.find('\0')));
    return out;
  }

  /// The bytes of a dataset in the mapped file, when its type, shape and checksum are right; none
  /// of a dataset that the file's version did not have.
  std::span<const std::byte> data(const StoredGroup& group, const format::DatasetSpec& spec,
                                  const std::string& path);

  /// The minor version of the file: older ones have fewer datasets, newer ones may have more.
  void set_version(std::uint32_t minor) noexcept { minor_ = minor; }
  /// Of the library's features.
  void set_components(std::size_t number) noexcept { num_components_ = number; }
  std::size_t num_components() const noexcept { return num_components_; }
  /// Refuse what the format of that version does not name.
  void expect_only(const StoredGroup& group, std::string_view spec_group,
                   std::initializer_list<std::string_view> below, const std::string& path);
  /// A group below another one; null where there is none.
  const StoredGroup* below(const StoredGroup& group, const std::string& name) const {
    const auto found = group.groups.find(name);
    return found == group.groups.end() ? nullptr : &found->second;
  }

 private:
  const StoredAttribute* find(const StoredAttributes& from, const std::string& name,
                              ElementType type, const std::string& path) {
    const auto found = from.find(name);
    if (found != from.end() && found->second.type == type) return &found->second;
    refuse(path + "@" + name,
           fmt::format("expected an attribute of type {}, found {}", name_of(type),
                       found == from.end() ? "none" : name_of(found->second.type)));
    return nullptr;
  }

  const fs::path& file_;
  std::span<const std::byte> bytes_;
  std::uint32_t minor_ = kLibraryVersionMinor;
  std::size_t num_components_ = 0;
  std::optional<Error> fault_;
};

std::span<const std::byte> Taker::data(const StoredGroup& group, const format::DatasetSpec& spec,
                                       const std::string& path) {
  if (spec.since > minor_) return {};
  const std::string place = path + "/" + std::string(spec.name);
  const auto found = group.datasets.find(std::string(spec.name));
  if (found == group.datasets.end()) {
    refuse(place, "expected this dataset, found none");
    return {};
  }
  const StoredDataset& dataset = found->second;
  std::array<std::uint64_t, 3> expected_shape = spec.shape;
  std::ranges::replace(expected_shape, format::kComponents, std::uint64_t{num_components_});
  bool fits = dataset.type == spec.type && dataset.shape.size() == spec.rank;
  for (std::size_t i = 0; fits && i < spec.rank; ++i)
    fits = spec.shape[i] == format::kRows || expected_shape[i] == dataset.shape[i];
  if (!fits) {
    const auto expected = std::span(expected_shape).first(spec.rank);
    refuse(place,
           fmt::format("expected {} of shape ({}) with 0 for any number, found {} of shape ({})",
                       name_of(spec.type), fmt::join(expected, ", "), name_of(dataset.type),
                       fmt::join(dataset.shape, ", ")));
    return {};
  }
  const auto bytes = bytes_.subspan(dataset.offset, dataset.bytes);
  const std::string expected = text(dataset.attributes, std::string(format::kDataChecksum), place);
  if (const std::string sum = xxh3_hex(bytes); sum != expected) {
    refuse(place, fmt::format("expected checksum {}, found {}: the data is damaged; copy the "
                              "library again or train it anew",
                              expected, sum));
    return {};
  }
  return bytes;
}

void Taker::expect_only(const StoredGroup& group, std::string_view spec_group,
                        std::initializer_list<std::string_view> below, const std::string& path) {
  if (minor_ > kLibraryVersionMinor) return;
  for (const auto& entry : group.datasets) {
    const std::string& name = entry.first;
    const bool known = std::ranges::any_of(format::kDatasets, [&](const format::DatasetSpec& spec) {
      return spec.group == spec_group && spec.name == name && spec.since <= minor_;
    });
    if (!known) refuse(path + "/" + name, "the format has no such dataset");
  }
  for (const auto& [name, child] : group.groups) {
    const bool newer = name == "trisi" && minor_ < format::kFeatures.since;
    if (newer || std::ranges::find(below, name) == below.end())
      refuse(path + "/" + name, "the format has no such group");
  }
}

template <class T>
Column<T> copy(std::span<const std::byte> bytes) {
  Column<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
  return out;
}

/// Row i of three rows of equal length.
template <class T>
Column<T> copy_row(std::span<const std::byte> bytes, std::size_t i) {
  return copy<T>(bytes.subspan(i * (bytes.size() / 3), bytes.size() / 3));
}

Points copy_points(std::span<const std::byte> bytes) {
  Points out(bytes.size() / (3 * sizeof(float)));
  const std::size_t row = bytes.size() / 3;
  if (row == 0) return out;
  const PointsSpan to = out.span();
  std::memcpy(to.x.data(), bytes.data(), row);
  std::memcpy(to.y.data(), bytes.data() + row, row);
  std::memcpy(to.z.data(), bytes.data() + 2 * row, row);
  return out;
}

std::vector<Pose> copy_poses(std::span<const std::byte> bytes) {
  const Column<float> values = copy<float>(bytes);
  std::vector<Pose> out(values.size() / 16);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].matrix() =
        Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(values.data() + 16 * i);
  }
  return out;
}

std::optional<Symmetry::Axis> copy_axis(std::span<const std::byte> bytes) {
  const Column<float> values = copy<float>(bytes);
  if (values.size() < 6) return {};
  return Symmetry::Axis{Eigen::Vector3f(values.data()), Eigen::Vector3f(values.data() + 3)};
}

/// Keeps a table alive: the mapped file, and copies of columns that lie in it at odd addresses
/// (small ones: the writer begins large datasets on a page).
struct TableStorage {
  std::shared_ptr<const std::byte> file;
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

template <class T>
std::span<const T> in_place(std::span<const std::byte> bytes, Column<T>& copied) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(T) == 0) {
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  copied = copy<T>(bytes);
  return copied;
}

void take_table(Taker& take, const std::string& path, const StoredGroup& group,
                const std::shared_ptr<const std::byte>& file, Model& model) {
  model.ppf_points = copy_points(take.data(group, format::kPpfPoints, path));
  model.ppf_normals = copy_points(take.data(group, format::kPpfNormals, path));
  model.ppf.quantization = {take.f32(group.attributes, "distance_step", path),
                            take.u32(group.attributes, "num_distance_bins", path),
                            take.u32(group.attributes, "num_angle_bins", path)};
  model.ppf.num_references = take.u32(group.attributes, "num_references", path);
  auto storage = std::make_shared<TableStorage>(TableStorage{file, {}, {}});
  model.ppf.offsets = in_place(take.data(group, format::kPpfOffsets, path), storage->offsets);
  model.ppf.entries = in_place(take.data(group, format::kPpfEntries, path), storage->entries);
  model.ppf_storage = std::move(storage);
  take.expect_only(group, "ppf", {}, path);
}

TriSpinFeatures take_features(Taker& take, const std::string& path, const StoredGroup& group) {
  TriSpinFeatures out;
  out.resolution = take.f32(group.attributes, "resolution", path);
  out.keypoints = copy_points(take.data(group, format::kKeypoints, path));
  out.frames = copy<FrameRows>(take.data(group, format::kFrames, path));
  out.codes = copy<std::uint8_t>(take.data(group, format::kFeatures, path));
  out.num_components = take.num_components();
  take.expect_only(group, "trisi", {}, path);
  return out;
}

TriSpinBasis take_basis(Taker& take, const StoredGroup& group) {
  const std::string path = "/trisi";
  TriSpinBasis out;
  out.support = take.f32(group.attributes, "support", path);
  out.code_step = take.f32(group.attributes, "code_step", path);
  PcaBasis& components = out.components;
  components.all_energy = take.f32(group.attributes, "all_energy", path);
  components.dimension = format::kImageSize;
  components.mean = copy<float>(take.data(group, format::kMeanImage, path));
  components.components = copy<float>(take.data(group, format::kImageComponents, path));
  components.energies = copy<float>(take.data(group, format::kImageEnergies, path));
  take.expect_only(group, "/trisi", {}, path);
  return out;
}

Model take_model(Taker& take, const std::string& name, const StoredGroup& group,
                 const std::shared_ptr<const std::byte>& file) {
  const std::string path = "/models/" + name;
  Model model;
  model.name = name;
  model.source = take.text(group.attributes, "source", path);
  model.source_xxh3 = take.text(group.attributes, "source_xxh3", path);
  model.diameter = take.f32(group.attributes, "diameter", path);
  model.center = take.vector(group.attributes, "centre", path);
  model.sample_spacing = take.f32(group.attributes, "sample_spacing", path);

  model.symmetry.declared = take.numbers<std::uint8_t, 1>(group.attributes, "symmetry_declared",
                                                          ElementType::u8, path)[0] != 0;
  const Eigen::Vector3f direction = take.vector(group.attributes, "symmetry_axis_direction", path);
  const Eigen::Vector3f point = take.vector(group.attributes, "symmetry_axis_point", path);
  if (direction != Eigen::Vector3f::Zero()) model.symmetry.axis = Symmetry::Axis{direction, point};
  model.symmetry.poses = copy_poses(take.data(group, format::kSymmetryPoses, path));
  model.near_symmetries = copy_poses(take.data(group, format::kNearSymmetries, path));
  const auto near_axes = take.data(group, format::kNearAxis, path);
  if (near_axes.size() > 6 * sizeof(float))
    take.refuse(path + "/near_axis", "expected one axis at most");
  model.near_axis = copy_axis(near_axes);

  model.vertices = copy_points(take.data(group, format::kVertices, path));
  const auto triangles = take.data(group, format::kTriangles, path);
  model.triangles = {copy_row<std::uint32_t>(triangles, 0), copy_row<std::uint32_t>(triangles, 1),
                     copy_row<std::uint32_t>(triangles, 2)};
  model.samples = copy_points(take.data(group, format::kSamples, path));
  model.sample_normals = copy_points(take.data(group, format::kSampleNormals, path));
  model.sample_views = copy<ViewMask>(take.data(group, format::kSampleViews, path));
  take.expect_only(group, "", {"ppf", "trisi"}, path);
  if (const StoredGroup* const table = take.below(group, "ppf")) {
    take_table(take, path + "/ppf", *table, file, model);
  } else {
    take.refuse(path + "/ppf", "expected this group, found none");
  }
  if (take.num_components() == 0) {
    if (take.below(group, "trisi") != nullptr)
      take.refuse(path + "/trisi", "expected the group /trisi beside it, found none");
  } else if (const StoredGroup* const features = take.below(group, "trisi")) {
    model.features = take_features(take, path + "/trisi", *features);
  } else {
    take.refuse(path + "/trisi", "expected this group, found none");
  }
  return model;
}

/// The beginning of the file says how long it must be (HDF5 file format 3.0, section II.A: the
/// superblock, versions 2 and 3, which are the ones with a checksum).
Result<void> check_superblock(const fs::path& file, std::span<const std::byte> bytes) {
  constexpr unsigned char kSignature[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  constexpr std::size_t kSize = 48, kVersion = 8, kOffsetSize = 9, kEnd = 28;
  const auto bad = [&](const std::string& what) {
    return Error{ErrorCode::bad_data, fmt::format("{}: {}", file.string(), what)};
  };

  if (bytes.size() < sizeof(kSignature) ||
      std::memcmp(bytes.data(), kSignature, sizeof(kSignature)) != 0) {
    const formats::Appearance found = formats::looks_like(bytes);
    return bad(
        fmt::format("expected a model library (HDF5), found {}; make one with `trivet train`",
                    found ? found.what : "another kind of file"));
  }
  if (bytes.size() < kSize)
    return bad(fmt::format("truncated: expected at least {} bytes, found {}", kSize, bytes.size()));
  const auto version = std::to_integer<unsigned>(bytes[kVersion]);
  if (version < 2 || version > 3 || bytes[kOffsetSize] != std::byte{8}) {
    return bad(fmt::format(
        "expected an HDF5 superblock of version 2 or 3 with 8-byte offsets, found version {}: "
        "another program wrote it; `trivet library import` takes such a file in",
        version));
  }
  std::uint64_t end = 0;
  std::memcpy(&end, bytes.data() + kEnd, sizeof(end));
  if (end > bytes.size())
    return bad(fmt::format("truncated: the header says {} bytes, found {}; copy the library again",
                           end, bytes.size()));
  if (end < bytes.size())
    return bad(fmt::format("damaged: the header says {} bytes, found {}; copy the library again",
                           end, bytes.size()));
  return {};
}

void list_datasets(const StoredGroup& group, const std::string& path,
                   std::vector<std::pair<std::uint64_t, DatasetInfo>>& out) {
  for (const auto& [name, dataset] : group.datasets)
    out.push_back({dataset.offset, {path + name, dataset.bytes}});
  for (const auto& [name, below] : group.groups) list_datasets(below, path + name + "/", out);
}

Result<Library> read_library(const fs::path& file) {
  const auto mapped = MappedFile::open(file, std::numeric_limits<std::uint64_t>::max());
  if (!mapped) return mapped.error();
  const auto bytes = mapped->bytes();
  if (auto good = check_superblock(file, bytes); !good) return good.error();
  const auto root = read_stored_tree(file, bytes.size());
  if (!root) return root.error();
  return parse_library(file, *root, bytes, mapped->owner());
}

}  // namespace

Result<Library> parse_library(const fs::path& file, const StoredGroup& root,
                              std::span<const std::byte> bytes,
                              const std::shared_ptr<const std::byte>& owner) {
  Taker take(file, bytes);
  const std::uint32_t minor = take.u32(root.attributes, "format_version_minor", "/");
  take.set_version(minor);
  Library out{file, {}, minor, bytes.size(), {}, {}, {}};
  out.header.producer = take.text(root.attributes, "producer", "/");
  out.header.parameters = take.text(root.attributes, "parameters", "/");
  const std::string unit = take.text(root.attributes, "length_unit", "/");
  if (unit != "m" && unit != "mm")
    take.refuse("/@length_unit", fmt::format("expected m or mm, found '{}'", unit));
  out.header.unit = unit == "mm" ? LengthUnit::millimeter : LengthUnit::meter;
  const std::string expected = take.text(root.attributes, std::string(format::kChecksum), "/");
  if (const std::string sum = format::digest(root); sum != expected) {
    take.refuse(
        "/@checksum",
        fmt::format("expected {}, found {}: names or attributes were changed or are damaged",
                    expected, sum));
  }

  const auto models = root.groups.find("models");
  if (models == root.groups.end()) {
    take.refuse("/models", "expected this group, found none");
  } else {
    take.expect_only(root, "/", {"models", "trisi"}, "");
    if (const StoredGroup* const basis = minor >= 3 ? take.below(root, "trisi") : nullptr) {
      out.basis = take_basis(take, *basis);
      if (take.fault()) return *take.fault();
      if (auto good = format::check_basis(out.basis); !good) {
        return Error{ErrorCode::bad_data,
                     fmt::format("{}: {}", file.string(), good.error().message)};
      }
      take.set_components(out.basis.components.size());
    }
    const std::uint32_t count = take.u32(root.attributes, "num_models", "/");
    if (count != models->second.groups.size() || !models->second.datasets.empty()) {
      take.refuse("/models",
                  fmt::format("expected {} groups, found {} and {} datasets", count,
                              models->second.groups.size(), models->second.datasets.size()));
    }
    for (const auto& [name, group] : models->second.groups) {
      Model model = take_model(take, name, group, owner);
      if (take.fault()) return *take.fault();
      if (auto good = format::check_model(model); !good) {
        return Error{ErrorCode::bad_data,
                     fmt::format("{}: {}", file.string(), good.error().message)};
      }
      out.models.push_back(std::move(model));
    }
  }
  if (take.fault()) return *take.fault();

  std::vector<std::pair<std::uint64_t, DatasetInfo>> datasets;
  list_datasets(root, "", datasets);
  std::ranges::stable_sort(datasets, {}, &std::pair<std::uint64_t, DatasetInfo>::first);
  for (auto& [offset, info] : datasets) out.datasets.push_back(std::move(info));
  return out;
}

Result<Library> open_library(const fs::path& file) {
  try {
    return read_library(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::io,
                 fmt::format("{}: not enough memory to open the library", file.string())};
  }
}

}  // namespace trivet
