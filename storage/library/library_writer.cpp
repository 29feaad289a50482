#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <system_error>

#include "storage/file.hpp"
#include "storage/library.hpp"
#include "storage/library/directory_columns.hpp"
#include "storage/library/library_format.hpp"
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

StoredAttributes model_attributes(const Model& model) {
  const Symmetry::Axis axis = model.symmetry.axis.value_or(Symmetry::Axis{{0, 0, 0}, {0, 0, 0}});
  StoredAttributes out;
  out.emplace("source", attribute(model.source));
  out.emplace("source_xxh3", attribute(model.source_xxh3));
  out.emplace("fingerprint", attribute(model.fingerprint));
  out.emplace("diameter", attribute(model.diameter));
  out.emplace("centre", attribute(model.center));
  out.emplace("sample_spacing", attribute(model.sample_spacing));
  out.emplace("symmetry_declared", attribute(model.symmetry.declared));
  out.emplace("symmetry_axis_direction", attribute(Eigen::Vector3f(axis.direction)));
  out.emplace("symmetry_axis_point", attribute(Eigen::Vector3f(axis.point)));
  return out;
}

StoredAttributes table_attributes(const PpfTableView& table) {
  const PpfQuantization& quantization = table.quantization;
  StoredAttributes out;
  out.emplace("num_references", attribute(table.num_references));
  out.emplace("distance_step", attribute(quantization.distance_step));
  out.emplace("num_distance_bins", attribute(quantization.num_distance_bins));
  out.emplace("num_angle_bins", attribute(quantization.num_angle_bins));
  return out;
}

StoredAttributes basis_attributes(const TriSpinBasis& basis) {
  StoredAttributes out;
  out.emplace("support", attribute(basis.support));
  out.emplace("code_step", attribute(basis.code_step));
  out.emplace("all_energy", attribute(static_cast<float>(basis.components.all_energy)));
  return out;
}

std::string_view symbol(LengthUnit unit) { return unit == LengthUnit::meter ? "m" : "mm"; }

constexpr std::string_view kAxisConvention =
    "models: as in their source; scenes: x right, y down, z forward";

Error over() { return {ErrorCode::io, "this library was published, or its writing has failed"}; }

}  // namespace

/// What is kept of a model that was written.
struct Written {
  std::string digest;
  ModelRecord record;
};

struct LibraryWriter::State {
  fs::path target;
  LibraryHeader header;
  PendingFile file;
  Handle hdf5, root, models;               ///< destroyed in reverse order
  std::map<std::string, Written> written;  ///< models, by name
  std::size_t num_components = 0;          ///< of the basis; 0: there is none
  std::string basis_digest, index_digest;

  // false when HDF5 failed
  bool write(const TriSpinBasis& basis);
  bool write(const Model& model);
  bool write_table(hid_t parent, const Model& model, StoredGroup& described) const;
  bool write_features(hid_t parent, const std::string& name, const TriSpinFeatures& features,
                      StoredGroup& described) const;
  bool write_directory(const std::string& models_digest, std::string& digest) const;
  /// What writes datasets into a group, and takes up how they lie there.
  auto into(hid_t group, StoredGroup& described) const {
    return [this, group, &described](const format::DatasetSpec& spec,
                                     std::span<const std::byte> bytes) {
      const auto [at, added] = described.datasets.emplace(
          spec.name, hdf5::describe(spec, bytes.size(), xxh3_hex(bytes), symbol(header.unit),
                                    num_components, 0));
      return hdf5::write_dataset(group, at->first, at->second, bytes);
    };
  }

  /// What could not be written; the temporary file goes.
  Error fail(const std::string& what);
};

// The space comes first: HDF5 holds on to a file that it cannot flush.
Error LibraryWriter::State::fail(const std::string& what) {
  std::error_code unknown;
  const fs::space_info space = fs::space(file.path(), unknown);
  Error error{ErrorCode::io,
              fmt::format("{}: cannot write {}; {} bytes are free on the disk; free some, or raise "
                          "the limit on the size of files",
                          target.string(), what, unknown ? 0 : space.available)};
  file.discard();
  return error;
}

// A dataset's bytes are gathered when it is written: one column more than the model at a time.
bool LibraryWriter::State::write(const Model& model) {
  const Handle group = create_group(models.get(), model.name);
  StoredGroup described{model_attributes(model), {}, {}};
  if (!group || !write_attributes(group.get(), described.attributes)) return false;
  const auto put = into(group.get(), described);
  const TrianglesView& triangles = model.triangles;
  if (!put(format::kVertices, gather(model.vertices)) ||
      !put(format::kTriangles, gather<std::uint32_t>({triangles.a, triangles.b, triangles.c})) ||
      !put(format::kSamples, gather(model.samples)) ||
      !put(format::kSampleNormals, gather(model.sample_normals)) ||
      !put(format::kSampleViews, std::as_bytes(std::span(model.sample_views))) ||
      !put(format::kSymmetryPoses, gather(model.symmetry.poses)) ||
      !put(format::kNearSymmetries, gather(model.near_symmetries)) ||
      !put(format::kNearAxis, gather(model.near_axis)) ||
      !write_table(group.get(), model, described))
    return false;
  for (std::size_t k = 0; k < model.features.size(); ++k) {
    if (!write_features(group.get(), std::string(format::kFeatureGroups[k]), model.features[k],
                        described))
      return false;
  }
  if (H5Fflush(hdf5.get(), H5F_SCOPE_LOCAL) < 0) return false;
  written.emplace(model.name, Written{format::digest(described), record_of(model, described)});
  return true;
}

