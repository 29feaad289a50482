#include "storage/library/import_library.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>

#include "storage/files/file.hpp"
#include "storage/library/parse_library.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {
namespace {

Result<Library> read_repacked(const std::filesystem::path& file) {
  TRIVET_TRY_ASSIGN(const auto mapped,
                    MappedFile::open(file, std::numeric_limits<std::uint64_t>::max()));
  TRIVET_TRY_ASSIGN(UnpackedTree read, read_unpacked_tree(file, mapped.bytes().size()));
  const auto tree = std::make_shared<const UnpackedTree>(std::move(read));
  Result<Library> library =
      parse_library(file, tree->root, tree->bytes, {tree, tree->bytes.data()});
  if (!library) return library;
  TRIVET_TRY(library->check_all());
  if (library->version_minor > kLibraryVersionMinor) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected format {}.{} or an older one, found {}.{}, of which "
                             "something would be lost; import it with the program that wrote it",
                             file.string(), kLibraryVersionMajor, kLibraryVersionMinor,
                             kLibraryVersionMajor, library->version_minor)};
  }
  if (!nlohmann::json::accept(library->header.parameters)) {
    return Error{ErrorCode::bad_data, fmt::format("{}: /parameters: expected JSON, found '{}'",
                                                  file.string(), library->header.parameters)};
  }
  return library;
}

}  // namespace

Result<Library> read_repacked_library(const std::filesystem::path& file) {
  try {
    return read_repacked(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, fmt::format("{}: {}", file.string(), kOutOfMemory)};
  }
}

}  // namespace trivet
