/// Libraries assembled from models of other libraries.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/common/progress.hpp"
#include "storage/common/result.hpp"
#include "storage/files/file_lock.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// A model of an open library, to be copied to another one.
struct ModelCopy {
  const Library* library = nullptr;
  std::uint32_t index = 0;
  std::string name;    ///< name in the new library
  std::string source;  ///< name, in the new library, of the file that it was trained from

  const ModelInfo& info() const { return library->models[index]; }
};

/// All models of a library, with their names.
std::vector<ModelCopy> copies_of(const Library& library);

/// Write models into one library with the index of their features. The bytes depend on the models
/// and the header alone, not on where the models were stored.
///
/// basis   basis of all models' features; empty: for models without features
/// models  models in any order
/// lock    lock of the file, which is replaced as a whole
/// Errors: bad_data (a model is damaged, two with one name), resumable (stopped), cannot_create,
/// io.
Result<void> assemble_library(const LibraryHeader& header, const TriSpinBasis& basis,
                              std::vector<ModelCopy> models, const FileLock& lock,
                              const Progress& progress = {});

/// The last step of assemble_library, for callers that have started writing themselves.
///
/// models       models of the whole library, sorted by name
/// num_written  number of models already written, the first ones
/// Errors: as for assemble_library.
Result<void> finish_library(LibraryWriter writer, std::span<const ModelCopy> models,
                            std::size_t num_written, const FileLock& lock,
                            const Progress& progress = {});

}  // namespace trivet
