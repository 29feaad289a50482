#include "storage/formats/write_png.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include "storage/formats/read_cloud.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

TEST(WriteDepthPng, ReadsBackTheSame) {
  const test::TempDir folder;
  const std::vector<std::uint16_t> depths{1000, 0, 2, 65535, 256, 255};
  ASSERT_TRUE(write_depth_png(folder / "depth.png", depths, 3));
  ReadOptions options;
  options.camera = Camera{1, 1, 0, 0, 1};
  const Result<Cloud> cloud = read_cloud(folder / "depth.png", options);
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(cloud->grid);
  EXPECT_EQ(cloud->grid->width, 3U);
  EXPECT_EQ(cloud->grid->height, 2U);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const std::int32_t point = cloud->grid->point_index[i];
    EXPECT_EQ(point == PixelGrid::kNone ? 0 : cloud->points[static_cast<std::size_t>(point)].z(),
              depths[i]);
  }
}

TEST(WriteDepthPng, NamesAFolderThatIsNotThere) {
  const std::vector<std::uint16_t> depths(4);
  const Result<void> written = write_depth_png("/nowhere/at/all/depth.png", depths, 2);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::cannot_create);
  EXPECT_NE(written.error().message.find("/nowhere/at/all"), std::string::npos);
}

TEST(WriteGrayPng, KeepsEveryPixel) {
  const test::TempDir folder;
  const std::vector<std::uint8_t> pixels{0, 255, 1, 0, 0, 128};
  ASSERT_TRUE(write_gray_png(folder / "mask.png", pixels, 3));
  const std::string bytes = test::read_bytes(folder / "mask.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  EXPECT_EQ(image.width, 3U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(image.format, static_cast<png_uint_32>(PNG_FORMAT_GRAY)) << "8 bits, one channel";
  std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
  EXPECT_EQ(read, pixels);
}

TEST(EncodePng, KeepsEveryColor) {
  const Picture picture{2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3}};
  const auto bytes = encode_png(picture);
  ASSERT_TRUE(bytes) << bytes.error().message;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes->data(), bytes->size()));
  EXPECT_EQ(image.width, 2U);
  EXPECT_EQ(image.height, 2U);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr));
  EXPECT_EQ(rgb, picture.rgb);
}

}  // namespace
}  // namespace trivet
