#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <system_error>

#include "storage/file.hpp"
#include "storage/library.hpp"
#include "storage/library/hdf5.hpp"
#include "storage/library/library_format.hpp"
#include "storage/library/model_record.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using hdf5::Handle;

// ---- values as attributes

template <class T, std::size_t N>
StoredAttribute attribute(ElementType type, const std::array<T, N>& values) {
  StoredAttribute out{type, {N}, std::vector<std::byte>(sizeof(values))};
  std::memcpy(out.bytes.data(), values.data(), sizeof(values));
  return out;
}

template <class T>
StoredAttribute attribute(ElementType type, T value) {
  StoredAttribute out = attribute(type, std::array{value});
  out.shape.clear();
  return out;
}

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

// ---- plain data to HDF5; false when it failed

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

// All links inside the checksummed object header, too, which may continue: HDF5 1.10 crashes when
// it lists a damaged group of the other kind, which it would make of more than 8 links.
Handle create_group(hid_t parent, const std::string& name) {
  constexpr unsigned kMostLinks = 65535;
  const Handle creation = creation_of(H5P_GROUP_CREATE);
  if (!creation || H5Pset_link_phase_change(creation.get(), kMostLinks, 0) < 0) return {};
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
}

/// Takes up where the dataset lies.
bool write_dataset(hid_t group, const std::string& name, StoredDataset& dataset,
                   std::span<const std::byte> bytes) {
  const Handle creation = creation_of(H5P_DATASET_CREATE);
  if (H5Pset_layout(creation.get(), H5D_CONTIGUOUS) < 0 ||
      H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY) < 0 ||
      H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER) < 0) {
    return false;
  }
  const Handle space = space_of(dataset.shape);
  const hid_t type = number_type(dataset.type);
  const Handle stored(
      H5Dcreate2(group, name.c_str(), type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  if (!stored || !write_attributes(stored.get(), dataset.attributes)) return false;
  if (bytes.empty()) return true;
  dataset.offset = H5Dget_offset(stored.get());
  return dataset.offset != HADDR_UNDEF &&
         H5Dwrite(stored.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0;
}

// ---- a model as bytes

/// Rows that lie apart in memory, gathered as they lie in the file.
template <class T>
Column<std::byte> gather(std::initializer_list<std::span<const T>> rows) {
  Column<std::byte> out;
  for (const auto row : rows) {
    const auto bytes = std::as_bytes(row);
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
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

StoredDataset describe(const format::DatasetSpec& spec, std::span<const std::byte> bytes,
                       std::string_view unit, std::size_t num_components, std::size_t stride) {
  StoredDataset out{
      spec.type, {spec.shape.begin(), spec.shape.begin() + spec.rank}, 0, bytes.size(), {}};
  std::ranges::replace(out.shape, format::kComponents, std::uint64_t{num_components});
  std::ranges::replace(out.shape, format::kStride, std::uint64_t{stride});
  std::uint64_t row_bytes = size_of(spec.type);
  for (const std::uint64_t n : out.shape) row_bytes *= n == format::kRows ? 1 : n;
  for (std::uint64_t& n : out.shape) n = n == format::kRows ? bytes.size() / row_bytes : n;
  out.attributes.emplace("long_name", attribute(spec.long_name));
  out.attributes.emplace("units", attribute(spec.units.empty() ? unit : spec.units));
  out.attributes.emplace(format::kDataChecksum, attribute(xxh3_hex(bytes)));
  return out;
}

StoredAttributes model_attributes(const Model& model) {
  const Symmetry::Axis axis = model.symmetry.axis.value_or(Symmetry::Axis{{0, 0, 0}, {0, 0, 0}});
  StoredAttributes out;
  out.emplace("source", attribute(model.source));
  out.emplace("source_xxh3", attribute(model.source_xxh3));
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

/// What the directory keeps of a model, whose datasets lie where `described` says.
ModelRecord record_of(const Model& model, const StoredGroup& described) {
  ModelRecord record;
  Model& traits = record.traits;
  traits.name = model.name;
  traits.source = model.source;
  traits.source_xxh3 = model.source_xxh3;
  traits.diameter = model.diameter;
  traits.center = model.center;
  traits.sample_spacing = model.sample_spacing;
  traits.symmetry = model.symmetry;
  traits.near_symmetries = model.near_symmetries;
  traits.near_axis = model.near_axis;
  traits.ppf.quantization = model.ppf.quantization;
  traits.ppf.num_references = model.ppf.num_references;
  for (std::size_t k = 0; k < model.features.size(); ++k)
    traits.features[k].resolution = model.features[k].resolution;
  for (std::size_t c = 0; c < format::kModelColumns.size(); ++c) {
    const format::DatasetSpec& spec = format::kModelColumns[c].spec;
    const StoredGroup* const group =
        spec.group.empty() ? &described : Taker::below(described, std::string(spec.group));
    if (group == nullptr) continue;
    const StoredDataset& dataset = group->datasets.at(std::string(spec.name));
    const StoredAttribute& sum = dataset.attributes.at(std::string(format::kDataChecksum));
    const std::string_view hex(reinterpret_cast<const char*>(sum.bytes.data()), sum.bytes.size());
    record.columns[c] = {dataset.offset, dataset.bytes, Xxh3::parse(hex).value_or(Xxh3{})};
  }
  return record;
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

/// All models as columns: the datasets of /directory.
struct Directory {
  std::string names, texts;
  std::vector<std::uint64_t> text_ends, motion_ends, places, checksums;
  std::vector<float> diameter, center, spacing, axis, near_axis, step, resolution;
  std::vector<Pose> motions;
  std::vector<std::uint8_t> declared;
  std::vector<std::uint32_t> counts;

  void add(const ModelRecord& record);
};

void add_vector(const Eigen::Vector3f& v, std::vector<float>& out) {
  out.insert(out.end(), v.data(), v.data() + 3);
}

void add_axis(const std::optional<Symmetry::Axis>& axis, std::vector<float>& out) {
  const Symmetry::Axis a = axis.value_or(Symmetry::Axis{{0, 0, 0}, {0, 0, 0}});
  add_vector(a.direction, out);
  add_vector(a.point, out);
}

void Directory::add(const ModelRecord& record) {
  const Model& model = record.traits;
  std::string name = model.name;
  name.resize(format::kNameBytes, '\0');
  names += name;
  for (const std::string* const text : {&model.source, &model.source_xxh3}) {
    texts += *text;
    text_ends.push_back(texts.size());
  }
  diameter.push_back(model.diameter);
  add_vector(model.center, center);
  spacing.push_back(model.sample_spacing);
  add_axis(model.symmetry.axis, axis);
  declared.push_back(model.symmetry.declared ? 1 : 0);
  add_axis(model.near_axis, near_axis);
  for (const std::vector<Pose>* const of_kind : {&model.symmetry.poses, &model.near_symmetries}) {
    motions.insert(motions.end(), of_kind->begin(), of_kind->end());
    motion_ends.push_back(motions.size());
  }
  const PpfQuantization& quantization = model.ppf.quantization;
  step.push_back(quantization.distance_step);
  counts.insert(counts.end(), {model.ppf.num_references, quantization.num_distance_bins,
                               quantization.num_angle_bins});
  for (const TriSpinFeatures& features : model.features) resolution.push_back(features.resolution);
  for (const StoredColumn& column : record.columns) {
    places.insert(places.end(), {column.offset, column.bytes});
    checksums.insert(checksums.end(), {column.checksum.high, column.checksum.low});
  }
}

struct LibraryWriter::State {
  fs::path target;
  LibraryHeader header;
  PendingFile file;
  Handle hdf5, root, models;               ///< destroyed in reverse order
  std::map<std::string, Written> written;  ///< models, by name
  std::size_t num_components = 0;          ///< of the basis; 0: there is none
  std::size_t stride = 0;                  ///< of codes in the index
  std::string basis_digest, index_digest;

  // false when HDF5 failed
  bool write(const TriSpinBasis& basis);
  bool write(const Model& model);
  bool write_table(hid_t parent, const Model& model, StoredGroup& described) const;
  bool write_features(hid_t parent, const std::string& name, const TriSpinFeatures& features,
                      StoredGroup& described) const;
  bool write(const FeatureLevel& level, hid_t index, StoredGroup& described);
  bool write_directory(const std::string& models_digest, std::string& digest) const;
  /// What writes datasets into a group, and takes up how they lie there.
  auto into(hid_t group, StoredGroup& described) const {
    return [this, group, &described](const format::DatasetSpec& spec,
                                     std::span<const std::byte> bytes) {
      const auto [at, added] = described.datasets.emplace(
          spec.name, describe(spec, bytes, symbol(header.unit), num_components, stride));
      return write_dataset(group, at->first, at->second, bytes);
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

bool LibraryWriter::State::write(const FeatureLevel& level, hid_t index, StoredGroup& described) {
  const std::string name = fmt::format("{:02}", described.groups.size());
  const Handle group = create_group(index, name);
  StoredGroup& stored = described.groups[name];
  stride = level.stride;
  stored.attributes.emplace("resolution", attribute(level.resolution));
  stored.attributes.emplace("stride", attribute(static_cast<std::uint32_t>(level.stride)));
  const auto put = into(group.get(), stored);
  return group && write_attributes(group.get(), stored.attributes) &&
         put(format::kLevelModels, std::as_bytes(std::span(level.models))) &&
         put(format::kListCentroids, std::as_bytes(std::span(level.centroids))) &&
         put(format::kListOffsets, std::as_bytes(std::span(level.offsets))) &&
         put(format::kListCodes, std::as_bytes(std::span(level.codes))) &&
         put(format::kListModel, std::as_bytes(std::span(level.model))) &&
         put(format::kListKeypoints, gather(level.keypoints)) &&
         put(format::kListFrames, std::as_bytes(std::span(level.frames)));
}

bool LibraryWriter::State::write_directory(const std::string& models_digest,
                                           std::string& digest) const {
  Directory all;
  for (const auto& [name, model] : written) all.add(model.record);
  const Handle group = create_group(root.get(), "directory");
  StoredGroup stored;
  const auto put = into(group.get(), stored);
  const auto bytes = [](const auto& column) { return std::as_bytes(std::span(column)); };
  if (!group || !put(format::kNames, bytes(all.names)) || !put(format::kTexts, bytes(all.texts)) ||
      !put(format::kTextEnds, bytes(all.text_ends)) ||
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
  auto state = std::make_unique<State>(
      State{file, header, *std::move(pending), {}, {}, {}, {}, 0, 0, {}, {}});
  const Handle creation = creation_of(H5P_FILE_CREATE);
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

Result<void> LibraryWriter::add_index(const NextLevel& next) {
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
  Handle group;
  StoredGroup described;
  for (std::size_t k = 0; const std::optional<FeatureLevel> level = next(features, k); ++k) {
    if (k == 0) group = create_group(state.root.get(), "index");
    if (!group) return state.fail("the index");
    if (const Result<void> good = format::check_level(*level, state.written.size()); !good)
      return Error{ErrorCode::internal, good.error().message};
    if (!state.write(*level, group.get(), described))
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
