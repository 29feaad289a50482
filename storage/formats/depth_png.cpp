#include <fmt/format.h>
#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "storage/common/stop.hpp"
#include "storage/files/scalar.hpp"
#include "storage/formats/depth_image.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

struct ImageHeader {
  std::uint32_t width, height;
  unsigned bits, color;
};

/// Parse signature and IHDR before libpng reads the file. Source: PNG (ISO/IEC 15948), sections 5.2
/// and 11.2.2.
Result<ImageHeader> read_header(const Input& input) {
  constexpr std::size_t kHeaderBytes = 33;
  constexpr std::array<unsigned char, 16> kBegin{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                 0,    0,   0,   13,  'I',  'H',  'D',  'R'};
  if (input.bytes.size() < kHeaderBytes ||
      std::memcmp(input.bytes.data(), kBegin.data(), kBegin.size()) != 0) {
    return input.refuse("expected the signature and header of a PNG file, found other bytes");
  }
  const std::byte* const fields = input.bytes.data() + kBegin.size();
  return ImageHeader{load<std::uint32_t>(fields, std::endian::big),
                     load<std::uint32_t>(fields + 4, std::endian::big),
                     std::to_integer<unsigned>(fields[8]), std::to_integer<unsigned>(fields[9])};
}

Result<void> check_header(const Input& input, const ImageHeader& header) {
  if (header.bits != 16 || header.color != PNG_COLOR_TYPE_GRAY) {
    return input.refuse(
        fmt::format("expected 16-bit gray depth values, found {} bits a sample and "
                    "color type {}; a picture or an 8-bit image holds no depths",
                    header.bits, header.color));
  }
  TRIVET_TRY(check_pixels(input, header.width, header.height));
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  // Deflate compresses by at most 1032 (RFC 1951: 258 bytes in two bits).
  if (2 * pixels / 1032 > input.bytes.size()) {
    return input.refuse(fmt::format("{} x {} pixels cannot be in {} bytes; the file is truncated",
                                    header.width, header.height, input.bytes.size()));
  }
  return {};
}

/// State of libpng's callbacks.
struct Source {
  std::span<const std::byte> rest;
  std::array<char, 128> fault{};
};

void on_read(png_structp png, png_bytep out, std::size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (source.rest.size() < count) png_error(png, "the file is truncated");
  const std::stop_token* const stop = current_stop();
  if (stop != nullptr && stop->stop_requested()) png_error(png, "stopped on request");
  std::memcpy(out, source.rest.data(), count);
  source.rest = source.rest.subspan(count);
}

void on_error(png_structp png, png_const_charp message) {
  auto& source = *static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source.fault.data(), message, source.fault.size() - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Decode into rows of host-order depths. libpng exits by longjmp, so nothing here may own
/// resources.
bool decode(Source& source, std::span<const png_bytep> rows, std::uint32_t width) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  png_set_read_fn(png, &source, on_read);
  png_set_user_limits(png, width, static_cast<png_uint_32>(rows.size()));
  png_read_info(png, info);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != 2 * std::size_t{width}) png_error(png, "unexpected row size");
  png_read_image(png, const_cast<png_bytepp>(rows.data()));
  png_read_end(png, nullptr);
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

}  // namespace

Result<Cloud> read_depth_png(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto header, read_header(input));
  TRIVET_TRY(check_header(input, header));
  TRIVET_TRY_ASSIGN(const auto camera, depth_camera(input, header.width, header.height));

  std::vector<std::uint16_t> depths(std::size_t{header.width} * header.height);
  std::vector<png_bytep> rows(header.height);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    rows[v] = reinterpret_cast<png_bytep>(depths.data() + v * header.width);
  }
  Source source{input.bytes, {}};
  if (!decode(source, rows, header.width)) {
    check_stop();
    return input.refuse(fmt::format("cannot be decoded as PNG: {}", source.fault.data()));
  }
  return back_project(input, header.width, header.height, camera,
                      [&](std::size_t pixel) { return static_cast<double>(depths[pixel]); });
}

}  // namespace trivet::formats
