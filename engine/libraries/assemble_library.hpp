/// Libraries made of models of other ones.
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

/// A model of an opened library that is to stand in another one.
struct ModelCopy {
  const Library* library = nullptr;
  std::uint32_t index = 0;
  std::string name;    ///< that it gets
  std::string source;  ///< likewise: name of the file that it was trained from

  const Model& model() const { return library->models[index]; }
};

/// All models of a library, as they are called there.
std::vector<ModelCopy> copies_of(const Library& library);

/// Write models into one library with the index over their features. The bytes depend on the
/// models and the header alone, not on where the models lay.
///
/// basis   that all models' features are in; empty: of models without
/// models  in any order
/// lock    of the file, which is replaced as a whole
/// Errors: bad_data (a model is damaged, two of one name), resumable (stopped), cannot_create, io.
Result<void> assemble_library(const LibraryHeader& header, const TriSpinBasis& basis,
                              std::vector<ModelCopy> models, const FileLock& lock,
                              const Progress& progress = {});

/// Its last step, for who has begun to write.
///
/// models       of the whole library, by name
/// num_written  of them, the first ones
/// Errors: as of assemble_library.
Result<void> finish_library(LibraryWriter writer, std::span<const ModelCopy> models,
                            std::size_t num_written, const FileLock& lock,
                            const Progress& progress = {});

}  // namespace trivet
