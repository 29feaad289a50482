/// Small files of every format, made byte by byte without the code under test.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::test {

/// The value's bytes in little-endian order.
template <class T>
std::string little(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};  // little-endian machines only
}
template <class T>
std::string big(T value) {
  const std::string bytes = little(value);
  return {bytes.rbegin(), bytes.rend()};
}
template <class T>
std::string little(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes += little(value);
  return bytes;
}

/// An LZF stream of literals only.
std::string lzf_literals(std::string_view bytes);

/// A PNG file with one uncompressed deflate stream; `rows` holds filter bytes and big-endian
/// samples.
std::string png_file(std::uint32_t width, std::uint32_t height, int bits, int color_type,
                     std::string_view rows);
/// A 16-bit gray PNG of these depths.
std::string depth_png(std::uint32_t width, std::uint32_t height,
                      const std::vector<std::uint16_t>& depths);

/// An uncompressed TIFF file of one strip; `pixels` are little-endian values of `bits` bits.
/// `format` is TIFF's SampleFormat: 1 unsigned, 2 signed, 3 float.
std::string tiff_file(std::uint32_t width, std::uint32_t height, int bits, int format,
                      std::string_view pixels, int samples = 1);

/// A binary glTF file with a document and a buffer.
std::string glb_file(std::string json, std::string buffer);
std::string base64(std::string_view bytes);

/// A NumPy array file; `type` as in numpy.dtype.str and `shape` as in Python.
std::string npy_file(const std::string& type, const std::string& shape, const std::string& body,
                     bool fortran_order = false, int version = 1);

/// Compresses bytes by gzip; level 0 stores them as they are.
std::string gzip_file(std::string_view bytes, int level = 9);

struct SampleFile {
  std::string name;  ///< with the extension of its format
  std::string bytes;
};
/// A valid file of each format and encoding, a few hundred bytes long.
std::vector<SampleFile> sample_files();

/// The camera of depth images in these tests.
inline const Camera kCamera{500, 400, 1, 0.5, 0.001};
inline const ReadOptions kReadOptions{.camera = kCamera};

/// Whether the cloud satisfies all invariants of its type.
testing::AssertionResult is_valid(const Cloud& cloud);

/// Whether the result is bad_data and its message contains the name of the file and this text.
testing::AssertionResult is_refused(const Result<Cloud>& result, std::string_view text);

}  // namespace trivet::test
