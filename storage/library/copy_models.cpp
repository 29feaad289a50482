#include "storage/library/copy_models.hpp"

namespace trivet {

Result<void> copy_models(const Library& library, std::span<const std::uint32_t> models,
                         const std::filesystem::path& file) {
  Result<LibraryWriter> writer = LibraryWriter::create(file, library.header);
  if (!writer) return writer.error();
  if (library.basis.components.size() > 0) {
    if (const Result<void> added = writer->add(library.basis); !added) return added;
  }
  for (const std::uint32_t m : models) {
    if (const Result<void> added = writer->add(library.models[m]); !added) return added;
  }
  return writer->publish();
}

}  // namespace trivet
