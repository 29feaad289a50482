#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <system_error>

#include "storage/files/file.hpp"
#include "storage/library/directory_columns.hpp"
#include "storage/library/library.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/packed_model.hpp"
#include "storage/library/write_hdf5.hpp"
#include "storage/library/write_level.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using hdf5::attribute;
using hdf5::create_group;
using hdf5::gather;
using hdf5::Handle;
using hdf5::write_attributes;

StoredAttributes basis_attributes(const TriSpinBasis& basis) {
  StoredAttributes out;
  out.emplace("support", attribute(basis.support));
  out.emplace("code_step", attribute(basis.code_step));
  out.emplace("all_energy", attribute(static_cast<float>(basis.components.all_energy)));
  return out;
}

constexpr std::string_view kAxisConvention =
    "models: as in their source; scenes: x right, y down, z forward";

Result<void> check_target(const fs::path& file, const LibraryHeader& header) {
  constexpr std::size_t kMaxText = 60000;  // an attribute must fit an object header of 64 KiB
  for (const std::string* text : {&header.producer, &header.parameters}) {
    if (text->size() > kMaxText || text->find('\0') != std::string::npos) {
      return Error{ErrorCode::bad_data, fmt::format("{}: producer and parameters: expected at most "
                                                    "{} bytes without NUL, found {}",
                                                    file.string(), kMaxText, text->size())};
    }
  }
  std::error_code unknown;
  if (fs::is_directory(file, unknown) || !file.has_filename()) {
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}: expected the name of a file, found a folder", file.string())};
  }
  return {};
}

Error closed_error() {
  return {ErrorCode::io, "this library was published, or its writing has failed"};
}

}  // namespace

/// Data kept about a written model.
struct Written {
  std::string digest;
  ModelRecord record;
};

struct LibraryWriter::State {
  fs::path target;
  LibraryHeader header;
  PendingFile file;
  Handle hdf5, root, models;               ///< destroyed in reverse order
  std::map<std::string, Written> written;  ///< models by name
  std::vector<std::string> unlisted;       ///< names of models that are in no contents file yet
  std::uint64_t end = 0;                   ///< end of their columns in the file
  TriSpinBasis basis;                      ///< without components: no basis
  std::string basis_digest, index_digest;
  std::string columns_in;  ///< false if HDF5 failed

  // false when HDF5 failed
  bool write_basis();
  bool write(PackedModel& model);
  bool write_directory(const std::string& models_digest, std::string& digest) const;
  std::size_t num_components() const noexcept { return basis.components.size(); }
  PackedGroup empty_group() const { return {unit_name(header.unit), num_components()}; }

  /// Error of a failed write; a temporary file is removed, the models of a lasting file stay.
  Error fail(const std::string& what);
};

// Query the free space first: HDF5 keeps a file that it cannot flush.
Error LibraryWriter::State::fail(const std::string& what) {
  std::error_code unknown;
  const fs::space_info space = fs::space(file.path(), unknown);
  Error error{ErrorCode::no_space,
              fmt::format("{}: cannot write {}; {} bytes are free on the disk; free some, or raise "
                          "the limit on the size of files",
                          target.string(), what, unknown ? 0 : space.available)};
  file.shrink(end);
  file.give_up();
  return error;
}

bool LibraryWriter::State::write(PackedModel& packed) {
  const std::string& name = packed.model.name;
  const Handle group = packed.own.write(models.get(), name);
  if (!group) return false;
  for (auto& [part_name, part] : packed.parts) {
    if (!part.write(group.get(), part_name)) return false;
  }
  const StoredGroup described = packed.described();
  written.emplace(name, Written{format::digest(described), record_of(packed.model, described)});
  unlisted.push_back(name);
  for (const StoredColumn& column : written.at(name).record.columns)
    end = std::max(end, column.offset + column.bytes);
  return true;
}

bool LibraryWriter::State::write_basis() {
  const PcaBasis& pca = basis.components;
  PackedGroup packed = empty_group();
  packed.described.attributes = basis_attributes(basis);
  packed.add(format::kMeanImage, std::as_bytes(std::span(pca.mean)));
  packed.add(format::kImageComponents, std::as_bytes(std::span(pca.components)));
  packed.add(format::kImageEnergies, std::as_bytes(std::span(pca.energies)));
  const bool is_written = static_cast<bool>(packed.write(root.get(), "trisi"));
  basis_digest = format::digest(packed.described);
  return is_written;
}

