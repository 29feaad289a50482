#include "storage/read_cloud.hpp"

#include <fmt/format.h>

#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include "storage/file.hpp"
#include "storage/files/input.hpp"
#include "storage/files/looks_like.hpp"
#include "storage/formats/finish.hpp"
#include "storage/formats/readers.hpp"

namespace trivet {
namespace {

struct Format {
  std::string_view extension;
  Result<Cloud> (*read)(const formats::Input&);
};

constexpr Format kFormats[] = {
    {".ply", formats::read_ply}, {".pcd", formats::read_pcd},      {".obj", formats::read_obj},
    {".stl", formats::read_stl}, {".off", formats::read_off},      {".xyz", formats::read_xyz},
    {".txt", formats::read_xyz}, {".asc", formats::read_xyz},      {".csv", formats::read_xyz},
    {".pts", formats::read_xyz}, {".png", formats::read_depth_png}};

const Format* format_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const Format& format : kFormats) {
    if (format.extension == extension) return &format;
  }
  return nullptr;
}

/// A file that is plainly something else is refused as what it is, not by the first of its bytes
/// that is out of place.
Error explain(Error error, const Format& format, const formats::Input& input) {
  const formats::Appearance found = formats::looks_like(input.bytes);
  if (!found || found.extension == format.extension) return error;
  return input.refuse(fmt::format("expected a {} file, found {}{}{}", format.extension, found.what,
                                  found.advice.empty() ? "" : "; ", found.advice));
}

}  // namespace

bool is_cloud_file(const std::filesystem::path& file) {
  const Format* const format = format_of(file);
  return format && format->extension != ".png" && format->extension != ".txt" &&
         format->extension != ".csv";
}

Result<Cloud> formats::read(const Input& input) {
  const Format* const format = format_of(input.file);
  if (!format) {
    return input.refuse(fmt::format(
        "expected one of .ply .pcd .obj .stl .off .xyz .txt .asc .csv .pts .png, found {}",
        quote(input.file.filename().string())));
  }
  if (input.bytes.empty()) return input.refuse("the file is empty");
  try {
    auto cloud = format->read(input);
    if (cloud) cloud = finish(*std::move(cloud), input);
    return cloud ? std::move(cloud) : explain(cloud.error(), *format, input);
  } catch (const std::bad_alloc&) {
    return input.refuse("needs more memory than there is");
  } catch (const std::length_error&) {
    return input.refuse("needs more memory than there is");
  }
}

Result<Cloud> read_cloud(const std::filesystem::path& file, const ReadOptions& options) {
  const auto mapped = MappedFile::open(file, options.max_file_bytes);
  if (!mapped) return mapped.error();
  return formats::read({file, mapped->bytes(), options});
}

Result<Cloud> read_cloud(std::span<const std::byte> bytes, const std::filesystem::path& name,
                         const ReadOptions& options) {
  return formats::read({name, bytes, options});
}

}  // namespace trivet
