#include "engine/libraries/assemble_library.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/libraries/index_features.hpp"

namespace trivet {
namespace {

constexpr std::uint64_t kMostInMemory = std::uint64_t{256} << 20U;

}  // namespace

ModelCopy copy_of(const Library& library, std::uint32_t index) {
  const Model& model = library.models[index];
  return {&library, index, model.name, model.source};
}

std::vector<ModelCopy> copies_of(const Library& library) {
  std::vector<ModelCopy> all;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) all.push_back(copy_of(library, m));
  return all;
}

Result<void> assemble_library(const LibraryHeader& header, const TriSpinBasis& basis,
                              std::vector<ModelCopy> models, const FileLock& lock,
                              const Progress& progress) {
  std::ranges::stable_sort(models, {}, &ModelCopy::name);
  Result<LibraryWriter> writer = LibraryWriter::create(lock.file(), header);
  if (!writer) return writer.error();
  if (basis.components.size() > 0) {
    if (const Result<void> added = writer->add(basis); !added) return added;
  }
  for (std::size_t k = 0; k < models.size(); ++k) {
    if (progress.stop.stop_requested()) {
      return Error{ErrorCode::resumable,
                   fmt::format("{}: stopped after {} of {} models were written; the file is as it "
                               "was",
                               lock.file().string(), k, models.size())};
    }
    const ModelCopy& copy = models[k];
    for (const ModelPart part : kModelParts) {
      if (const Result<void> good = copy.library->check(copy.index, part); !good) return good;
    }
    Model model = copy.model();
    model.name = copy.name;
    model.source = copy.source;
    if (const Result<void> added = writer->add(model); !added) return added;
    copy.library->give_back(kMostInMemory);
    progress(k + 1, models.size(), copy.name);
  }
  if (const Result<void> indexed = engine::add_index(*writer); !indexed) return indexed;
  return writer->publish();
}

}  // namespace trivet
