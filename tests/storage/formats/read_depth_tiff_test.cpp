// Depth images in TIFF files, compared with the same images in PNG files.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cmath>
#include <limits>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using test::kCamera;
using test::kReadOptions;
using test::little;
using test::tiff_file;

constexpr std::uint32_t kWidth = 70, kHeight = 45;  // not multiples of tiles and strips

/// The layout in which libtiff writes an image.
struct Layout {
  int compression = COMPRESSION_NONE, predictor = PREDICTOR_NONE;
  std::uint32_t tile = 0, rows_per_strip = 7;
  const char* mode = "w";  // /< with l or b: the byte order; with 8: 64-bit offsets
};

class ReadDepthTiff : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = kReadOptions) {
    return read_cloud(folder_.write("depth.tif", bytes), options);
  }

  /// Writes `images` depth images to one file, one after the other.
  template <class T>
  std::filesystem::path write(const std::vector<T>& depths, const Layout& layout, int images = 1) {
    const std::filesystem::path file = folder_ / "written.tiff";
    TIFF* const tiff = TIFFOpen(file.c_str(), layout.mode);
    for (int image = 0; image < images; ++image) {
      TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
      TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
      TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(T)));
      TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
      TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT,
                   sizeof(T) == 4 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
      TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
      if (layout.predictor != PREDICTOR_NONE)
        TIFFSetField(tiff, TIFFTAG_PREDICTOR, layout.predictor);
      if (layout.tile > 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout.tile);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout.tile);
      } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout.rows_per_strip);
      }
      write_pixels(tiff, depths, layout.tile);
      TIFFWriteDirectory(tiff);
    }
    TIFFClose(tiff);
    return file;
  }

 private:
  template <class T>
  static void write_pixels(TIFF* tiff, const std::vector<T>& depths, std::uint32_t tile) {
    std::vector<T> block(tile > 0 ? std::size_t{tile} * tile : kWidth);
    for (std::uint32_t y = 0; y < kHeight; y += std::max(tile, 1U)) {
      for (std::uint32_t x = 0; x<kWidth; x += tile> 0 ? tile : kWidth) {
        for (std::uint32_t v = 0; v < std::max(tile, 1U) && y + v < kHeight; ++v) {
          for (std::uint32_t u = 0; u < (tile > 0 ? tile : kWidth) && x + u < kWidth; ++u)
            block[v * tile + u] = depths[(y + v) * kWidth + x + u];
        }
        if (tile > 0) {
          TIFFWriteTile(tiff, block.data(), x, y, 0, 0);
        } else {
          TIFFWriteScanline(tiff, block.data(), y, 0);
        }
      }
    }
  }

 protected:
  test::TempDir folder_;
};

std::vector<std::uint16_t> sample_depths() {
  std::vector<std::uint16_t> depths(std::size_t{kWidth} * kHeight);
  for (std::size_t i = 0; i < depths.size(); ++i)
    depths[i] = static_cast<std::uint16_t>(i % 11 == 0 ? 0 : 500 + i * i % 60000);
  return depths;
}

TEST_F(ReadDepthTiff, ReadsWhatAPngHoldsFromStripsAndTilesOfEveryCompression) {
  const std::vector<std::uint16_t> depths = sample_depths();
  std::vector<float> floats(depths.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const float missing = i % 2 == 0 ? std::nanf("") : std::numeric_limits<float>::infinity();
    floats[i] = depths[i] == 0 ? missing : static_cast<float>(depths[i]);
  }
  const auto expected = read_cloud(
      folder_.write("depth.png", test::depth_png(kWidth, kHeight, depths)), kReadOptions);
  ASSERT_TRUE(expected) << expected.error().message;
  const std::vector<Layout> layouts{
      {},
      {.rows_per_strip = kHeight},
      {.mode = "wb"},
      {.mode = "w8"},
      {.compression = COMPRESSION_LZW},
      {.compression = COMPRESSION_LZW, .predictor = PREDICTOR_HORIZONTAL, .tile = 32},
      {.compression = COMPRESSION_PACKBITS, .mode = "wb"},
      {.compression = COMPRESSION_ADOBE_DEFLATE, .tile = 16, .mode = "wb"},
      {.compression = COMPRESSION_ADOBE_DEFLATE, .predictor = PREDICTOR_HORIZONTAL},
      {.compression = COMPRESSION_DEFLATE, .tile = 128},
  };
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    Layout of_floats = layouts[k];
    if (of_floats.predictor != PREDICTOR_NONE) of_floats.predictor = PREDICTOR_FLOATINGPOINT;
    for (const bool is_float : {false, true}) {
      const auto cloud =
          read_cloud(is_float ? write(floats, of_floats) : write(depths, layouts[k]), kReadOptions);
      ASSERT_TRUE(cloud) << "layout " << k << ": " << cloud.error().message;
      EXPECT_EQ(cloud->camera, kCamera);
      EXPECT_EQ(cloud->viewpoint, expected->viewpoint);
      ASSERT_TRUE(cloud->grid);
      EXPECT_EQ(cloud->grid->width, kWidth);
      EXPECT_EQ(cloud->grid->point_index, expected->grid->point_index) << "layout " << k;
      ASSERT_EQ(cloud->points.size(), expected->points.size());
      for (std::size_t i = 0; i < cloud->points.size(); ++i)
        ASSERT_EQ(cloud->points[i], expected->points[i]) << "layout " << k;
    }
  }
}

