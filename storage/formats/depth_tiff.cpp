#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "storage/files/scalar.hpp"
#include "storage/formats/depth_image.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// State of libtiff's callbacks.
struct TiffSource {
  std::span<const std::byte> bytes;
  std::uint64_t at = 0;
  std::array<char, 160> fault{};  ///< the first fault; later ones are consequences
  bool guesses_lengths = false;   ///< lengths of strips are absent or wrong

  std::string_view reason() const noexcept {
    const std::string_view said(fault.data());
    // libtiff reports a count that is 0 or beyond its limits as a lack of memory.
    if (said.find("emory") != said.npos) return "a count in it cannot be";
    return said.empty() ? "it holds less than it says" : said;
  }
};

tmsize_t on_read(thandle_t handle, void* out, tmsize_t count) {
  auto& source = *static_cast<TiffSource*>(handle);
  if (count <= 0 || source.at >= source.bytes.size()) return 0;
  const auto given =
      std::min<std::uint64_t>(static_cast<std::uint64_t>(count), source.bytes.size() - source.at);
  std::memcpy(out, source.bytes.data() + source.at, given);
  source.at += given;
  return static_cast<tmsize_t>(given);
}

tmsize_t on_write(thandle_t, void*, tmsize_t) { return 0; }

toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  auto& source = *static_cast<TiffSource*>(handle);
  if (whence == SEEK_CUR) offset += source.at;
  if (whence == SEEK_END) offset += source.bytes.size();
  return source.at = offset;
}

int on_close(thandle_t) { return 0; }

toff_t on_size(thandle_t handle) { return static_cast<TiffSource*>(handle)->bytes.size(); }

int on_error(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  auto& fault = static_cast<TiffSource*>(user)->fault;
  if (fault[0] == '\0') std::vsnprintf(fault.data(), fault.size(), format, arguments);
  return 1;  // stop decoding
}

/// libtiff repairs lengths of strips by using whatever bytes follow, and warns.
int on_warning(TIFF*, void* user, const char*, const char* format, va_list) {
  if (std::string_view(format).find("calculating from imagelength") != std::string_view::npos)
    static_cast<TiffSource*>(user)->guesses_lengths = true;
  return 1;
}

struct Close {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Handle = std::unique_ptr<TIFF, Close>;

Handle open(TiffSource& source, const ReadOptions& options) {
  // Limit for one strip, tile or table of them.
  const std::uint64_t most_memory = 8 * options.max_pixels + (1 << 20);
  TIFFOpenOptions* const settings = TIFFOpenOptionsAlloc();
  if (!settings) throw std::bad_alloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(settings, static_cast<tmsize_t>(most_memory));
  TIFFOpenOptionsSetErrorHandlerExtR(settings, on_error, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(settings, on_warning, &source);
  TIFF* const tiff = TIFFClientOpenExt("", "rm", &source, on_read, on_write, on_seek, on_close,
                                       on_size, nullptr, nullptr, settings);
  TIFFOpenOptionsFree(settings);
  return Handle(tiff);
}

struct TiffHeader {
  std::uint32_t width = 0, height = 0;
  Scalar type = Scalar::uint16;

  std::size_t row_bytes() const noexcept { return std::size_t{width} * size_of(type); }
};

template <class T>
T tag(TIFF* tiff, ttag_t name) {
  T value = 0;
  TIFFGetFieldDefaulted(tiff, name, &value);
  return value;
}

Result<void> check_layout(const Input& input, TIFF* tiff) {
  if (const auto orientation = tag<std::uint16_t>(tiff, TIFFTAG_ORIENTATION);
      orientation != ORIENTATION_TOPLEFT) {
    return input.refuse(fmt::format(
        "expected rows from the top and columns from the left, found orientation {}; turn the "
        "image, whose camera would be another",
        orientation));
  }
  constexpr std::array kLossless{COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_PACKBITS,
                                 COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE};
  if (const auto compression = tag<std::uint16_t>(tiff, TIFFTAG_COMPRESSION);
      std::ranges::find(kLossless, compression) == kLossless.end()) {
    return input.refuse(fmt::format(
        "expected no compression, LZW, PackBits or Deflate, found compression {}", compression));
  }
  if (!TIFFLastDirectory(tiff))
    return input.refuse("expected one image, found several; save one depth image a file");
  return {};
}

Result<TiffHeader> read_header(const Input& input, TIFF* tiff) {
  const auto bits = tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE);
  const auto samples = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL);
  const auto format = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT);
  const bool is_float = bits == 32 && format == SAMPLEFORMAT_IEEEFP;
  const bool is_integer =
      bits == 16 && (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID);
  if (samples != 1 || !(is_float || is_integer)) {
    return input.refuse(
        fmt::format("expected depths as one 16-bit unsigned or 32-bit float value a pixel, found "
                    "{} of {} bits and sample format {}; a picture holds no depths",
                    samples, bits, format));
  }
  const TiffHeader header{tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH),
                          tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH),
                          is_float ? Scalar::float32 : Scalar::uint16};
  TRIVET_TRY(check_pixels(input, header.width, header.height));
  TRIVET_TRY(check_layout(input, tiff));
  // Deflate compresses by at most 1032, LZW by 1400: the longest strings of its table, one after
  // the other, until it is full.
  constexpr std::uint64_t kMostShrunk = 1400;
  if (header.row_bytes() * header.height / kMostShrunk > input.bytes.size()) {
    return input.refuse(fmt::format("{} x {} pixels cannot be in {} bytes; the file is truncated",
                                    header.width, header.height, input.bytes.size()));
  }
  return header;
}

