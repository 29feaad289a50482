#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <span>

#include "storage/files/file.hpp"
#include "storage/files/guess_content.hpp"
#include "storage/library/group_reader.hpp"
#include "storage/library/library.hpp"
#include "storage/library/library_checks.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/model_record.hpp"
#include "storage/library/parse_library.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

TriSpinBasis read_basis(GroupReader& reader, const StoredGroup& group) {
  const std::string path = "/trisi";
  const auto column = [&](const format::DatasetSpec& spec) {
    const std::vector<float> values = reader.values<float>(group, spec, path);
    return Column<float>(values.begin(), values.end());
  };
  TriSpinBasis out;
  out.support = reader.f32(group.attributes, "support", path);
  out.code_step = reader.f32(group.attributes, "code_step", path);
  PcaBasis& components = out.components;
  components.all_energy = reader.f32(group.attributes, "all_energy", path);
  components.dimension = format::kImageSize;
  components.mean = column(format::kMeanImage);
  components.components = column(format::kImageComponents);
  components.energies = column(format::kImageEnergies);
  reader.expect_only(group, "/trisi", {}, path);
  return out;
}

/// A level of the index before it is mapped.
struct LevelRecord {
  float resolution = 0;
  std::uint32_t stride = 0;
  LevelColumns columns{};
};

std::vector<LevelRecord> read_index(GroupReader& reader, const StoredGroup& index) {
  std::vector<LevelRecord> levels;
  for (const auto& [name, group] : index.groups) {
    const std::string path = "/index/" + name;
    if (name != fmt::format("{:02}", levels.size()))
      reader.refuse(path, fmt::format("expected level {:02}", levels.size()));
    LevelRecord& level = levels.emplace_back();
    level.resolution = reader.f32(group.attributes, "resolution", path);
    level.stride = reader.u32(group.attributes, "stride", path);
    for (std::size_t c = 0; c < kLevelColumns.size(); ++c) {
      level.columns[c] = reader.column(group, kLevelColumns[c], path, {.stride = level.stride})
                             .value_or(StoredColumn{});
    }
    reader.expect_only(group, "/index", {}, path);
  }
  if (!index.datasets.empty()) reader.refuse("/index", "expected no datasets");
  return levels;
}

/// Whether the directory's offsets are still those of the datasets: another program that rewrites
/// the file moves them, including the directory.
bool is_in_place(GroupReader& reader, const StoredGroup& directory) {
  const auto at = reader.numbers<std::uint64_t, 1>(directory.attributes, "offset", ElementType::u64,
                                                   "/directory")[0];
  const auto names = directory.datasets.find("names");
  return names != directory.datasets.end() && names->second.offset == at;
}