bool LibraryWriter::State::write_table(hid_t parent, const Model& model,
                                       StoredGroup& described) const {
  const Handle group = create_group(parent, "ppf");
  StoredGroup& table = described.groups["ppf"];
  table.attributes = table_attributes(model.ppf);
  const auto put = into(group.get(), table);
  return group && write_attributes(group.get(), table.attributes) &&
         put(format::kPpfPoints, gather(model.ppf_points)) &&
         put(format::kPpfNormals, gather(model.ppf_normals)) &&
         put(format::kPpfOffsets, std::as_bytes(model.ppf.offsets)) &&
         put(format::kPpfEntries, std::as_bytes(model.ppf.entries));
}

bool LibraryWriter::State::write_features(hid_t parent, const std::string& name,
                                          const TriSpinFeatures& features,
                                          StoredGroup& described) const {
  if (num_components == 0) return true;
  const Handle group = create_group(parent, name);
  StoredGroup& stored = described.groups[name];
  stored.attributes.emplace("resolution", attribute(features.resolution));
  const auto put = into(group.get(), stored);
  return group && write_attributes(group.get(), stored.attributes) &&
         put(format::kKeypoints, gather(features.keypoints)) &&
         put(format::kFrames, std::as_bytes(std::span(features.frames))) &&
         put(format::kFeatures, std::as_bytes(std::span(features.codes)));
}

bool LibraryWriter::State::write(const TriSpinBasis& basis) {
  const PcaBasis& pca = basis.components;
  const Handle group = create_group(root.get(), "trisi");
  StoredGroup stored{basis_attributes(basis), {}, {}};
  const auto put = into(group.get(), stored);
  num_components = pca.size();
  const bool is_written = group && write_attributes(group.get(), stored.attributes) &&
                          put(format::kMeanImage, std::as_bytes(std::span(pca.mean))) &&
                          put(format::kImageComponents, std::as_bytes(std::span(pca.components))) &&
                          put(format::kImageEnergies, std::as_bytes(std::span(pca.energies)));
  basis_digest = format::digest(stored);
  return is_written;
}

bool LibraryWriter::State::write_directory(const std::string& models_digest,
                                           std::string& digest) const {
  DirectoryColumns all;
  for (const auto& [name, model] : written) all.add(model.record);
  const Handle group = create_group(root.get(), "directory");
  StoredGroup stored;
  const auto put = into(group.get(), stored);
  const auto bytes = [](const auto& column) { return std::as_bytes(std::span(column)); };
  if (!group || !put(format::kNames, bytes(all.names)) || !put(format::kTexts, bytes(all.texts)) ||
      !put(format::kTextEnds, bytes(all.text_ends)) ||
      !put(format::kFingerprints, bytes(all.fingerprints)) ||
      !put(format::kDiameters, bytes(all.diameter)) || !put(format::kCenters, bytes(all.center)) ||
      !put(format::kSpacings, bytes(all.spacing)) || !put(format::kAxes, bytes(all.axis)) ||
      !put(format::kDeclared, bytes(all.declared)) ||
      !put(format::kNearAxes, bytes(all.near_axis)) ||
      !put(format::kMotions, gather(all.motions)) ||
      !put(format::kMotionEnds, bytes(all.motion_ends)) || !put(format::kSteps, bytes(all.step)) ||
      !put(format::kCounts, bytes(all.counts)) ||
      !put(format::kResolutions, bytes(all.resolution)) ||
      !put(format::kPlaces, bytes(all.places)) || !put(format::kChecksums, bytes(all.checksums)))
    return false;
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

Result<LibraryWriter> LibraryWriter::create(const fs::path& file, const LibraryHeader& header) {
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
  auto pending = PendingFile::create(file);
  if (!pending) return pending.error();

  hdf5::start();
  auto state =
      std::make_unique<State>(State{file, header, *std::move(pending), {}, {}, {}, {}, 0, {}, {}});
  const Handle creation = hdf5::creation_of(H5P_FILE_CREATE);
  const Handle access = hdf5::file_access();
  state->hdf5 =
      Handle(H5Fcreate(state->file.path().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()));
  state->root = Handle(H5Gopen2(state->hdf5.get(), "/", H5P_DEFAULT));
  state->models = create_group(state->root.get(), "models");
  if (!state->hdf5 || !state->root || !state->models) return state->fail("its first bytes");
  return LibraryWriter(std::move(state));
}

Result<void> LibraryWriter::add(const TriSpinBasis& basis) {
  if (!state_ || !state_->file.pending()) return over();
  if (auto good = format::check_basis(basis); !good) return good;
  if (state_->num_components > 0 || !state_->written.empty()) {
    return Error{ErrorCode::internal,
                 fmt::format("{}: expected one basis, before all models", state_->target.string())};
  }
  hdf5::start();
  if (state_->write(basis)) return {};
  return state_->fail("the basis of the features");
}

Result<void> LibraryWriter::add(const Model& model) {
  if (!state_ || !state_->file.pending()) return over();
  if (!state_->index_digest.empty()) {
    return Error{ErrorCode::internal,
                 fmt::format("{}: expected no model after the index", state_->target.string())};
  }
  if (auto good = format::check_model(model); !good) return good;
  if (state_->written.contains(model.name)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected each name once; rename one with NAME=FILE",
                             state_->target.string(), model.name)};
  }
  for (const TriSpinFeatures& features : model.features) {
    if (features.size() == 0 || features.num_components == state_->num_components) continue;
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected features of {} components, found {}",
                             state_->target.string(), model.name, state_->num_components,
                             features.num_components)};
  }
  hdf5::start();
  try {
    if (state_->write(model)) return {};
  } catch (const std::bad_alloc&) {  // half a model is in the file: as bad as half a write
  }
  const std::size_t bytes = model.ppf.offsets.size_bytes() + model.ppf.entries.size_bytes();
  return state_->fail(
      fmt::format("model '{}', whose table alone takes {} bytes", model.name, bytes));
}

