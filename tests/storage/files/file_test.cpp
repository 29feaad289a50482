#include "storage/files/file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>

#include "storage/files/descriptor.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

std::string text_of(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}
std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}
std::ptrdiff_t count_files(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), {});
}

TEST(MappedFile, ShowsTheFullFile) {
  const test::TempDir folder;
  const auto file = MappedFile::open(folder.write("a", "some bytes"), 10);
  const auto empty = MappedFile::open(folder.write("b", ""), 0);
  ASSERT_TRUE(file && empty);
  EXPECT_EQ(text_of(*file), "some bytes");
  EXPECT_TRUE(empty->bytes().empty());
}

TEST(MappedFile, RefusesMissingLargeAndIrregularFiles) {
  const test::TempDir folder;
  EXPECT_EQ(MappedFile::open(folder / "none", 10).error().code, ErrorCode::missing_input);
  EXPECT_EQ(MappedFile::open("", 10).error().code, ErrorCode::missing_input);
  EXPECT_EQ(MappedFile::open(folder.write("a", "some bytes"), 9).error().code, ErrorCode::bad_data);
  EXPECT_EQ(MappedFile::open(folder.path(), 10).error().code, ErrorCode::bad_data);
  EXPECT_EQ(MappedFile::open("/dev/zero", 10).error().code, ErrorCode::bad_data);
}

TEST(MappedFile, KeepsItsBytesWhenTheFileIsReplacedOrTheObjectGone) {
  const test::TempDir folder;
  auto file = MappedFile::open(folder.write("a", "old"), 10);
  ASSERT_TRUE(file);
  const auto owner = file->owner();
  ASSERT_TRUE(publish_file(folder / "a", bytes_of("new and longer")));
  EXPECT_EQ(text_of(*file), "old");
  *file = MappedFile();
  EXPECT_EQ(static_cast<char>(*owner), 'o');
}

TEST(PublishFile, ReplacesTheFileAndLeavesNothingElse) {
  const test::TempDir folder;
  ASSERT_TRUE(publish_file(folder / "a", bytes_of("first")));
  ASSERT_TRUE(publish_file(folder / "a", bytes_of("second")));
  ASSERT_TRUE(publish_file(folder / "b", {}));
  EXPECT_EQ(test::read_bytes(folder / "a"), "second");
  EXPECT_EQ(fs::file_size(folder / "b"), 0U);
  EXPECT_EQ(count_files(folder.path()), 2);
}

TEST(PublishFile, LeavesNothingWhereItCannotWrite) {
  const test::TempDir folder;
  fs::create_directories(folder / "taken/inside");
  const auto no_folder = publish_file(folder / "none/a", bytes_of("x"));
  const auto published = publish_file(folder / "taken", bytes_of("x"));
  ASSERT_FALSE(no_folder || published);
  EXPECT_EQ(no_folder.error().code, ErrorCode::cannot_create);
  EXPECT_EQ(published.error().code, ErrorCode::cannot_create);
  EXPECT_EQ(count_files(folder.path()), 1);
}

// A program of root that replaces /dev/null by a file breaks all others.
TEST(PublishFile, WritesToPipesAndDevicesInsteadOfReplacingThem) {
  const test::TempDir folder;
  const fs::path pipe = folder / "pipe", device = folder / "device";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/null", device);
  const Descriptor reader(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  ASSERT_TRUE(reader);
  ASSERT_TRUE(publish_file(pipe, bytes_of("result")));
  ASSERT_TRUE(publish_file(device, bytes_of("result")));
  std::array<char, 16> read{};
  EXPECT_EQ(::read(reader.get(), read.data(), read.size()), 6);
  EXPECT_EQ(std::string_view(read.data()), "result");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_TRUE(fs::is_symlink(device) && fs::is_character_file(device));
  EXPECT_EQ(count_files(folder.path()), 2);
  for (const fs::path& file : {pipe, device}) {
    const auto pending = PendingFile::create(file);
    ASSERT_FALSE(pending) << "a library is no stream of bytes";
    EXPECT_EQ(pending.error().code, ErrorCode::cannot_create);
  }
}

TEST(ReleasePagesAround, LeavesAllBytesAsTheyWere) {
  const test::TempDir folder;
  std::string text(300'000, 'a');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i / 1000 % 26);
  const auto mapped = MappedFile::open(folder.write("file", text), text.size());
  ASSERT_TRUE(mapped);
  const auto bytes = mapped->bytes();
  for (const std::size_t first : {std::size_t{0}, std::size_t{100'001}, std::size_t{299'999}})
    release_pages_around(bytes.subspan(first, 1), bytes);
  release_pages_around(bytes, bytes);
  EXPECT_TRUE(std::ranges::equal(bytes, std::as_bytes(std::span(text))));

  std::vector<std::byte> elsewhere(300'000, std::byte{5});  // would hold zeros if it were returned
  release_pages_around(elsewhere, bytes);
  release_pages_around(elsewhere, {});
  EXPECT_TRUE(std::ranges::all_of(elsewhere, [](std::byte b) { return b == std::byte{5}; }));
}

TEST(Xxh3OfMapped, IsThatOfTheBytes) {
  const test::TempDir folder;
  std::string text;
  for (int i = 0; i < 4'000'000; ++i) text += std::to_string(i % 997);
  const auto mapped = MappedFile::open(folder.write("large", text), text.size());
  ASSERT_TRUE(mapped);
  for (const std::size_t from : {std::size_t{0}, std::size_t{4097}}) {
    const auto bytes = mapped->bytes().subspan(from);
    EXPECT_EQ(xxh3_of_mapped(bytes), xxh3(bytes)) << from;
  }
  EXPECT_EQ(xxh3_of_mapped({}), xxh3({}));
  EXPECT_TRUE(std::ranges::equal(mapped->bytes(), std::as_bytes(std::span(text))));
}

TEST(Xxh3Hex, IsTheCanonicalXxh3Of128Bits) {
  // The digest of no bytes in the published test vectors of xxHash 0.8.
  EXPECT_EQ(xxh3_hex({}), "99aa06d3014798d86001c324468d497f");
  EXPECT_NE(xxh3_hex(bytes_of("a")), xxh3_hex(bytes_of("b")));
}

}  // namespace
}  // namespace trivet
