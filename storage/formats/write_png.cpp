#include "storage/formats/write_png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>

#include "storage/common/precondition.hpp"
#include "storage/files/file.hpp"

namespace trivet {
namespace {

/// State of libpng's callbacks.
struct Sink {
  std::vector<std::byte> bytes;
  std::array<char, 128> fault{};
};

void on_error(png_structp png, png_const_charp message) {
  auto& sink = *static_cast<Sink*>(png_get_error_ptr(png));
  std::strncpy(sink.fault.data(), message, sink.fault.size() - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep data, std::size_t count) {
  auto& sink = *static_cast<Sink*>(png_get_io_ptr(png));
  bool fits = true;
  try {
    const auto* const begin = reinterpret_cast<const std::byte*>(data);
    sink.bytes.insert(sink.bytes.end(), begin, begin + count);
  } catch (const std::bad_alloc&) {
    fits = false;  // exceptions must not pass through C
  }
  if (!fits) png_error(png, kOutOfMemory);
}

void on_flush(png_structp) {}

struct Rows {
  std::uint32_t width, height;
  int bits, color;
  const png_byte* first;
  std::size_t stride;  // bytes
};

/// libpng exits by longjmp, so nothing here may own resources.
bool encode(const Rows& rows, Sink& sink) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &sink, on_write, on_flush);
  png_set_IHDR(png, info, rows.width, rows.height, rows.bits, rows.color, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (rows.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  for (std::uint32_t v = 0; v < rows.height; ++v) png_write_row(png, rows.first + v * rows.stride);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

Result<std::vector<std::byte>> encode(const Rows& rows) {
  Sink sink;
  if (encode(rows, sink)) return std::move(sink.bytes);
  return Error{ErrorCode::internal,
               fmt::format("an image of {} x {} pixels cannot be encoded as PNG: {}", rows.width,
                           rows.height, sink.fault.data())};
}

Result<void> write_gray(const std::filesystem::path& file, std::span<const std::byte> pixels,
                        int bits, std::uint32_t width) {
  const std::size_t stride = std::size_t{width} * static_cast<std::size_t>(bits) / 8;
  TRIVET_REQUIRE(stride > 0 && pixels.size() % stride == 0, "whole rows");
  TRIVET_TRY_ASSIGN(
      const auto bytes,
      encode({width, static_cast<std::uint32_t>(pixels.size() / stride), bits, PNG_COLOR_TYPE_GRAY,
              reinterpret_cast<const png_byte*>(pixels.data()), stride}));
  return publish_file(file, bytes);
}

}  // namespace

Result<std::vector<std::byte>> encode_png(const Picture& picture) {
  TRIVET_REQUIRE(picture.rgb.size() == std::size_t{3} * picture.width * picture.height,
                 "three bytes a pixel");
  return encode({picture.width, picture.height, 8, PNG_COLOR_TYPE_RGB, picture.rgb.data(),
                 std::size_t{3} * picture.width});
}

Result<void> write_depth_png(const std::filesystem::path& file,
                             std::span<const std::uint16_t> depths, std::uint32_t width) {
  return write_gray(file, std::as_bytes(depths), 16, width);
}

Result<void> write_gray_png(const std::filesystem::path& file, std::span<const std::uint8_t> pixels,
                            std::uint32_t width) {
  return write_gray(file, std::as_bytes(pixels), 8, width);
}

}  // namespace trivet
