#include "storage/formats/read_cloud.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/files/guess_content.hpp"
#include "storage/files/gunzip.hpp"
#include "storage/files/input.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/finish.hpp"
#include "storage/formats/readers.hpp"

namespace trivet {
namespace {

using namespace std::string_view_literals;

struct Format {
  std::string_view extension;
  Result<Cloud> (*read)(const formats::Input&);
  std::string_view begin;  ///< first bytes of every such file; empty: format not recognizable
  bool holds_clouds = true, holds_depths = false;
  std::string_view looks{};  ///< extension of the recognized appearance, if different
};

#ifdef TRIVET_BUILD_STEP
constexpr bool kReadsStep = true;
#else
constexpr bool kReadsStep = false;  // STEP files in a folder are not an error
#endif

constexpr Format kFormats[] = {
    {"ply", formats::read_ply, "ply"},
    {"pcd", formats::read_pcd, "# .PCD"},
    {"obj", formats::read_obj, {}},
    {"stl", formats::read_stl, "solid"},
    {"off", formats::read_off, "OFF"},
    {"xyz", formats::read_xyz, {}},
    {"asc", formats::read_xyz, {}},
    {"pts", formats::read_xyz, {}},
    {"txt", formats::read_xyz, {}, false},
    {"csv", formats::read_xyz, {}, false},
    {"npy", formats::read_npy, "\x93NUMPY"sv, true, true},
    {"glb", formats::read_gltf, "glTF"},
    {"gltf", formats::read_gltf, {}, true, false, "json"},
    {"png", formats::read_depth_png, "\x89PNG"sv, false, true},
    {"tif", formats::read_depth_tiff, "II*\0"sv, false, true},          // little-endian
    {"tiff", formats::read_depth_tiff, "MM\0*"sv, false, true, "tif"},  // big-endian
    {"step", formats::read_step, "ISO-10303-21", kReadsStep},
    {"stp", formats::read_step, {}, kReadsStep, false, "step"},
};

constexpr auto kExtensions = [] {
  constexpr std::size_t kFromFilesOnly = 2;  // STEP, listed last
  std::array<std::string_view, std::size(kFormats) - kFromFilesOnly> extensions;
  for (std::size_t f = 0; f < extensions.size(); ++f) extensions[f] = kFormats[f].extension;
  return extensions;
}();

/// The extension in lower case, with its dot.
std::string extension_of(const std::filesystem::path& file) {
  return formats::lower_case(file.extension().string());
}

std::filesystem::path without_gz(const std::filesystem::path& file) {
  return extension_of(file) == ".gz" ? std::filesystem::path(file).replace_extension() : file;
}

const Format* find_format(std::string_view extension) {
  const auto* const found = std::ranges::find(kFormats, extension, &Format::extension);
  return found == std::end(kFormats) ? nullptr : found;
}

const Format* format_by_name(const std::filesystem::path& file) {
  const std::string extension = extension_of(without_gz(file));
  return extension.empty() ? nullptr : find_format(std::string_view(extension).substr(1));
}

/// If the file is evidently of another kind, report that kind instead of the first misplaced byte.
Error explain(Error error, const Format& format, const formats::Input& input) {
  const formats::ContentGuess found = formats::guess_content(input.bytes);
  const std::string_view looks = format.looks.empty() ? format.extension : format.looks;
  if (!found || found.extension == fmt::format(".{}", looks)) return error;
  return input.refuse(fmt::format("expected a .{} file, found {}{}{}", format.extension, found.what,
                                  found.advice.empty() ? "" : "; ", found.advice));
}

Result<Cloud> read_unpacked(const formats::Input& input) {
  if (input.bytes.empty()) return input.refuse("the file is empty");
  const Format* format =
      input.options.format.empty() ? format_by_name(input.file) : find_format(input.options.format);
  if (!format) format = find_format(format_by_content(input.bytes));
  if (!format) {
    return input.refuse(fmt::format("expected a name that ends with one of .{}, found {}",
                                    fmt::join(kExtensions, " ."),
                                    formats::quote(input.file.filename().string())));
  }
  auto cloud = format->read(input);
  if (cloud) cloud = finish(*std::move(cloud), input);
  return cloud ? std::move(cloud) : explain(cloud.error(), *format, input);
}

}  // namespace

std::span<const std::string_view> cloud_extensions() { return kExtensions; }

std::string_view format_by_content(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto* const found = std::ranges::find_if(kFormats, [&](const Format& format) {
    return !format.begin.empty() && text.starts_with(format.begin);
  });
  return found == std::end(kFormats) ? std::string_view() : found->extension;
}

bool is_cloud_file(const std::filesystem::path& file) {
  const Format* const format = format_by_name(file);
  return format && format->holds_clouds;
}

bool is_depth_file(const std::filesystem::path& file) {
  const Format* const format = format_by_name(file);
  return format && format->holds_depths;
}

std::string cloud_name(const std::filesystem::path& file) {
  return without_gz(file.filename()).stem().string();
}

Result<Cloud> formats::read(const Input& input) {
  return within_memory(input, [&]() -> Result<Cloud> {
    if (!is_gzip(input.bytes)) return read_unpacked(input);
    TRIVET_TRY_ASSIGN(const std::vector<std::byte> unpacked,
                      gunzip(input.bytes, input.file.string(), input.options.max_file_bytes));
    if (is_gzip(unpacked)) return input.refuse("is packed by gzip twice; unpack it once");
    return read_unpacked({input.file, unpacked, input.options, input.folder});
  });
}

Result<Cloud> read_cloud(const std::filesystem::path& file, const ReadOptions& options) {
  TRIVET_TRY_ASSIGN(const auto bytes, read_file(file, options.max_file_bytes));
  return formats::read({file, bytes, options, file.parent_path()});
}

Result<Cloud> read_cloud(std::span<const std::byte> bytes, const std::filesystem::path& name,
                         const ReadOptions& options) {
  return formats::read({name, bytes, options});
}

}  // namespace trivet