Result<void> LibraryWriter::add_index(const NextLevel& next, std::size_t piece_bytes) {
  if (!state_ || !state_->file.pending()) return over();
  State& state = *state_;
  if (!state.index_digest.empty()) {
    return Error{ErrorCode::internal, fmt::format("{}: expected one index", state.target.string())};
  }
  hdf5::start();
  if (H5Fflush(state.hdf5.get(), H5F_SCOPE_LOCAL) < 0) return state.fail("the models");
  const auto mapped =
      MappedFile::open(state.file.path(), std::numeric_limits<std::uint64_t>::max());
  if (!mapped) return mapped.error();
  std::vector<FeaturesOfModel> features;
  std::uint32_t rank = 0;
  for (const auto& [name, written] : state.written) {
    const Model model =
        map_model(written.record, mapped->bytes(), mapped->owner(), state.num_components);
    for (const TriSpinFeatures& at_scale : model.features) features.push_back({rank, at_scale});
    ++rank;
  }
  const WrittenFeatures all{features, mapped->bytes()};
  const LevelPlace place{state.file.path(), rank, symbol(state.header.unit), piece_bytes};
  Handle group;
  StoredGroup described;
  for (std::size_t k = 0; const std::optional<LevelInPieces> level = next(all, k); ++k) {
    if (k == 0) group = create_group(state.root.get(), "index");
    if (!group) return state.fail("the index");
    const std::string name = fmt::format("{:02}", k);
    StoredGroup& stored = described.groups[name];
    const Result<void> written = write_level(*level, name, group.get(), place, stored);
    if (written) continue;
    if (written.error().code != ErrorCode::io) return written;
    return state.fail(fmt::format("level {} of the index, of {} features", k, level->size()));
  }
  if (group) state.index_digest = format::digest(described);
  return {};
}

Result<void> LibraryWriter::publish() {
  if (!state_ || !state_->file.pending()) return over();
  hdf5::start();
  State& state = *state_;

  std::map<std::string, std::string> models;
  for (const auto& [name, model] : state.written) models.emplace(name, model.digest);
  std::map<std::string, std::string> children{{"models", format::digest({}, models)}};
  if (!state.write_directory(children.at("models"), children["directory"]))
    return state.fail("the directory of the models");
  if (state.num_components > 0) children.emplace("trisi", state.basis_digest);
  if (!state.index_digest.empty()) children.emplace("index", state.index_digest);

  // The root comes last: its checksum covers all that was written.
  StoredAttributes root;
  root.emplace("format", attribute(format::kName));
  root.emplace("format_version_major", attribute(kLibraryVersionMajor));
  root.emplace("format_version_minor", attribute(kLibraryVersionMinor));
  root.emplace("producer", attribute(state.header.producer));
  root.emplace("length_unit", attribute(symbol(state.header.unit)));
  root.emplace("axis_convention", attribute(kAxisConvention));
  root.emplace("parameters", attribute(state.header.parameters));
  root.emplace("num_models", attribute(static_cast<std::uint32_t>(models.size())));
  root.emplace(format::kChecksum, attribute(format::digest(root, children)));
  if (!write_attributes(state.root.get(), root)) return state.fail("the attributes of the root");

  state.models = Handle();
  state.root = Handle();
  if (H5Fclose(state.hdf5.release()) < 0) return state.fail("the last bytes");
  return state.file.publish();
}

}  // namespace trivet
