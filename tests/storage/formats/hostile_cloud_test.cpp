// Any bytes under any extension give an error or a valid cloud, never a crash, a hang or wrong
// data.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <span>
#include <vector>

#include "storage/formats/read_cloud.hpp"
#include "storage/formats/readers.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using test::is_valid;
using test::kReadOptions;

class HostileCloud : public testing::Test {
 protected:
  /// Reads the bytes; the only valid outcomes are bad_data and a valid cloud.
  static bool survives(const std::filesystem::path& name, std::string_view bytes) {
    // The allocation has exactly this size: sanitizers detect a read beyond it, but not beyond a
    // mapped page.
    const std::vector<char> exact(bytes.begin(), bytes.end());
    const auto cloud = formats::read({name, std::as_bytes(std::span(exact)), kReadOptions});
    if (cloud) return is_valid(*cloud);
    // The error "more memory than there is" means that the reader trusted a count that cannot fit
    // in the file.
    return cloud.error().code == ErrorCode::bad_data &&
           cloud.error().message.find("memory") == std::string::npos;
  }
  test::TempDir folder_;
};

TEST_F(HostileCloud, TheSamplesThemselvesAreRead) {
  for (const auto& file : test::sample_files()) {
    const auto cloud = read_cloud(folder_.write(file.name, file.bytes), kReadOptions);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_TRUE(is_valid(*cloud)) << file.name;
  }
}

TEST_F(HostileCloud, TruncationAtEveryByteIsSurvived) {
  for (const auto& file : test::sample_files()) {
    for (std::size_t size = 0; size < file.bytes.size(); ++size) {
      ASSERT_TRUE(survives(file.name, file.bytes.substr(0, size)))
          << file.name << " of " << size << " bytes";
    }
  }
}

TEST_F(HostileCloud, TruncatedBinaryFilesAreRefused) {
  for (const auto& file : test::sample_files()) {
    const bool binary = file.name == "little.ply" || file.name == "big.ply" ||
                        file.name == "binary.pcd" || file.name == "compressed.pcd" ||
                        file.name == "binary.stl" || file.name == "depth.png" ||
                        file.name.ends_with(".gz") || file.name.ends_with(".npy") ||
                        file.name.ends_with(".glb") || file.name.ends_with(".tif");
    for (std::size_t size = 0; binary && size < file.bytes.size(); ++size) {
      const auto cloud =
          read_cloud(folder_.write(file.name, file.bytes.substr(0, size)), kReadOptions);
      ASSERT_FALSE(cloud) << file.name << " of " << size << " bytes";
    }
  }
}

TEST_F(HostileCloud, RandomDamageIsSurvived) {
  test::Random random;
  const auto samples = test::sample_files();
  for (int round = 0; round < 1000; ++round) {
    for (const auto& file : samples) {
      std::string bytes = file.bytes;
      for (std::uint32_t damages = 1 + random.below(4); damages > 0; --damages) {
        const auto size = static_cast<std::uint32_t>(bytes.size());
        const std::size_t at = random.below(size), count = 1 + random.below(8);
        switch (random.below(5)) {
          case 0:
            bytes[at] = static_cast<char>(random.below(256));
            break;
          case 1:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
            break;
          case 2:
            bytes.erase(at, count);
            break;
          case 3:
            bytes.insert(at, bytes.substr(random.below(size), count));
            break;
          default:
            bytes[at] = "0123456789-e.\n #"[random.below(16)];
            break;
        }
        if (bytes.empty()) bytes.push_back(' ');
      }
      ASSERT_TRUE(survives(file.name, bytes)) << file.name << ", round " << round;
    }
  }
}

TEST_F(HostileCloud, EveryFormatUnderEveryExtensionIsSurvived) {
  for (const auto& file : test::sample_files()) {
    for (const char* name : {"a.ply", "a.pcd", "a.obj", "a.stl", "a.off", "a.xyz", "a.csv", "a.txt",
                             "a.png", "a.npy", "a.tif", "a.glb", "a.gltf", "a.gz", "a"}) {
      EXPECT_TRUE(survives(name, file.bytes)) << file.name << " as " << name;
    }
  }
}

TEST_F(HostileCloud, LongLinesAreSurvived) {
  const std::size_t million = 1'000'000;
  std::string small_number(million, '0');
  small_number[1] = '.';
  small_number.back() = '1';
  const std::vector<std::string> lines{std::string(million, '1'), std::string(million, ' '),
                                       std::string(million, '\0'), std::string(million, '#'),
                                       small_number};
  for (const std::string& line : lines) {
    for (const std::string begin :
         {"", "v ", "f ", "OFF ", "ply\n", "solid ", "solid\nvertex ", "FIELDS "}) {
      for (const char* name : {"a.ply", "a.pcd", "a.obj", "a.stl", "a.off", "a.xyz"}) {
        EXPECT_TRUE(survives(name, begin + line)) << begin << line[2] << " as " << name;
      }
    }
  }
}

TEST_F(HostileCloud, OnlyRegularFilesAreOpened) {
  std::filesystem::create_directory(folder_ / "folder.ply");
  ASSERT_EQ(::mkfifo((folder_ / "pipe.ply").c_str(), 0600), 0);
  EXPECT_TRUE(is_refused(read_cloud(folder_ / "folder.ply"), "found a folder"));
  EXPECT_TRUE(is_refused(read_cloud(folder_ / "pipe.ply"), "pipe"));
  EXPECT_TRUE(is_refused(read_cloud(folder_.write("empty.ply", "")), "empty"));
  EXPECT_TRUE(is_refused(read_cloud(folder_.write("a.docx", "x")), ".ply .pcd"));
  EXPECT_TRUE(is_refused(read_cloud(folder_.write("none", "x")), ".ply .pcd"));
  EXPECT_EQ(read_cloud(folder_ / "missing.ply").error().code, ErrorCode::missing_input);
  EXPECT_EQ(read_cloud(folder_ / "pipe.ply" / "below.ply").error().code, ErrorCode::missing_input);
}

TEST_F(HostileCloud, ExtensionsAreKnownInAnyCase) {
  for (const char* name : {"a.ply", "a.PLY", "b.Stl", "c.obj", "d.off", "e.pcd", "f.xyz", "g.pts",
                           "h.asc", "g.npy", "h.glb", "i.gltf", "a.ply.gz", "b.STL.GZ"})
    EXPECT_TRUE(is_cloud_file(name)) << name;
  for (const char* name :
       {"a.png", "README.txt", "a.csv", "ply", ".ply", "a", "a.gz", "a.txt.gz", ".gz"})
    EXPECT_FALSE(is_cloud_file(name)) << name;
  for (const char* name : {"a.png", "a.PNG.gz", "a.npy", "a.tif", "a.TIFF"})
    EXPECT_TRUE(is_depth_file(name)) << name;
  for (const char* name : {"a.ply", "png", "a.gz"}) EXPECT_FALSE(is_depth_file(name)) << name;
}

}  // namespace
}  // namespace trivet
