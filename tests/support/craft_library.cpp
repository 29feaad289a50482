#include "support/craft_library.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>

#include "storage/files/file.hpp"
#include "storage/library/group_reader.hpp"
#include "storage/library/library_format.hpp"

namespace trivet::test {
namespace {

using hdf5::Handle;

void require(bool worked, const std::string& what) {
  if (!worked) throw std::runtime_error("cannot craft the library: " + what);
}

void write_text(hid_t object, const std::string& name, const std::string& text) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT));
  const Handle type(H5Aget_type(attribute.get()));
  require(H5Tget_size(type.get()) == text.size() &&
              H5Awrite(attribute.get(), type.get(), text.data()) >= 0,
          name);
}

}  // namespace

void edit_library(const std::filesystem::path& file,
                  const std::function<void(hid_t root)>& change) {
  hdf5::start();
  const Handle access = hdf5::file_access();
  const Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDWR, access.get()));
  const Handle root(H5Gopen2(opened.get(), "/", H5P_DEFAULT));
  require(static_cast<bool>(root), file.string());
  change(root.get());
}

void replace_data(hid_t root, const std::string& path, std::span<const std::byte> bytes) {
  const Handle dataset(H5Dopen2(root, path.c_str(), H5P_DEFAULT));
  const Handle type(H5Dget_type(dataset.get()));
  require(H5Dget_storage_size(dataset.get()) == bytes.size() &&
              H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0,
          path);
  write_text(dataset.get(), std::string(format::kDataChecksum), xxh3_hex(bytes));
}

void replace_dataset(hid_t root, const std::string& path, hid_t type,
                     std::span<const hsize_t> shape, hid_t creation) {
  require(H5Ldelete(root, path.c_str(), H5P_DEFAULT) >= 0, path);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
  const Handle dataset(
      H5Dcreate2(root, path.c_str(), type, space.get(), H5P_DEFAULT, creation, H5P_DEFAULT));
  require(static_cast<bool>(dataset), path);
}

void replace_attribute(hid_t root, const std::string& object, const std::string& name, hid_t type,
                       const void* value) {
  const Handle owner(H5Oopen(root, object.c_str(), H5P_DEFAULT));
  const Handle attribute(H5Aopen(owner.get(), name.c_str(), H5P_DEFAULT));
  require(H5Awrite(attribute.get(), type, value) >= 0, name);
}

void seal_library(const std::filesystem::path& file) {
  edit_library(file, [](hid_t root) {
    for (const char* const name : {"directory", "index"}) {
      if (H5Lexists(root, name, H5P_DEFAULT) > 0)
        require(H5Ldelete(root, name, H5P_DEFAULT) >= 0, name);
    }
  });
  const auto tree = read_stored_tree(file, std::filesystem::file_size(file));
  require(tree.has_value(), tree ? "" : tree.error().message);
  edit_library(file, [&](hid_t root) {
    write_text(root, std::string(format::kChecksum), format::digest(*tree));
  });
}

void seal_beside_directory(const std::filesystem::path& file) {
  const std::uint64_t size = std::filesystem::file_size(file);
  const auto tree = read_stored_tree(file, size, "models");
  require(tree.has_value(), tree ? "" : tree.error().message);
  const auto bytes = read_file(file, size);
  GroupReader reader(file, *bytes);
  std::map<std::string, std::string> children;
  for (const auto& [name, group] : tree->groups) {
    children.emplace(name, name == "models"
                               ? reader.text(tree->groups.at("directory").attributes,
                                             std::string(format::kModelsDigest), "/directory")
                               : format::digest(group));
  }
  edit_library(file, [&](hid_t root) {
    write_text(root, std::string(format::kChecksum), format::digest(tree->attributes, children));
  });
}

}  // namespace trivet::test
