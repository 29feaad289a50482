/// The model library: one HDF5 file, written atomically, opened as a mapped file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/feature_index.hpp"
#include "storage/data/length_unit.hpp"
#include "storage/data/model.hpp"
#include "storage/files/file.hpp"

namespace trivet {

inline constexpr std::uint32_t kLibraryVersionMajor = 1;  ///< another major version is refused
inline constexpr std::uint32_t kLibraryVersionMinor = 5;  ///< a newer minor version is read

/// Header of a library.
struct LibraryHeader {
  LengthUnit unit = LengthUnit::meter;
  std::string producer;    ///< program and version that wrote the file
  std::string parameters;  ///< training parameters as one JSON object
  bool operator==(const LibraryHeader&) const = default;
};

/// The names of all models to be added; none: not yet known.
struct NamesToCome {
  std::size_t count = 0;
  std::size_t bytes = 0;  ///< total length of the names

  void add(std::string_view name) noexcept {
    ++count;
    bytes += name.size();
  }
};

/// The features of all models of a library being written, by the models' names.
struct WrittenFeatures {
  std::span<const FeaturesOfModel> of_models;
  std::span<const std::byte> mapped;  ///< mapped file with the features: see release_pages_around
};

/// A model ready to be written to a library: checked, in columns with their checksums.
struct PackedModel;
/// The slowest part of adding a model, which needs no open library.
///
/// unit            unit of the library
/// num_components  size of the library's basis; 0: no features are stored
/// Errors: bad_data (broken model, features of another basis).
Result<std::shared_ptr<PackedModel>> pack_model(const Model& model, LengthUnit unit,
                                                std::size_t num_components);
/// Total size of its datasets in bytes.
std::uint64_t packed_bytes(const PackedModel& packed) noexcept;

/// Writes models one after the other to a temporary file beside `file`; `publish` makes it visible.
/// Peak memory is that of one model. Not thread-safe.
class LibraryWriter {
 public:
  /// names  names to reserve space for; thousands of models are slow to add without them. The file
  ///        depends on them.
  /// Errors: bad_data (header of more than 60,000 bytes), cannot_create, io.
  static Result<LibraryWriter> create(const std::filesystem::path& file,
                                      const LibraryHeader& header, const NamesToCome& names = {});
  /// Create with an unused name in the same file system. The file stays if it is not published, and
  /// open_contents can open what `write_contents` recorded. Errors: as above.
  static Result<LibraryWriter> create_lasting(const std::filesystem::path& file,
                                              const std::filesystem::path& name,
                                              const LibraryHeader& header,
                                              const NamesToCome& names = {});
  LibraryWriter(LibraryWriter&&) noexcept;
  LibraryWriter& operator=(LibraryWriter&&) noexcept;
  ~LibraryWriter();  ///< without publish: an older library stays, a temporary file is removed

  /// Set the basis of the features of all following models; at most once, before any model. An
  /// empty basis writes nothing. Errors: bad_data, io.
  Result<void> add(const TriSpinBasis& basis);
  /// Add a model. Errors: bad_data (invalid or repeated name, broken model, features of another
  /// basis), io (disk full: states the space needed).
  Result<void> add(const Model& model);
  /// Pre: packed with this library's unit and number of components. Errors: bad_data (repeated
  /// name), io.
  Result<void> add(PackedModel& model);
  LengthUnit unit() const noexcept;
  std::size_t num_components() const noexcept;  ///< size of the basis; 0: no basis
  /// Write a contents file, for `open_contents`, that describes the models added since the last
  /// call. It need only survive the process. Allowed after a failed write. Errors: cannot_create,
  /// io.
  Result<void> write_contents(const std::filesystem::path& file);
  /// Call `next` with the features of all added models, and add the levels that it returns in
  /// pieces, so that no level is in memory as a whole. At most once, after all models; no model may
  /// be added after it.
  ///
  /// next         returns level k, or nothing after the last one, while the previous level is
  ///              written; models are identified by their rank
  /// piece_bytes  limit on the features of a level in memory; does not affect the file
  /// Errors: bad_data, io.
  using NextLevel =
      std::function<std::optional<LevelInPieces>(const WrittenFeatures&, std::size_t k)>;
  static constexpr std::size_t kPieceBytes = std::size_t{64} << 20U;
  Result<void> add_index(const NextLevel& next, std::size_t piece_bytes = kPieceBytes);
  /// Close and publish the file (PendingFile::publish). Errors: cannot_create (rename), io.
  Result<void> publish(Outlasts end = Outlasts::power_failure);

 private:
  struct State;
  explicit LibraryWriter(std::unique_ptr<State> state);
  static Result<LibraryWriter> begin(Result<PendingFile> file, const std::filesystem::path& target,
                                     const LibraryHeader& header, const NamesToCome& names);
  std::unique_ptr<State> state_;
};

class LibraryChecks;

/// Extents of a level of the index, and the models that it describes.
struct LevelShape {
  float resolution = 0;                     ///< see FeatureLevel
  std::span<const std::uint32_t> models{};  ///< indices of the models with features
  std::size_t num_features = 0, code_bytes = 0;
};

/// Levels of an index, each of which is checked before it is given.
class FeatureLevels {
 public:
  FeatureLevels() = default;
  /// Levels of a library with this number of models.
  ///
  /// checks  null: the levels are trusted
  explicit FeatureLevels(FeatureIndex levels, std::size_t num_models = 0,
                         std::shared_ptr<const LibraryChecks> checks = {});

