#include <gtest/gtest.h>

#include <cmath>

#include "storage/formats/lzf.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using test::is_valid;
using test::little;
using Vector = Eigen::Vector3f;

class ReadPcd : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = {}) {
    return read_cloud(folder_.write("cloud.pcd", bytes), options);
  }
  test::TempDir folder_;
};

const std::string kFields = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

std::string compressed(const std::string& header, std::uint32_t unpacked,
                       const std::string& stream) {
  return header + "DATA binary_compressed\n" + little(static_cast<std::uint32_t>(stream.size())) +
         little(unpacked) + stream;
}

TEST_F(ReadPcd, GivesTheSameOrganizedCloudInEveryEncoding) {
  for (const auto& file : test::sample_files()) {
    if (!file.name.ends_with(".pcd")) continue;
    SCOPED_TRACE(file.name);
    const auto cloud = read(file.bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(is_valid(*cloud));
    ASSERT_EQ(cloud->points.size(), 3U);
    EXPECT_EQ(cloud->num_invalid, 1U);
    EXPECT_EQ(cloud->points[2], Vector(1, 1, 2));
    EXPECT_EQ(cloud->normals[2], Vector(0, 0, -1));
    ASSERT_TRUE(cloud->grid);
    EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, 1, -1, 2}));
    EXPECT_EQ(cloud->viewpoint, Vector(0, 0, 1));
  }
}

TEST_F(ReadPcd, ReadsAnyFieldOrderTypeAndCount) {
  const std::string header =
      "# comment\r\nVERSION 0.7\r\nFIELDS label z _ y hist x\r\nSIZE 1 8 4 2 4 4\r\nTYPE U F F I F "
      "U\r\n"
      "COUNT 1 1 2 1 3 1\r\nWIDTH 1\r\nHEIGHT 1\r\nPOINTS 1\r\n";
  const auto binary =
      read(header + "DATA binary\n" + little(std::uint8_t{7}) + little(1.5) + little({9.F, 9.F}) +
           little(std::int16_t{-2}) + little({9.F, 9.F, 9.F}) + little(std::uint32_t{3}));
  const auto ascii = read(header + "DATA ascii\r\n7 1.5 9 9 -2 x x x 3\r\n");
  ASSERT_TRUE(binary && ascii);
  EXPECT_EQ(binary->points[0], Vector(3, -2, 1.5F));
  EXPECT_EQ(ascii->points[0], Vector(3, -2, 1.5F));
  EXPECT_FALSE(binary->grid);
}

TEST_F(ReadPcd, AcceptsAZeroViewpointOnlyFromAnOrganizedCloud) {
  const std::string row = "VIEWPOINT 0 0 0 1 0 0 0\nDATA ascii\n0 0 1\n1 0 1\n";
  const auto plain = read(kFields + "WIDTH 2\nHEIGHT 1\n" + row),
             organized = read(kFields + "WIDTH 2\nHEIGHT 2\n" + row + "0 1 1\n1 1 1\n");
  const auto placed =
      read(kFields + "WIDTH 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\nDATA ascii\n0 0 1\n1 0 1\n");
  ASSERT_TRUE(plain && organized && placed);
  EXPECT_FALSE(plain->viewpoint);
  EXPECT_EQ(organized->viewpoint, Vector(0, 0, 0));
  EXPECT_EQ(placed->viewpoint, Vector(1, 2, 3));
}

TEST_F(ReadPcd, TreatsOneColumnOfPixelsAsNoGrid) {
  const std::string rows = "VIEWPOINT 0 0 0 1 0 0 0\nDATA ascii\n0 0 1\n1 0 1\n";
  for (const char* size : {"WIDTH 1\nHEIGHT 2\n", "WIDTH 2\nHEIGHT 1\n"}) {
    const auto cloud = read(kFields + size + rows);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_FALSE(cloud->grid) << size;
    EXPECT_FALSE(cloud->viewpoint) << size;
  }
}

