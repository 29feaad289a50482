/// The memory that a scan needs is known before it is read.
#include "storage/formats/declared_size.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "storage/common/stop.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

using test::kReadOptions;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

DeclaredSize declared(const std::string& name, const std::string& bytes) {
  return declared_size(bytes_of(bytes), name, kReadOptions);
}

TEST(DeclaredSize, IsNeverLessThanWhatIsRead) {
  for (const test::SampleFile& file : test::sample_files()) {
    const auto cloud = read_cloud(bytes_of(file.bytes), file.name, kReadOptions);
    ASSERT_TRUE(cloud) << file.name;
    const std::size_t pixels = cloud->grid ? cloud->grid->point_index.size() : 0;
    const std::size_t most = std::max(cloud->points.size(), pixels);
    EXPECT_GE(declared(file.name, file.bytes).num_points, most) << file.name;
    if (file.name.ends_with(".gz")) continue;
    const DeclaredSize packed = declared(file.name + ".gz", test::gzip_file(file.bytes));
    EXPECT_GE(packed.num_points, most) << file.name << ".gz";
    EXPECT_EQ(packed.unpacked_bytes, file.bytes.size()) << file.name << ".gz";
  }
}

/// Files of n points, pixels or triangles.
std::vector<test::SampleFile> files_of(std::uint32_t n) {
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n) +
                    "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  std::string pcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                    std::to_string(n) + "\nHEIGHT 1\nPOINTS " + std::to_string(n) +
                    "\nDATA binary\n";
  std::string xyz, obj, stl(80, ' '), floats;
  stl += test::little(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const float x = static_cast<float>(i % 1000) / 1000, y = static_cast<float>(i) / 1e6F;
    floats += test::little({x, y, 1.0F});
    const std::string text = std::to_string(x) + " " + std::to_string(y) + " 1\n";
    xyz += text;
    obj += "v " + text;
    stl += std::string(12, '\0') + test::little({x, y, 1.0F, x + 0.001F, y, 1.0F, x, y, 1.1F}) +
           std::string(2, '\0');
  }
  return {{"a.ply", ply + floats},
          {"a.pcd", pcd + floats},
          {"a.xyz", xyz},
          {"a.obj", obj},
          {"a.stl", stl},
          {"a.npy", test::npy_file("<f4", "(" + std::to_string(n) + ", 3)", floats)},
          {"a.png", test::depth_png(n / 256, 256, std::vector<std::uint16_t>(n, 800))},
          {"a.tif", test::tiff_file(n / 256, 256, 16, 1, std::string(2 * n, '\3'))}};
}

TEST(DeclaredSize, IsCloseForLargeFiles) {
  constexpr std::uint32_t kNum = 1 << 15;
  for (const test::SampleFile& file : files_of(kNum)) {
    // Triangles in STL share no corners, so the file has three vertices for each.
    const std::uint64_t right = file.name == "a.stl" ? 3 * kNum : kNum;
    const DeclaredSize plain = declared(file.name, file.bytes);
    EXPECT_GE(plain.num_points, right) << file.name;
    EXPECT_LE(plain.num_points, right + right / 10) << file.name;
    const DeclaredSize packed = declared(file.name + ".gz", test::gzip_file(file.bytes, 1));
    EXPECT_GE(packed.num_points, right * 9 / 10) << file.name << ".gz";
    EXPECT_LE(packed.num_points, 4 * right) << file.name << ".gz";
    EXPECT_EQ(packed.unpacked_bytes, file.bytes.size()) << file.name << ".gz";
  }
}

TEST(DeclaredSize, CountsLinesHoweverShort) {
  for (const char end : {'\n', '\r'}) {
    const std::string empty_lines(100'000, end);
    EXPECT_EQ(declared("a.xyz", empty_lines).num_points, 100'001U);
    EXPECT_EQ(declared("a.xyz", "1 2 3" + empty_lines + "4 5 6").num_points, 100'001U);
  }
}

TEST(DeclaredSize, IsWhatTheHeaderOfAnImageSays) {
  const std::string bytes =
      test::depth_png(4000, 4000, std::vector<std::uint16_t>(16'000'000, 8000));
  EXPECT_EQ(declared("a.png", test::gzip_file(bytes, 1)).num_points, 16'000'000U)
      << "a few kilobytes";
}

TEST(DeclaredSize, AcceptsAnyBytes) {
  for (const test::SampleFile& file : test::sample_files()) {
    for (std::size_t n = 0; n < file.bytes.size(); n += 7)
      EXPECT_LE(declared(file.name, file.bytes.substr(0, n)).num_points, 200'000'000U);
  }
}

// Covers every format, and gzip.
TEST(ReadCloud, ChecksForStopRequests) {
  std::stop_source stop;
  stop.request_stop();
  const std::stop_token token = stop.get_token();
  const StopScope scope(&token);
  for (const test::SampleFile& file : files_of(300'032)) {
    EXPECT_THROW((void)read_cloud(bytes_of(file.bytes), file.name, kReadOptions), Stopped)
        << file.name;
  }
  const std::string small = test::sample_files().front().bytes;
  EXPECT_THROW((void)read_cloud(bytes_of(test::gzip_file(small)), "a.gz", kReadOptions), Stopped);
}

}  // namespace
}  // namespace trivet