bool LibraryWriter::State::write_directory(const std::string& models_digest,
                                           std::string& digest) const {
  DirectoryColumns all;
  for (const auto& [name, model] : written) all.add(model.record);
  PackedGroup packed = empty_group();
  const auto bytes = [](const auto& column) { return std::as_bytes(std::span(column)); };
  packed.add(format::kNames, bytes(all.names));
  packed.add(format::kTexts, bytes(all.texts));
  packed.add(format::kTextEnds, bytes(all.text_ends));
  packed.add(format::kFingerprints, bytes(all.fingerprints));
  packed.add(format::kDiameters, bytes(all.diameter));
  packed.add(format::kCenters, bytes(all.center));
  packed.add(format::kSpacings, bytes(all.spacing));
  packed.add(format::kAxes, bytes(all.axis));
  packed.add(format::kDeclared, bytes(all.declared));
  packed.add(format::kNearAxes, bytes(all.near_axis));
  packed.add(format::kMotions, gather(all.motions));
  packed.add(format::kMotionEnds, bytes(all.motion_ends));
  packed.add(format::kSteps, bytes(all.step));
  packed.add(format::kCounts, bytes(all.counts));
  packed.add(format::kResolutions, bytes(all.resolution));
  packed.add(format::kPlaces, bytes(all.places));
  packed.add(format::kChecksums, bytes(all.checksums));
  const Handle group = packed.write(root.get(), "directory");
  if (!group) return false;
  StoredGroup& stored = packed.described;
  stored.attributes.emplace(
      "offset", attribute(ElementType::u64, std::uint64_t{stored.datasets.at("names").offset}));
  stored.attributes.emplace(format::kModelsDigest, attribute(models_digest));
  digest = format::digest(stored);
  return write_attributes(group.get(), stored.attributes);
}

LibraryWriter::LibraryWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
LibraryWriter::LibraryWriter(LibraryWriter&&) noexcept = default;
LibraryWriter& LibraryWriter::operator=(LibraryWriter&&) noexcept = default;
LibraryWriter::~LibraryWriter() = default;

Result<LibraryWriter> LibraryWriter::create(const fs::path& file, const LibraryHeader& header,
                                            const NamesToCome& names) {
  TRIVET_TRY(check_target(file, header));
  return begin(PendingFile::create(file), file, header, names);
}

Result<LibraryWriter> LibraryWriter::create_lasting(const fs::path& file, const fs::path& name,
                                                    const LibraryHeader& header,
                                                    const NamesToCome& names) {
  TRIVET_TRY(check_target(file, header));
  return begin(PendingFile::create_lasting(file, name), file, header, names);
}

Result<LibraryWriter> LibraryWriter::begin(Result<PendingFile> file, const fs::path& target,
                                           const LibraryHeader& header, const NamesToCome& names) {
  if (!file) return file.error();
  hdf5::start();
  auto state = std::make_unique<State>(State{.target = target,
                                             .header = header,
                                             .file = *std::move(file),
                                             .hdf5 = {},
                                             .root = {},
                                             .models = {},
                                             .written = {},
                                             .unlisted = {},
                                             .end = 0,
                                             .basis = {},
                                             .basis_digest = {},
                                             .index_digest = {},
                                             .columns_in = {}});
  const Handle creation = hdf5::creation_of(H5P_FILE_CREATE);
  const Handle access = hdf5::file_access();
  state->hdf5 =
      Handle(H5Fcreate(state->file.path().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()));
  state->root = Handle(H5Gopen2(state->hdf5.get(), "/", H5P_DEFAULT));
  state->models = create_group(state->root.get(), "models", names);
  if (!state->hdf5 || !state->root || !state->models) return state->fail("its first bytes");
  return LibraryWriter(std::move(state));
}

Result<void> LibraryWriter::add(const TriSpinBasis& basis) {
  if (!state_ || !state_->file.pending()) return closed_error();
  if (basis.components.size() == 0 && basis.components.mean.empty()) return {};
  TRIVET_TRY(format::check_basis(basis));
  if (state_->num_components() > 0 || !state_->written.empty()) {
    return Error{ErrorCode::internal,
                 fmt::format("{}: expected one basis, before all models", state_->target.string())};
  }
  hdf5::start();
  state_->basis = basis;
  if (state_->write_basis()) return {};
  return state_->fail("the basis of the features");
}

LengthUnit LibraryWriter::unit() const noexcept { return state_->header.unit; }
std::size_t LibraryWriter::num_components() const noexcept { return state_->num_components(); }

Result<void> LibraryWriter::add(const Model& model) {
  if (!state_ || !state_->file.pending()) return closed_error();
  const Result<std::shared_ptr<PackedModel>> packed = pack_model(model, unit(), num_components());
  if (packed) return add(**packed);
  return Error{packed.error().code,
               fmt::format("{}: {}", state_->target.string(), packed.error().message)};
}