TEST_F(ReadPcd, ReadsTheOldNameOfFieldsAndCapitals) {
  const auto cloud =
      read("COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ASCII\n1 2 3\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[0], Vector(1, 2, 3));
}

TEST_F(ReadPcd, ReadsOnePointALineInText) {
  const std::string header = kFields + "WIDTH 2\nHEIGHT 1\nDATA ascii\n";
  EXPECT_TRUE(is_refused(read(header + "0 0 1 9\n1 0 1 9\n"),
                         "line 9: expected the end of the line behind the 3 numbers of point 0"));
  EXPECT_TRUE(is_refused(read(header + "0 0 1\n1 0\n1\n"),
                         "line 10: expected 3 numbers as point 1 of 2, found the end of the line"));
  EXPECT_TRUE(read(header + "0 0 1\n\n1 0 1 \n"));
  EXPECT_TRUE(is_refused(read(header + "0 0 1\n1 0 1\n2 0 1\n"),
                         "line 11: expected the end of the file behind 2 points"));
}

TEST_F(ReadPcd, RefusesHeadersThatLie) {
  const std::string body = "DATA ascii\n" + std::string(100, '0');
  const auto sized = [&](const std::string& width, const std::string& height,
                         const std::string& points) {
    return read(kFields + "WIDTH " + width + "\nHEIGHT " + height + "\nPOINTS " + points + "\n" +
                body);
  };
  EXPECT_TRUE(is_refused(sized("1152921504606846976", "1", "1152921504606846976"), "limit"));
  EXPECT_TRUE(is_refused(sized("2147483647", "2147483647", "1"), "limit"));
  EXPECT_TRUE(is_refused(sized("100000", "100000", "10000000000"), "limit"));
  EXPECT_TRUE(is_refused(sized("1000000", "1", "1000000"), "truncated"));
  EXPECT_TRUE(is_refused(sized("-1", "1", "-1"), "less than zero"));
  EXPECT_TRUE(is_refused(sized("2", "2", "5"), "WIDTH x HEIGHT"));
  EXPECT_TRUE(is_refused(sized("many", "1", "1"), "less than zero"));
  EXPECT_TRUE(is_refused(sized("0", "1", "0"), "the end of the file behind 0 points"));
  EXPECT_TRUE(is_refused(read("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\n" + body),
                         "x, y and z"));
  EXPECT_TRUE(
      is_refused(read("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nWIDTH 1\n" + body), "equal length"));
  EXPECT_TRUE(is_refused(read("FIELDS x y z\nSIZE 3 4 4\nTYPE F F F\nWIDTH 1\n" + body), "SIZE"));
  EXPECT_TRUE(is_refused(read("FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nWIDTH 1\n" + body), "SIZE"));
  EXPECT_TRUE(is_refused(
      read("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 9000000000\nWIDTH 1\n" + body),
      "COUNT"));
  EXPECT_TRUE(is_refused(read(kFields + "WIDTH 1\nPOINTS 1\nDATA zipped\n0 0 0\n"), "zipped"));
  EXPECT_TRUE(is_refused(read(kFields + "WIDTH 1\nPOINTS 1\n"), "DATA"));
  EXPECT_TRUE(is_refused(read(kFields + "WIDTH 1\nPOINTS 1\nDATA ascii\n0 0 oops\n"),
                         "line 9: expected 3 numbers as point 0 of 1, found \"oops\""));
}

TEST_F(ReadPcd, RefusesCompressedBodiesThatLie) {
  const std::string one = kFields + "WIDTH 1\nPOINTS 1\n", point = little({1.F, 2.F, 3.F});
  ASSERT_TRUE(read(compressed(one, 12, test::lzf_literals(point))));
  EXPECT_TRUE(
      is_refused(read(compressed(one, 13, test::lzf_literals(point))), "points of 12 bytes"));
  EXPECT_TRUE(is_refused(read(compressed(one, 12, test::lzf_literals(point + "x"))), "unpack"));
  EXPECT_TRUE(is_refused(read(compressed(one, 12, test::lzf_literals(point.substr(1)))), "unpack"));
  EXPECT_TRUE(is_refused(
      read(one + "DATA binary_compressed\n" + little({4000000000U, 12U}) + point), "truncated"));
  // 357,913,941 points of 12 bytes cannot fit in a few bytes, whatever the compression.
  EXPECT_TRUE(is_refused(
      read(compressed(kFields + "WIDTH 90000000\nPOINTS 90000000\n", 1080000000, "\xFF\xFF\xFF")),
      "compressed to 3"));
}

std::string unpack(const std::string& stream, std::size_t size) {
  std::string out(size, '?');
  const bool good = formats::decompress_lzf(std::as_bytes(std::span(stream)),
                                            std::as_writable_bytes(std::span(out)));
  return good ? out : "refused";
}

TEST(DecompressLzf, CopiesEarlierOutputAlsoWhereItOverlaps) {
  using namespace std::string_literals;
  EXPECT_EQ(unpack("", 0), "");
  EXPECT_EQ(unpack("\x02"s
                   "abc",
                   3),
            "abc");
  EXPECT_EQ(unpack("\x02"s
                   "abc"
                   "\x20\x02"s,
                   6),
            "abcabc");  // length 3, distance 3
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\x60\x00"s,
                   6),
            "aaaaaa");  // length 5, distance 1
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\xE0\x05\x00"s,
                   15),
            std::string(15, 'a'));  // length 9 + 5
}

TEST(DecompressLzf, RefusesWhatLeavesItsBounds) {
  using namespace std::string_literals;
  EXPECT_EQ(unpack("\x02"s
                   "ab",
                   3),
            "refused");  // literals beyond the input
  EXPECT_EQ(unpack("\x02"s
                   "abc",
                   2),
            "refused");  // literals beyond the output
  EXPECT_EQ(unpack("\x02"s
                   "abc",
                   4),
            "refused");  // too little output
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\x20\x01"s,
                   4),
            "refused");  // a copy from before the output's start
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\xE0\xFF\x00"s,
                   100),
            "refused");  // a copy beyond the output
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\xE0"s,
                   10),
            "refused");  // no length
  EXPECT_EQ(unpack("\x00"s
                   "a"
                   "\x20"s,
                   4),
            "refused");  // no distance
}

}  // namespace
}  // namespace trivet
