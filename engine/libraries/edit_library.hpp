/// Libraries changed as a whole: models removed, renamed, merged, compared.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/common/progress.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// Its index by its name. Errors: usage (there is none).
Result<std::uint32_t> find_model(const Library& library, const std::string& name);

// Each takes time for copying what stays and for its index, and leaves the file as it was when it
// fails. The result has the bytes of a library that is trained so.

/// Errors: usage (a name that the library does not have, or none would stay), those of
/// assemble_library.
Result<void> remove_models(const std::filesystem::path& file, std::span<const std::string> names,
                           const Progress& progress = {});

/// Errors: usage (no such model, or one of the new name), bad_data (the new name is none), those of
/// assemble_library.
Result<void> rename_model(const std::filesystem::path& file, const std::string& from,
                          const std::string& to, const Progress& progress = {});

/// Put the models of one library into another's file, in place of those of the same names.
///
/// most_models  that may be in it then
/// Errors: usage (another unit, other parameters or components; too many models), those of
/// assemble_library.
Result<void> take_models(const Library& from, const std::filesystem::path& file,
                         std::size_t most_models, const Progress& progress = {});

/// Write all models of some libraries into one. A model that several have is taken once.
/// Errors: usage (libraries of other units, parameters or components; models of one name that are
/// not the same), those of assemble_library.
Result<void> merge_libraries(std::span<const std::filesystem::path> files,
                             const std::filesystem::path& into, const Progress& progress = {});

/// Names of models, rising.
struct LibraryDifference {
  bool same_parameters = true;  ///< unit and training parameters
  std::vector<std::string> added, removed, changed;
  std::vector<std::pair<std::string, std::string>> renamed;  ///< before, after
  std::size_t num_same = 0;

  bool none() const noexcept {
    return same_parameters && added.empty() && removed.empty() && changed.empty() &&
           renamed.empty();
  }
};

/// What changed from one library to another, by what their models were trained from.
LibraryDifference compare_libraries(const Library& before, const Library& after);

/// Whether models of a library can stand in a file of this header and basis; else what differs, as
/// "the unit mm".
std::string why_not_together(const Library& library, const LibraryHeader& header,
                             const TriSpinBasis& basis);

}  // namespace trivet