Result<void> LibraryWriter::add(PackedModel& packed) {
  if (!state_ || !state_->file.pending()) return closed_error();
  if (!state_->index_digest.empty()) {
    return Error{ErrorCode::internal,
                 fmt::format("{}: expected no model after the index", state_->target.string())};
  }
  const Model& model = packed.model;
  if (state_->written.contains(model.name)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected each name once; rename one with NAME=FILE",
                             state_->target.string(), model.name)};
  }
  hdf5::start();
  try {
    if (state_->write(packed)) {
      state_->file.start_writeback();
      return {};
    }
  } catch (const std::bad_alloc&) {  // half a model is in the file: as bad as a partial write
  }
  const std::size_t bytes = model.ppf.offsets.size_bytes() + model.ppf.entries.size_bytes();
  return state_->fail(
      fmt::format("model '{}', whose table alone takes {} bytes", model.name, bytes));
}

Result<void> LibraryWriter::write_contents(const fs::path& file) {
  if (!state_) return closed_error();
  State& state = *state_;
  TRIVET_TRY_ASSIGN(LibraryWriter contents, create(file, state.header));
  TRIVET_TRY(contents.add(state.basis));
  contents.state_->columns_in = state.file.path().filename().string();
  for (const std::string& name : state.unlisted)
    contents.state_->written.emplace(name, state.written.at(name));
  const Result<void> published = contents.publish(Outlasts::process);
  if (published) state.unlisted.clear();
  return published;
}

Result<void> LibraryWriter::add_index(const NextLevel& next, std::size_t piece_bytes) {
  if (!state_ || !state_->file.pending()) return closed_error();
  State& state = *state_;
  if (!state.index_digest.empty()) {
    return Error{ErrorCode::internal, fmt::format("{}: expected one index", state.target.string())};
  }
  hdf5::start();
  if (H5Fflush(state.hdf5.get(), H5F_SCOPE_LOCAL) < 0) return state.fail("the models");
  TRIVET_TRY_ASSIGN(const auto mapped,
                    MappedFile::open(state.file.path(), std::numeric_limits<std::uint64_t>::max()));
  std::vector<FeaturesOfModel> features;
  std::uint32_t rank = 0;
  for (const auto& [name, written] : state.written) {
    const Model model =
        map_model(written.record, mapped.bytes(), mapped.owner(), state.num_components());
    for (const TriSpinFeatures& at_scale : model.features) features.push_back({rank, at_scale});
    ++rank;
  }
  const WrittenFeatures all{features, mapped.bytes()};
  const LevelPlace place{state.file.path(), rank, unit_name(state.header.unit), piece_bytes};
  Handle group;
  StoredGroup described;
  // While a level is written, the next one is computed.
  const auto compute_level = [&](std::size_t k) {
    return std::async(std::launch::async, [&next, &all, k] { return next(all, k); });
  };
  std::future<std::optional<LevelInPieces>> found = compute_level(0);
  for (std::size_t k = 0; const std::optional<LevelInPieces> level = found.get(); ++k) {
    found = compute_level(k + 1);
    if (k == 0) group = create_group(state.root.get(), "index");
    if (!group) return state.fail("the index");
    const std::string name = fmt::format("{:02}", k);
    StoredGroup& stored = described.groups[name];
    const Result<void> written = write_level(*level, name, group.get(), place, stored);
    state.file.start_writeback();
    if (written) continue;
    if (written.error().code != ErrorCode::io) return written;
    return state.fail(fmt::format("level {} of the index, of {} features", k, level->size()));
  }
  if (group) state.index_digest = format::digest(described);
  return {};
}

Result<void> LibraryWriter::publish(Outlasts end) {
  if (!state_ || !state_->file.pending()) return closed_error();
  hdf5::start();
  State& state = *state_;

  std::map<std::string, std::string> models;
  for (const auto& [name, model] : state.written) models.emplace(name, model.digest);
  std::map<std::string, std::string> children{{"models", format::digest({}, models)}};
  if (!state.write_directory(children.at("models"), children["directory"]))
    return state.fail("the directory of the models");
  if (state.num_components() > 0) children.emplace("trisi", state.basis_digest);
  if (!state.index_digest.empty()) children.emplace("index", state.index_digest);

  // The root is last: its checksum covers all other data.
  StoredAttributes root;
  root.emplace("format", attribute(format::kName));
  root.emplace("format_version_major", attribute(kLibraryVersionMajor));
  root.emplace("format_version_minor", attribute(kLibraryVersionMinor));
  root.emplace("producer", attribute(state.header.producer));
  root.emplace("length_unit", attribute(std::string(unit_name(state.header.unit))));
  root.emplace("axis_convention", attribute(kAxisConvention));
  root.emplace("parameters", attribute(state.header.parameters));
  root.emplace("num_models", attribute(static_cast<std::uint32_t>(models.size())));
  if (!state.columns_in.empty()) root.emplace(format::kColumnsIn, attribute(state.columns_in));
  root.emplace(format::kChecksum, attribute(format::digest(root, children)));
  if (!write_attributes(state.root.get(), root)) return state.fail("the attributes of the root");

  state.models = Handle();
  state.root = Handle();
  if (H5Fclose(state.hdf5.release()) < 0) return state.fail("the last bytes");
  return state.file.publish(end);
}

}  // namespace trivet