TEST_F(ReadDepthTiff, RefusesWhatHoldsNoDepthsOrMoreThanOneImage) {
  const std::vector<std::uint16_t> depths = sample_depths();
  EXPECT_TRUE(is_refused(read(tiff_file(2, 1, 8, 1, "ab")), "1 of 8 bits"));
  EXPECT_TRUE(is_refused(read(tiff_file(1, 1, 16, 1, "abcdef", 3)), "3 of 16 bits"));
  EXPECT_TRUE(is_refused(read(tiff_file(1, 1, 16, 2, "ab")), "sample format 2"));
  EXPECT_TRUE(is_refused(read(tiff_file(1, 1, 32, 1, "abcd")), "1 of 32 bits"));
  EXPECT_TRUE(is_refused(read("II*, but not a TIFF file"), "TIFF"));
  EXPECT_TRUE(is_refused(read("a text"), "cannot be opened as a TIFF"));
  const auto refused = [&](const std::filesystem::path& file, const char* text) {
    EXPECT_TRUE(is_refused(read_cloud(file, kReadOptions), text));
  };
  refused(write(depths, {}, 2), "several");
  refused(write(depths, {.compression = COMPRESSION_LZMA}), "found compression 34925");
  EXPECT_TRUE(is_refused(read(tiff_file(1, 1, 16, 1, "ab"), {}), "--camera CAMERA.json"));
}

TEST_F(ReadDepthTiff, RefusesSizesThatLieBeforeDecoding) {
  EXPECT_TRUE(is_refused(read(tiff_file(50000, 50000, 16, 1, "ab")), "50000 x 50000"));
  EXPECT_TRUE(is_refused(read(tiff_file(0xFFFFFFFF, 0xFFFFFFFF, 16, 1, "ab")), "TIFF"));
  EXPECT_TRUE(is_refused(read(tiff_file(8000, 8000, 16, 1, "ab")), "cannot be in"));
  EXPECT_TRUE(is_refused(read(tiff_file(0, 1, 16, 1, "")), "TIFF"));
  EXPECT_TRUE(is_refused(read(tiff_file(5, 5, 16, 1, "ab")), "truncated"));
  EXPECT_TRUE(is_refused(
      read(tiff_file(2, 2, 16, 1, "abcdefgh"), {.camera = kCamera, .max_pixels = 3}), "1 to 3"));
}

TEST_F(ReadDepthTiff, SurvivesEveryTruncationAndDamagedByteOfTiles) {
  const std::vector<std::uint16_t> depths = sample_depths();
  for (const Layout& layout :
       {Layout{.compression = COMPRESSION_LZW, .tile = 32}, Layout{.rows_per_strip = 9},
        Layout{.compression = COMPRESSION_ADOBE_DEFLATE, .tile = 16}}) {
    const std::string bytes = test::read_bytes(write(depths, layout));
    const auto survives = [&](const std::string& damaged) {
      const auto cloud = read_cloud(std::as_bytes(std::span(damaged)), "a.tif", kReadOptions);
      if (cloud) return bool{test::is_valid(*cloud)};
      return cloud.error().code == ErrorCode::bad_data;
    };
    for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64)
      ASSERT_TRUE(survives(bytes.substr(0, size))) << size;
    // libtiff writes the directory last.
    for (std::size_t at = 0; at<bytes.size(); at += at + 600> bytes.size() ? 1 : 41) {
      for (const int change : {1, 0x80, 0xFF}) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ change);
        ASSERT_TRUE(survives(damaged)) << at;
      }
    }
  }
}

}  // namespace
}  // namespace trivet