/// Check the file's length against the superblock (HDF5 file format 3.0, section II.A: versions 2
/// and 3, which have a checksum).
Result<void> check_superblock(const fs::path& file, std::span<const std::byte> bytes) {
  constexpr unsigned char kSignature[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  constexpr std::size_t kSize = 48, kVersion = 8, kOffsetSize = 9, kEnd = 28;
  const auto bad = [&](const std::string& what) {
    return Error{ErrorCode::bad_data, fmt::format("{}: {}", file.string(), what)};
  };

  if (bytes.size() < sizeof(kSignature) ||
      std::memcmp(bytes.data(), kSignature, sizeof(kSignature)) != 0) {
    const formats::ContentGuess found = formats::guess_content(bytes);
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
        "another program wrote it; `trivet library import` imports such a file",
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

/// Source of the models' metadata.
enum class From {
  groups,     ///< groups of the models, all of which were read
  directory,  ///< directory, if the file has one; groups were not read
  both,       ///< both, and they must agree
};

bool same(const std::optional<Symmetry::Axis>& a, const std::optional<Symmetry::Axis>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (a->direction == b->direction && a->point == b->point));
}

bool same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::ranges::equal(a, b,
                            [](const Pose& p, const Pose& q) { return p.matrix() == q.matrix(); });
}

bool same(const ModelRecord& record, const ModelRecord& other) {
  const Model &a = record.traits, &b = other.traits;
  return record.columns == other.columns && a.name == b.name && a.source == b.source &&
         a.source_xxh3 == b.source_xxh3 && a.fingerprint == b.fingerprint &&
         a.diameter == b.diameter && a.center == b.center && a.sample_spacing == b.sample_spacing &&
         a.symmetry.declared == b.symmetry.declared && same(a.symmetry.axis, b.symmetry.axis) &&
         same(a.symmetry.poses, b.symmetry.poses) && same(a.near_axis, b.near_axis) &&
         same(a.near_symmetries, b.near_symmetries) && a.ppf.quantization == b.ppf.quantization &&
         a.ppf.num_references == b.ppf.num_references &&
         std::ranges::equal(a.features, b.features, {}, &TriSpinFeatures::resolution,
                            &TriSpinFeatures::resolution);
}

/// The metadata of all models, whose columns lie in a file of this size.
std::vector<ModelRecord> read_records(GroupReader& reader, const StoredGroup& root, From from,
                                      std::size_t num_components, std::uint64_t file_bytes) {
  if (from == From::groups) return read_models(reader, root.groups.at("models"), num_components);
  const StoredGroup& directory = root.groups.at("directory");
  std::vector<ModelRecord> records = read_directory(reader, directory, num_components, file_bytes);
  if (from == From::directory || reader.fault()) return records;
  const std::vector<ModelRecord> walked =
      read_models(reader, root.groups.at("models"), num_components);
  const std::string digest =
      reader.text(directory.attributes, std::string(format::kModelsDigest), "/directory");
  if (!reader.fault() && (digest != format::digest(root.groups.at("models")) ||
                          !std::ranges::equal(records, walked, [](const auto& a, const auto& b) {
                            return same(a, b);
                          })))
    reader.refuse("/directory", "expected what the groups of /models say; train the library again");
  return records;
}

FileBytes bytes_of(const MappedFile& mapped) { return {mapped.bytes(), mapped.owner(), mapped}; }

LibraryHeader read_header(GroupReader& reader, const StoredAttributes& root) {
  LibraryHeader header;
  header.producer = reader.text(root, "producer", "/");
  header.parameters = reader.text(root, "parameters", "/");
  const std::string unit = reader.text(root, "length_unit", "/");
  if (unit != "m" && unit != "mm")
    reader.refuse("/@length_unit", fmt::format("expected m or mm, found '{}'", unit));
  header.unit = unit == "mm" ? LengthUnit::millimeter : LengthUnit::meter;
  return header;
}

/// Check the tree against the checksum of the whole, and its groups against the format.
void check_root(GroupReader& reader, const StoredGroup& root, From from) {
  std::map<std::string, std::string> children;
  for (const auto& [name, dataset] : root.datasets) children.emplace(name, format::digest(dataset));
  for (const auto& [name, group] : root.groups) {
    children.emplace(name, name == "models" && from == From::directory
                               ? reader.text(root.groups.at("directory").attributes,
                                             std::string(format::kModelsDigest), "/directory")
                               : format::digest(group));
  }
  const std::string expected = reader.text(root.attributes, std::string(format::kChecksum), "/");
  if (const std::string sum = format::digest(root.attributes, children); sum != expected) {
    reader.refuse(
        "/@checksum",
        fmt::format("expected {}, found {}: names or attributes were changed or are damaged",
                    expected, sum));
  }
  if (GroupReader::below(root, "models") == nullptr)
    reader.refuse("/models", "expected this group, found none");
  reader.expect_only(root, "/", {"models", "trisi", "directory", "index"}, "");
}

/// The metadata of as many models as the file says.
std::vector<ModelRecord> read_counted_records(GroupReader& reader, const StoredGroup& root,
                                              From from, std::size_t num_components,
                                              std::uint64_t file_bytes) {
  const StoredGroup& models = root.groups.at("models");
  const std::uint32_t count = reader.u32(root.attributes, "num_models", "/");
  const auto expect_count = [&](std::size_t num_groups) {
    if (num_groups == count && models.datasets.empty()) return;
    reader.refuse("/models", fmt::format("expected {} groups, found {} and {} datasets", count,
                                         num_groups, models.datasets.size()));
  };
  if (from != From::directory) expect_count(models.groups.size());
  std::vector<ModelRecord> records = read_records(reader, root, from, num_components, file_bytes);
  if (!reader.fault()) expect_count(records.size());
  return records;
}

std::vector<Model> map_models(GroupReader& reader, std::span<const ModelRecord> records,
                              const FileBytes& columns, std::size_t num_components) {
  std::vector<Model> models;
  for (const ModelRecord& record : records) {
    models.push_back(map_model(record, columns.bytes, columns.owner, num_components));
    if (const auto good = format::check_traits(models.back()); !good) reader.refuse(good.error());
    if (reader.fault()) break;
  }
  return models;
}

bool has_features(const Model& model) {
  return std::ranges::any_of(model.features, [](const auto& scale) { return scale.size() > 0; });
}

FeatureIndex map_index(GroupReader& reader, std::span<const LevelRecord> levels,
                       const FileBytes& own) {
  FeatureIndex index;
  for (const LevelRecord& level : levels) {
    // These values select the levels that are read, so they are checked first.
    const StoredColumn& with_features = level.columns.front();
    const Xxh3 found = xxh3(own.bytes.subspan(with_features.offset, with_features.bytes));
    if (found != with_features.checksum) {
      reader.refuse(fmt::format("/index/{:02}/{}", index.size(), kLevelColumns.front().name),
                    wrong_checksum(with_features.checksum, found));
      break;
    }
    index.push_back(map_level(level.resolution, level.stride, level.columns, own.bytes, own.owner));
  }
  return index;
}

/// See parse_library.
///
/// own      bytes of the file with this tree
/// columns  bytes of the file with the models' columns
Result<Library> parse(const fs::path& file, const StoredGroup& root, const FileBytes& own,
                      const FileBytes& columns, From from, Held held) {
  GroupReader of_any_version(file, own.bytes);
  const std::uint32_t minor = of_any_version.u32(root.attributes, "format_version_minor", "/");
  if (of_any_version.fault()) return *of_any_version.fault();
  GroupReader reader(file, own.bytes, minor);
  LibraryHeader header = read_header(reader, root.attributes);
  check_root(reader, root, from);
  if (reader.fault()) return *reader.fault();
  TriSpinBasis basis;
  if (const StoredGroup* const group = minor >= 3 ? GroupReader::below(root, "trisi") : nullptr) {
    basis = read_basis(reader, *group);
    if (!reader.fault()) {
      if (const auto good = format::check_basis(basis); !good) reader.refuse(good.error());
    }
  }
  const std::size_t num_components = basis.components.size();
  const std::vector<ModelRecord> records =
      read_counted_records(reader, root, from, num_components, columns.bytes.size());
  // In a rewritten file, the index lies at other offsets.
  std::vector<LevelRecord> levels;
  const StoredGroup* const index = GroupReader::below(root, "index");
  if (index != nullptr && minor >= format::kDirectorySince) levels = read_index(reader, *index);
  if (reader.fault()) return *reader.fault();

  std::vector<Model> models = map_models(reader, records, columns, num_components);
  if (num_components == 0 && std::ranges::any_of(models, has_features))
    reader.refuse("/trisi", "expected the components of the models' features, found none");
  if (reader.fault()) return *reader.fault();
  FeatureIndex mapped_levels = map_index(reader, levels, own);
  if (reader.fault()) return *reader.fault();
  std::vector<LevelColumns> level_columns;
  level_columns.reserve(levels.size());
  for (const LevelRecord& level : levels) level_columns.push_back(level.columns);
  const auto checks =
      std::make_shared<const LibraryChecks>(file, columns, held, records, std::move(level_columns));
  Library out(std::move(models), FeatureLevels(std::move(mapped_levels), records.size(), checks),
              checks);
  out.file = file;
  out.header = std::move(header);
  out.version_minor = minor;
  out.file_bytes = own.bytes.size();
  out.basis = std::move(basis);
  return out;
}

Result<MappedFile> map(const fs::path& file, Writers writers) {
  return MappedFile::open(file, std::numeric_limits<std::uint64_t>::max(), writers);
}

Result<Library> open(const fs::path& file, const MappedFile& mapped, bool read_all) {
  const FileBytes own = bytes_of(mapped);
  TRIVET_TRY(check_superblock(file, own.bytes));
  Result<StoredGroup> root = read_stored_tree(file, own.bytes.size(), read_all ? "" : "models");
  if (!root) return root.error();
  GroupReader reader(file, own.bytes);
  if (root->attributes.contains(std::string(format::kColumnsIn))) {
    reader.refuse("/", "expected a model library, found what training keeps beside one");
    return *reader.fault();
  }
  const StoredGroup* const directory = GroupReader::below(*root, "directory");
  if (directory != nullptr && is_in_place(reader, *directory))
    return parse(file, *root, own, own, read_all ? From::both : From::directory, Held::mapped);
  if (!read_all) root = read_stored_tree(file, own.bytes.size());
  if (!root) return root.error();
  return parse(file, *root, own, own, From::groups, Held::mapped);
}

/// Open the target of a path. HDF5 opens it by name again: if the file was replaced meanwhile, the
/// new one is opened.
Result<Library> open(const fs::path& file, Writers writers, bool read_all) {
  constexpr int kMostTries = 10;
  for (int i = 0;; ++i) {
    TRIVET_TRY_ASSIGN(const auto mapped, map(file, writers));
    Result<Library> library = open(file, mapped, read_all);
    if (!mapped.is_at(file) && i + 1 < kMostTries) continue;
    if (mapped.state() != MappedFile::State::changed) return library;
    return Error{
        ErrorCode::changed,
        fmt::format("{}: was changed while it was opened; open it again when it is written, "
                    "and replace a library in use by renaming a complete one over it",
                    file.string())};
  }
}

Result<Library> open_with_columns(const fs::path& file) {
  TRIVET_TRY_ASSIGN(const auto mapped, map(file, Writers::none));
  const FileBytes own = bytes_of(mapped);
  TRIVET_TRY(check_superblock(file, own.bytes));
  TRIVET_TRY_ASSIGN(const StoredGroup root, read_stored_tree(file, own.bytes.size()));
  GroupReader reader(file, own.bytes);
  const fs::path name = reader.text(root.attributes, std::string(format::kColumnsIn), "/");
  if (GroupReader::below(root, "directory") == nullptr ||
      GroupReader::below(root, "index") != nullptr)
    reader.refuse("/", "expected a directory and no index");
  if (reader.fault()) return *reader.fault();
  TRIVET_TRY_ASSIGN(const auto columns, map(file.parent_path() / name.filename(), Writers::none));
  return parse(file, root, own, bytes_of(columns), From::directory, Held::mapped);
}

/// Run a function that opens a file; out of memory becomes an error.
template <class F>
Result<Library> within_memory(const fs::path& file, F&& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, fmt::format("{}: {}", file.string(), kOutOfMemory)};
  }
}

}  // namespace

Result<Library> parse_library(const fs::path& file, const StoredGroup& root,
                              std::span<const std::byte> bytes,
                              const std::shared_ptr<const std::byte>& owner) {
  const FileBytes own{bytes, owner};
  return parse(file, root, own, own, From::groups, Held::in_memory);
}

Result<Library> open_library(const fs::path& file, Writers writers) {
  return within_memory(file, [&] { return open(file, writers, false); });
}

Result<Library> open_contents(const fs::path& file) {
  return within_memory(file, [&] { return open_with_columns(file); });
}

Result<Library> verify_library(const fs::path& file) {
  return within_memory(file, [&]() -> Result<Library> {
    Result<Library> library = open(file, Writers::others, true);
    if (!library) return library;
    TRIVET_TRY(library->check_all());
    TRIVET_TRY(library->unchanged());
    return library;
  });
}

}  // namespace trivet
