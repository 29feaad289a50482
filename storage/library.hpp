/// The model library: one HDF5 file, written whole or not at all, opened by mapping it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "storage/length_unit.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"

namespace trivet {

inline constexpr std::uint32_t kLibraryVersionMajor = 1;  ///< another major version is refused
inline constexpr std::uint32_t kLibraryVersionMinor = 3;  ///< a newer minor version is read

struct LibraryHeader {
  LengthUnit unit = LengthUnit::meter;
  std::string producer;    ///< program and version that wrote the file
  std::string parameters;  ///< training parameters as one JSON object
};

/// Writes models one after the other into a temporary file beside `file`; `publish` makes it
/// visible. Peak memory is that of one model. Not for use by two threads at once.
class LibraryWriter {
 public:
  /// Errors: bad_data (header of more than 60,000 bytes), cannot_create, io.
  static Result<LibraryWriter> create(const std::filesystem::path& file,
                                      const LibraryHeader& header);
  LibraryWriter(LibraryWriter&&) noexcept;
  LibraryWriter& operator=(LibraryWriter&&) noexcept;
  ~LibraryWriter();  ///< without publish: removes the temporary file, an older library stays

  /// What the features of the models to come have in common; at most once, before them. Errors:
  /// bad_data, io.
  Result<void> add(const TriSpinBasis& basis);
  /// Errors: bad_data (invalid or repeated name, broken model, features of another basis), io (disk
  /// full: says how much was needed).
  Result<void> add(const Model& model);
  /// Close, fsync, rename, fsync the folder. Errors: cannot_create (rename), io.
  Result<void> publish();

 private:
  struct State;
  explicit LibraryWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// How one dataset lies in the file.
struct DatasetInfo {
  std::string path;
  std::uint64_t bytes = 0;
};

struct Library {
  std::filesystem::path file;
  LibraryHeader header;
  std::uint32_t version_minor = 0;  ///< of the file's format
  std::uint64_t file_bytes = 0;
  TriSpinBasis basis;
  std::vector<Model> models;          ///< sorted by name; the PPF tables lie in the mapped file
  std::vector<DatasetInfo> datasets;  ///< in file order, for `library info`
};

/// Open a library: structure, extents, checksums and index ranges are checked before anything is
/// used.
///
/// The PPF tables stay in the mapped file; the rest is copied. Links, external storage, filters and
/// datasets that the format does not name are refused.
/// Errors: missing_input, bad_data (names the dataset and the bound it broke), io.
Result<Library> open_library(const std::filesystem::path& file);

}  // namespace trivet
