#include "engine/libraries/copy_models.hpp"

#include "engine/libraries/index_features.hpp"

namespace trivet {
namespace {

constexpr std::uint64_t kMostInMemory = std::uint64_t{256} << 20U;

}  // namespace

Result<void> copy_models(const Library& library, std::span<const std::uint32_t> models,
                         const std::filesystem::path& file) {
  Result<LibraryWriter> writer = LibraryWriter::create(file, library.header);
  if (!writer) return writer.error();
  if (library.basis.components.size() > 0) {
    if (const Result<void> added = writer->add(library.basis); !added) return added;
  }
  for (const std::uint32_t m : models) {
    for (const ModelPart part : kModelParts) {
      if (const Result<void> good = library.check(m, part); !good) return good;
    }
    if (const Result<void> added = writer->add(library.models[m]); !added) return added;
    library.give_back(kMostInMemory);
  }
  if (const Result<void> indexed = engine::add_index(*writer); !indexed) return indexed;
  return writer->publish();
}

}  // namespace trivet
