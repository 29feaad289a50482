#include "engine/libraries/assemble_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/common/pipeline.hpp"
#include "engine/libraries/index_features.hpp"

namespace trivet {
namespace {

constexpr std::uint64_t kMostInMemory = std::uint64_t{256} << 20U;

Result<std::shared_ptr<PackedModel>> check_and_pack(const ModelCopy& copy,
                                                    const LibraryWriter& writer) {
  TRIVET_TRY_ASSIGN(Model model, copy.library->model(copy.index));
  model.name = copy.name;
  model.source = copy.source;
  return pack_model(model, writer.unit(), writer.num_components());
}

Error stopped(const std::filesystem::path& file, std::size_t num_written, std::size_t num_models) {
  return {ErrorCode::resumable,
          fmt::format("{}: stopped after {} of {} models were written; the file is as it was",
                      file.string(), num_written, num_models)};
}

}  // namespace

std::vector<ModelCopy> copies_of(const Library& library) {
  std::vector<ModelCopy> all;
  for (std::uint32_t m = 0; m < library.models.size(); ++m)
    all.push_back({&library, m, library.models[m].name, library.models[m].source});
  return all;
}

Result<void> finish_library(LibraryWriter writer, std::span<const ModelCopy> models,
                            std::size_t num_written, const FileLock& lock,
                            const Progress& progress) {
  Result<void> written;
  progress(num_written, models.size(), {});
  engine::run_pipeline(
      models.size() - num_written,
      [&](std::size_t k) { return check_and_pack(models[num_written + k], writer); },
      [&](std::size_t k, const Result<std::shared_ptr<PackedModel>>& packed) {
        const ModelCopy& copy = models[num_written + k];
        written = !packed ? packed.error()
                  : progress.stop.stop_requested()
                      ? stopped(lock.file(), num_written + k, models.size())
                      : writer.add(**packed);
        if (!written) return false;
        copy.library->release_memory(kMostInMemory);
        progress(num_written + k + 1, models.size(), copy.name);
        return true;
      });
  if (!written) return written;
  TRIVET_TRY(engine::add_index(writer));
  // Models were copied after their check, so check that their sources did not change meanwhile.
  std::set<const Library*> sources;
  for (const ModelCopy& copy : models) sources.insert(copy.library);
  for (const Library* const source : sources) {
    TRIVET_TRY(source->unchanged());
  }
  return writer.publish();
}

Result<void> assemble_library(const LibraryHeader& header, const TriSpinBasis& basis,
                              std::vector<ModelCopy> models, const FileLock& lock,
                              const Progress& progress) {
  std::ranges::stable_sort(models, {}, &ModelCopy::name);
  NamesToCome names;
  for (const ModelCopy& copy : models) names.add(copy.name);
  TRIVET_TRY_ASSIGN(LibraryWriter writer, LibraryWriter::create(lock.file(), header, names));
  TRIVET_TRY(writer.add(basis));
  return finish_library(std::move(writer), models, 0, lock, progress);
}

}  // namespace trivet