  std::size_t size() const noexcept { return levels_ ? levels_->size() : 0; }
  bool empty() const noexcept { return size() == 0; }
  /// Pre: level < size(), as for `level`.
  LevelShape shape(std::size_t level) const;
  /// A level whose bytes have been compared with their checksums and whose values with their
  /// bounds, once. Thread-safe. Errors: damaged (names the dataset and the fault).
  Result<const FeatureLevel*> level(std::size_t level) const;

 private:
  const FeatureLevel& at(std::size_t level) const;

  std::shared_ptr<const FeatureIndex> levels_;
  std::size_t num_models_ = 0;
  std::shared_ptr<const LibraryChecks> checks_;
};

/// An open library. Its columns lie in the mapped file. Metadata of all models is checked on
/// opening; each part of a model and each level of the index is checked when it is first asked for.
/// So a library of thousands of models opens at once, and a scene pays only for what it uses.
/// Copies share all data.
struct Library {
  Library() = default;
  /// A library in memory, or what a reader found in a file.
  ///
  /// all_models  sorted by name
  /// checks      null: the models are trusted
  explicit Library(std::vector<Model> all_models, FeatureLevels levels = {},
                   std::shared_ptr<const LibraryChecks> checks = {});

  std::filesystem::path file;
  LibraryHeader header;
  std::uint32_t version_minor = 0;  ///< minor version of the file's format
  std::uint64_t file_bytes = 0;
  TriSpinBasis basis;
  std::span<const ModelInfo> models;  ///< sorted by name; shared with copies of the library
  FeatureLevels index;                ///< empty for files older than version 1.4

  /// The extents of a model's columns. Pre: model < models.size(), as for all that follows.
  ModelShape shape(std::uint32_t model) const;
  /// Whether any model was trained with point pairs.
  bool has_pairs() const noexcept;

  /// Parts of a model, valid as long as the library or a copy of it. When a part is first asked
  /// for, its bytes are compared with their checksums and its values with their bounds, once.
  /// Thread-safe. Errors: damaged (names the model, the dataset and the fault).
  Result<const ModelSurface*> surface(std::uint32_t model) const;
  Result<const ModelSamples*> samples(std::uint32_t model) const;
  Result<const ModelPairs*> pairs(std::uint32_t model) const;
  Result<const ModelFeatures*> features(std::uint32_t model) const;
  /// A model with all its parts. Errors: as above, of the first damaged part.
  Result<Model> model(std::uint32_t model) const;

  /// Check that the bytes of the file have not changed since opening: other processes may write it
  /// in place while it is mapped. Call before an answer is computed and before it is returned: 2
  /// us. If names or rights of the file changed, all data checked so far is compared with its
  /// checksums again. A change is permanent; replacing the file by rename is not a change.
  /// Errors: changed (states the remedy).
  Result<void> unchanged() const;
  /// As unchanged(), without comparing bytes: changes with a reset modification time go unnoticed.
  bool is_changed() const noexcept;
  /// Start loading the bytes of a part that is not checked yet, while others are read.
  void ask_for(std::uint32_t model, ModelPart part) const noexcept;
  /// Check all parts of all models and all levels. Errors: those of the first fault.
  Result<void> check_all() const;
  /// Release the memory of the file's pages if all mappings of the process exceed this size. Pages
  /// are loaded again when needed.
  void release_memory(std::uint64_t more_than) const;

 private:
  struct Contents {
    std::vector<ModelInfo> infos;
    std::vector<ModelColumns> columns;  // by model
    std::shared_ptr<const LibraryChecks> checks;
  };
  const ModelColumns& columns_of(std::uint32_t model) const;
  Result<void> check(std::uint32_t model, ModelPart part) const;
  template <class Columns>
  Result<const Columns*> checked(std::uint32_t model, ModelPart part) const;

  std::shared_ptr<const Contents> contents_;  // null: empty
};

/// Open a library as a mapped file. Structure, extents and metadata of all models are checked.
/// Files older than version 1.4 have no directory, so their structure is traversed.
///
/// Links, external storage, filters and datasets that the format does not name are refused.
///
/// writers  with `others`, the file stays open, and Library::unchanged watches it
/// Errors: missing_input, bad_data (names the dataset and the violated bound), io, changed (while
/// it was opened).
Result<Library> open_library(const std::filesystem::path& file, Writers writers = Writers::others);

/// Open the contents file of LibraryWriter::write_contents, in the folder of the file with the
/// models.
/// Errors: as above.
Result<Library> open_contents(const std::filesystem::path& file);

/// Open a library and check all of it: every byte against its checksum, every value against its
/// bounds, and the directory against HDF5's structure. Errors: as above.
Result<Library> verify_library(const std::filesystem::path& file);

}  // namespace trivet