/// Decode some rows at a time, directly into the image.
bool decode_strips(TIFF* tiff, const TiffHeader& header, std::span<std::byte> out) {
  const auto rows_per_strip = std::min(
      std::max<std::uint32_t>(1, tag<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP)), header.height);
  std::uint32_t strip = 0;
  for (std::uint32_t row = 0; row < header.height; row += rows_per_strip, ++strip) {
    const std::uint64_t rows = std::min(rows_per_strip, header.height - row);
    const auto size = static_cast<tmsize_t>(rows * header.row_bytes());
    if (TIFFReadEncodedStrip(tiff, strip, out.data() + row * header.row_bytes(), size) != size)
      return false;
    if (rows_per_strip > header.height - row) break;  // the sum could overflow
  }
  return true;
}

/// Decode rectangles of the image; those at its right and lower border extend beyond it.
bool decode_tiles(TIFF* tiff, const TiffHeader& header, std::span<std::byte> out) {
  const auto tile_width = tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH);
  const auto tile_height = tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH);
  const tmsize_t tile_bytes = TIFFTileSize(tiff);
  const std::uint64_t tile_row_bytes = std::uint64_t{tile_width} * size_of(header.type);
  constexpr std::uint64_t kLargestSide = 1 << 16;  // as large as whole images
  if (tile_width == 0 || tile_height == 0 || tile_width > kLargestSide ||
      tile_height > kLargestSide || std::cmp_not_equal(tile_bytes, tile_row_bytes * tile_height) ||
      std::uint64_t{tile_width} * tile_height >
          4 * std::max<std::uint64_t>(kLargestSide, std::uint64_t{header.width} * header.height)) {
    return false;
  }
  std::vector<std::byte> tile(static_cast<std::size_t>(tile_bytes));
  for (std::uint32_t top = 0; top < header.height; top += tile_height) {
    for (std::uint32_t left = 0; left < header.width; left += tile_width) {
      const std::uint32_t index = TIFFComputeTile(tiff, left, top, 0, 0);
      if (TIFFReadEncodedTile(tiff, index, tile.data(), tile_bytes) != tile_bytes) return false;
      const std::size_t bytes = std::min(tile_width, header.width - left) * size_of(header.type);
      for (std::uint32_t row = 0; row < std::min(tile_height, header.height - top); ++row) {
        std::memcpy(out.data() + (top + row) * header.row_bytes() + left * size_of(header.type),
                    tile.data() + row * tile_row_bytes, bytes);
      }
    }
  }
  return true;
}

}  // namespace

Result<Cloud> read_depth_tiff(const Input& input) {
  TiffSource source{input.bytes};
  const Handle tiff = open(source, input.options);
  if (!tiff)
    return input.refuse(fmt::format("cannot be opened as a TIFF image: {}", source.reason()));
  TRIVET_TRY_ASSIGN(const auto header, read_header(input, tiff.get()));
  if (source.guesses_lengths)
    return input.refuse(
        "the lengths of its strips are absent or wrong; it is truncated or damaged");
  TRIVET_TRY_ASSIGN(const auto camera, depth_camera(input, header.width, header.height));

  std::vector<std::byte> depths(header.row_bytes() * header.height);
  const bool done = TIFFIsTiled(tiff.get()) ? decode_tiles(tiff.get(), header, depths)
                                            : decode_strips(tiff.get(), header, depths);
  if (!done) {
    return input.refuse(fmt::format(
        "the TIFF image cannot be decoded; it is truncated or damaged: {}", source.reason()));
  }
  return back_project(input, header.width, header.height, camera, [&](std::size_t pixel) {
    return load(depths.data() + pixel * size_of(header.type), header.type, std::endian::native);
  });
}

}  // namespace trivet::formats
