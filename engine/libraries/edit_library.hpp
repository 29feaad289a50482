/// Operations on whole libraries: remove, rename, merge and compare models.
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

/// The index of a model by its name. Errors: usage (there is none).
Result<std::uint32_t> find_model(const Library& library, const std::string& name);

// Each operation copies the remaining models and rebuilds the index; if it fails, the file does not
// change. The result has the same bytes as a library trained with these models.

/// Remove models. Errors: usage (a name that the library does not contain, or no model would
/// remain), those of assemble_library.
Result<void> remove_models(const std::filesystem::path& file, std::span<const std::string> names,
                           const Progress& progress = {});

/// Rename a model. Errors: usage (no such model, or one with the new name exists), bad_data (the
/// new name is invalid), those of assemble_library.
Result<void> rename_model(const std::filesystem::path& file, const std::string& from,
                          const std::string& to, const Progress& progress = {});

/// Copy the models of one library to another's file, replacing those with the same names.
///
/// most_models  maximum number of models in the result
/// Errors: usage (another unit, other parameters or components; too many models), those of
/// assemble_library.
Result<void> copy_models(const Library& from, const std::filesystem::path& file,
                         std::size_t most_models, const Progress& progress = {});

/// Write all models of several libraries into one. A model that occurs in several is copied once.
/// Errors: usage (libraries with other units, parameters or components; different models with one
/// name), those of assemble_library.
Result<void> merge_libraries(std::span<const std::filesystem::path> files,
                             const std::filesystem::path& into, const Progress& progress = {});

/// Differences between libraries, as names of models, rising.
struct LibraryDifference {
  bool same_parameters = true;  ///< equal unit and training parameters
  std::vector<std::string> added, removed, changed;
  std::vector<std::pair<std::string, std::string>> renamed;  ///< before, after
  std::size_t num_same = 0;

  bool none() const noexcept {
    return same_parameters && added.empty() && removed.empty() && changed.empty() &&
           renamed.empty();
  }
};

/// The changes from one library to another, by the inputs that their models were trained from.
LibraryDifference compare_libraries(const Library& before, const Library& after);

/// The reason why models of a library cannot be stored in a file with this header and basis, such
/// as "the unit mm"; empty if they can.
std::string why_not_together(const Library& library, const LibraryHeader& header,
                             const TriSpinBasis& basis);

}  // namespace trivet
