// Any format in a gzip file reads the same as the unpacked file.
#include <gtest/gtest.h>

#include "storage/files/gunzip.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::gzip_file;
using test::is_refused;
using test::kReadOptions;

constexpr const char* kFourPoints = "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n";

class ReadGzip : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = kReadOptions,
                     const std::string& name = "cloud.xyz.gz") {
    return read_cloud(folder_.write(name, bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadGzip, GivesWhatTheFileHoldsWhateverItsName) {
  for (const test::SampleFile& file : test::sample_files()) {
    if (file.name.ends_with(".gz")) continue;
    const auto expected = read(file.bytes, kReadOptions, file.name);
    ASSERT_TRUE(expected) << expected.error().message;
    for (const std::string& packed : {gzip_file(file.bytes, 0), gzip_file(file.bytes)}) {
      for (const std::string& name : {file.name + ".gz", file.name + ".GZ", file.name}) {
        const auto cloud = read(packed, kReadOptions, name);
        ASSERT_TRUE(cloud) << cloud.error().message;
        ASSERT_TRUE(test::is_valid(*cloud)) << name;
        ASSERT_EQ(cloud->points.size(), expected->points.size()) << name;
        for (std::size_t i = 0; i < expected->points.size(); ++i)
          EXPECT_EQ(cloud->points[i], expected->points[i]) << name;
        EXPECT_EQ(cloud->triangles.c, expected->triangles.c) << name;
        EXPECT_EQ(cloud->grid.has_value(), expected->grid.has_value()) << name;
      }
    }
  }
}

TEST_F(ReadGzip, DetectsTheFormatByContentWhereTheNameDoesNot) {
  for (const char* known : {"ascii.ply", "binary.stl", "ascii.pcd", "depth.png"}) {
    for (const test::SampleFile& file : test::sample_files()) {
      if (file.name != known) continue;
      for (const char* name : {"scan", "scan.gz", "scan.dat"}) {
        const auto cloud = read(gzip_file(file.bytes), kReadOptions, name);
        EXPECT_TRUE(cloud) << known << " as " << name << ": " << cloud.error().message;
      }
    }
  }
  EXPECT_TRUE(is_refused(read(gzip_file(kFourPoints), kReadOptions, "scan.gz"), ".ply .pcd"));
}

TEST_F(ReadGzip, JoinsMembersAndIgnoresPadding) {
  const std::string text = kFourPoints;
  const std::string members =
      gzip_file(text.substr(0, 7)) + gzip_file("") + gzip_file(text.substr(7), 0);
  for (const std::string& bytes : {members, members + std::string(512, '\0')}) {
    const auto cloud = read(bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->points[3], Eigen::Vector3f(0, 1, 0.5F));
  }
}

TEST_F(ReadGzip, SaysWhereAFileIsTruncatedOrDamaged) {
  for (const std::string& bytes : {gzip_file(kFourPoints, 0), gzip_file(kFourPoints)}) {
    for (std::size_t size = 2; size < bytes.size(); ++size)
      ASSERT_TRUE(is_refused(read(bytes.substr(0, size)), "truncated")) << size;
    std::string damaged = bytes;
    damaged[bytes.size() - 8] ^= 1;
    EXPECT_TRUE(is_refused(read(damaged), "damaged: incorrect data check"));
    damaged = bytes;
    damaged[bytes.size() - 1] ^= 1;
    EXPECT_TRUE(is_refused(read(damaged), "damaged: incorrect length check"));
    EXPECT_TRUE(is_refused(read(bytes + "x"), "1 more bytes"));
    EXPECT_TRUE(is_refused(read(bytes + bytes.substr(0, 9)), "truncated"));
  }
  EXPECT_TRUE(
      is_refused(read("\x1F\x8B\x07 of an unknown method"), "damaged: unknown compression method"));
}

TEST_F(ReadGzip, RefusesADecompressionBombWithoutMemoryForIt) {
  const ReadOptions small{.max_file_bytes = 100'000};
  const std::string bomb = gzip_file(std::string(50'000'000, ' '));
  ASSERT_LT(bomb.size(), small.max_file_bytes);
  EXPECT_TRUE(is_refused(read(bomb, small), "more than the limit of 100000 bytes"));
  const std::string fits = kFourPoints + std::string(100'000 - 26, ' ');
  EXPECT_TRUE(read(gzip_file(fits), small));
  EXPECT_TRUE(is_refused(read(gzip_file(fits + ' '), small), "more than the limit"));
  // Nested gzip is refused because each layer would multiply the size.
  EXPECT_TRUE(is_refused(read(gzip_file(gzip_file(kFourPoints))), "packed by gzip twice"));
}

TEST_F(ReadGzip, CallsAFileByItsNameWithoutExtensions) {
  EXPECT_EQ(cloud_name("parts/lever.v2.ply.gz"), "lever.v2");
  EXPECT_EQ(cloud_name("lever.PLY"), "lever");
  EXPECT_EQ(cloud_name("lever.gz"), "lever");
  EXPECT_EQ(cloud_name("lever"), "lever");
}

}  // namespace
}  // namespace trivet
