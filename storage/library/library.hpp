/// The model library: one HDF5 file, written whole or not at all, opened by mapping it.
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

/// What a library says of itself.
struct LibraryHeader {
  LengthUnit unit = LengthUnit::meter;
  std::string producer;    ///< program and version that wrote the file
  std::string parameters;  ///< training parameters as one JSON object
  bool operator==(const LibraryHeader&) const = default;
};

/// The names of all models that are going to be added; none: nobody knows yet.
struct NamesToCome {
  std::size_t count = 0;
  std::size_t bytes = 0;  ///< of all names together

  void add(std::string_view name) noexcept {
    ++count;
    bytes += name.size();
  }
};

/// The features of all models of a library in the making, by the models' names.
struct WrittenFeatures {
  std::span<const FeaturesOfModel> of_models;
  std::span<const std::byte> mapped;  ///< the file that they lie in: see give_back_around
};

/// A model as it is going to lie in a library: checked, in columns with their checksums.
struct PackedModel;
/// What of adding a model takes longest, before there is a library to add it to.
///
/// unit            of the library
/// num_components  of its basis; 0: no features are kept
/// Errors: bad_data (broken model, features of another basis).
Result<std::shared_ptr<PackedModel>> pack_model(const Model& model, LengthUnit unit,
                                                std::size_t num_components);
/// How many bytes its datasets take.
std::uint64_t packed_bytes(const PackedModel& packed) noexcept;

/// Writes models one after the other into a temporary file beside `file`; `publish` makes it
/// visible. Peak memory is that of one model. Not for use by two threads at once, but for `pack`.
class LibraryWriter {
 public:
  /// names  make room for; thousands of models take long to add without. The file depends on them.
  /// Errors: bad_data (header of more than 60,000 bytes), cannot_create, io.
  static Result<LibraryWriter> create(const std::filesystem::path& file,
                                      const LibraryHeader& header, const NamesToCome& names = {});
  /// Under a name that nothing has yet, in the same file system, where it stays when it is not
  /// published: what `write_contents` told of it can be taken up. Errors: as above.
  static Result<LibraryWriter> create_lasting(const std::filesystem::path& file,
                                              const std::filesystem::path& name,
                                              const LibraryHeader& header,
                                              const NamesToCome& names = {});
  LibraryWriter(LibraryWriter&&) noexcept;
  LibraryWriter& operator=(LibraryWriter&&) noexcept;
  ~LibraryWriter();  ///< without publish: an older library stays, a temporary file goes

  /// What the features of the models to come have in common; at most once, before them. Nothing of an
  /// empty one. Errors: bad_data, io.
  Result<void> add(const TriSpinBasis& basis);
  /// Errors: bad_data (invalid or repeated name, broken model, features of another basis), io (disk
  /// full: says how much was needed).
  Result<void> add(const Model& model);
  /// Pre: packed with this library's unit and components. Errors: bad_data (repeated name), io.
  Result<void> add(PackedModel& model);
  LengthUnit unit() const noexcept;
  std::size_t num_components() const noexcept;  ///< of the basis; 0: there is none
  /// Tell in another file of the models that were added since this was last called. It is for
  /// `open_contents` and need only outlast the process. Also after writing has failed. Errors:
  /// cannot_create, io.
  Result<void> write_contents(const std::filesystem::path& file);
  /// Call `next` with the features of all models that were added, and add the levels that it gives,
  /// piece by piece: so that no level is in memory. At most once, after all models; no model may
  /// come after it.
  ///
  /// next         gives level k, or nothing when there are no more, while the level before is written;
  ///              models are named by their rank
  /// piece_bytes  of a level's features are in memory at a time; the file is the same for any
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

/// An opened library. Its columns lie in the mapped file. What is known of all models is checked
/// when it is opened; a part of a model, and a level of the index, must be checked before they are
/// first read: a library of thousands of models opens at once, and a scene pays for what it uses.
struct Library {
  std::filesystem::path file;
  LibraryHeader header;
  std::uint32_t version_minor = 0;  ///< of the file's format
  std::uint64_t file_bytes = 0;
  TriSpinBasis basis;
  std::vector<Model> models;                    ///< sorted by name
  FeatureIndex index;                           ///< none in files of before 1.4
  std::shared_ptr<const LibraryChecks> checks;  ///< none: models in memory are trusted

  /// Compare the bytes with their checksums and bounds, once. May be called from many threads.
  /// Errors: bad_data (names the model, the dataset and what is wrong).
  Result<void> check(std::uint32_t model, ModelPart part) const;
  /// Whether the file's bytes are still those that were opened: others may write it in place, while
  /// it is mapped. To be asked before an answer is worked out, and before it is given: 2 us. Where
  /// the file's names or rights were changed, what was checked is compared with its checksums again.
  /// Once changed it stays so; a file that takes its place by rename changes nothing.
  /// Errors: changed (says what to do).
  Result<void> unchanged() const;
  /// The same without comparing any bytes: those that were put back to their time are not seen.
  bool is_changed() const noexcept;
  /// The same of a level of the index.
  Result<void> check_level(std::size_t level) const;
  /// Ask for the bytes of a part that is not checked yet, so that they come while others are read.
  void ask_for(std::uint32_t model, ModelPart part) const noexcept;
  /// All parts of all models and all levels. Errors: of the first fault.
  Result<void> check_all() const;
  /// Give back the memory that holds what was read of the file, where all that the process has
  /// mapped is more than so many bytes. It is read again when it is needed again.
  void give_back(std::uint64_t more_than) const;
};

/// Open a library by mapping it: structure and extents are checked, and what is known of all
/// models. Files of before 1.4 have no directory: their structure is walked through.
///
/// Links, external storage, filters and datasets that the format does not name are refused.
///
/// writers  with `others` the file stays open, and Library::unchanged watches it
/// Errors: missing_input, bad_data (names the dataset and the bound it broke), io, changed (while it
/// was opened).
Result<Library> open_library(const std::filesystem::path& file, Writers writers = Writers::others);

/// Open what LibraryWriter::write_contents told of, in the folder of the file that the models lie in.
/// Errors: as above.
Result<Library> open_contents(const std::filesystem::path& file);

/// Open a library and check all of it: every byte against its checksum, every value against its
/// bounds, and the directory against what HDF5 finds. Errors: as above.
Result<Library> verify_library(const std::filesystem::path& file);

}  // namespace trivet
