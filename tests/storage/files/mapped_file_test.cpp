// Tests of files that other processes write while they are mapped or read.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "storage/files/file.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using State = MappedFile::State;

constexpr std::size_t kPages = 64, kPageBytes = 4096;

Result<MappedFile> map(const fs::path& file, Writers writers) {
  return MappedFile::open(file, std::size_t{1} << 30U, writers);
}

/// Overwrites the existing file in place, as `cp` does.
void overwrite(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

TEST(MappedFile, ReadsAsZerosWhereItsFileWasCutOffAndIsTorn) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", std::string(kPages * kPageBytes, 'x'));
  const fs::path other = folder.write("b", std::string(kPages * kPageBytes, 'y'));
  for (const Writers writers : {Writers::none, Writers::others}) {
    overwrite(file, std::string(kPages * kPageBytes, 'x'));
    const auto cut = map(file, writers), whole = map(other, writers);
    ASSERT_TRUE(cut && whole);
    fs::resize_file(file, 2 * kPageBytes);
    EXPECT_EQ(cut->bytes()[kPageBytes], std::byte{'x'});
    // Accesses from the end, then before it, then from the first page on. Each run maps the file
    // again.
    for (const std::size_t at :
         {kPages * kPageBytes - 1, 10 * kPageBytes, 2 * kPageBytes, 63 * kPageBytes})
      EXPECT_EQ(cut->bytes()[at], std::byte{0}) << at;
    EXPECT_EQ(cut->bytes()[kPageBytes], std::byte{'x'});
    EXPECT_EQ(cut->state(), State::changed);
    EXPECT_EQ(whole->state(), State::same);
    EXPECT_EQ(whole->bytes().back(), std::byte{'y'});
  }
}

// A copy is of whole pieces of a megabyte. The file has four.
TEST(MappedFile, KeepsWhatWasCopiedWhateverHappensToItsFile) {
  constexpr std::size_t kPiece = std::size_t{1} << 20U, kBytes = 4 * kPiece - 100;
  const test::TempDir folder;
  const auto changes = {
      +[](const fs::path& file) { overwrite(file, std::string(kBytes, 'y')); },
      +[](const fs::path& file) { overwrite(file, ""); },
      +[](const fs::path& file) { fs::resize_file(file, kPageBytes); },
  };
  for (const auto change : changes) {
    const fs::path file = folder.write("a", std::string(kBytes, 'x'));
    const auto mapped = map(file, Writers::others);
    ASSERT_TRUE(mapped && mapped->has_memory());
    const std::span<const std::byte> bytes = mapped->bytes();
    ASSERT_TRUE(mapped->copy(bytes.subspan(kPiece + 5, 3)));
    ASSERT_TRUE(mapped->copy(bytes.last(1)));
    change(file);
    EXPECT_EQ(mapped->state(), State::changed);
    const std::byte begin = bytes[kPageBytes], third = bytes[2 * kPiece + kPageBytes];
    for (const std::size_t copied : {kPiece, 2 * kPiece - 1, 3 * kPiece, kBytes - 1})
      EXPECT_EQ(bytes[copied], std::byte{'x'}) << copied;
    const std::byte now = fs::file_size(file) == kBytes ? std::byte{'y'} : std::byte{0};
    EXPECT_EQ(begin, now);
    EXPECT_EQ(third, now);
  }
}

TEST(MappedFile, IsItsFileAgainWhenItsCopiesAreDropped) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", std::string(3 * kPageBytes, 'x'));
  const auto mapped = map(file, Writers::others), own = map(file, Writers::none);
  ASSERT_TRUE(mapped && own && mapped->copy(mapped->bytes()));
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary) << 'y';
  EXPECT_EQ(mapped->bytes()[0], std::byte{'x'});
  const auto again = mapped->mapped_again();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->bytes()[0], std::byte{'y'});
  mapped->drop_copies();
  EXPECT_EQ(mapped->bytes()[0], std::byte{'y'});
  ASSERT_TRUE(mapped->copy(mapped->bytes()));
  EXPECT_EQ(mapped->bytes()[0], std::byte{'y'});
  EXPECT_FALSE(own->has_memory());
  EXPECT_TRUE(own->copy(own->bytes()));
}

TEST(MappedFile, IsCopiedOnceByManyThreads) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", std::string(std::size_t{5} << 20U, 'x'));
  const auto mapped = map(file, Writers::others);
  ASSERT_TRUE(mapped);
  std::vector<std::thread> threads;
  std::atomic<int> good{0};
  for (std::size_t t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      const auto part = mapped->bytes().subspan(t * 500'000, 1'500'000);
      if (mapped->copy(part) && std::ranges::count(part, std::byte{'x'}) == 1'500'000) ++good;
    });
  }
  for (std::thread& thread : threads) thread.join();
  overwrite(file, "");
  EXPECT_EQ(good, 8);
  EXPECT_EQ(std::ranges::count(mapped->bytes(), std::byte{'x'}), std::ptrdiff_t{5} << 20U);
}

TEST(MappedFile, LeavesTheFaultsOfOthersToThem) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", std::string(kPageBytes, 'x'));
  const auto guarded = map(file, Writers::others);  // installs the handler
  ASSERT_TRUE(guarded);
  const int descriptor = ::open(folder.write("b", std::string(kPageBytes, 'x')).c_str(), O_RDWR);
  void* const memory = ::mmap(nullptr, kPageBytes, PROT_READ, MAP_PRIVATE, descriptor, 0);
  ASSERT_NE(memory, MAP_FAILED);
  ASSERT_EQ(::ftruncate(descriptor, 0), 0);
#ifdef __SANITIZE_ADDRESS__
  EXPECT_DEATH((void)*static_cast<volatile char*>(memory), "BUS");
#else
  EXPECT_EXIT((void)*static_cast<volatile char*>(memory), testing::KilledBySignal(SIGBUS), "");
#endif
  ::munmap(memory, kPageBytes);
  ::close(descriptor);
}

TEST(MappedFile, DetectsChangesInPlace) {
  const test::TempDir folder;
  const std::string bytes(3 * kPageBytes, 'x');
  const auto changes = {
      +[](const fs::path& file) { overwrite(file, std::string(3 * kPageBytes, 'y')); },
      +[](const fs::path& file) { fs::resize_file(file, kPageBytes); },
      +[](const fs::path& file) { fs::resize_file(file, 5 * kPageBytes); },
      +[](const fs::path& file) { std::fstream(file).seekp(17) << 'y'; },
  };
  for (const auto change : changes) {
    const fs::path file = folder.write("a", bytes);
    const auto mapped = map(file, Writers::others);
    ASSERT_TRUE(mapped);
    EXPECT_EQ(mapped->state(), State::same);
    change(file);
    EXPECT_EQ(mapped->state(), State::changed);
    overwrite(file, bytes);
    EXPECT_EQ(mapped->state(), State::changed) << "what was built from other bytes stays wrong";
  }
}

TEST(MappedFile, IsTheSameWhenAnotherFileGetsItsName) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", "some bytes");
  const auto mapped = map(file, Writers::others);
  ASSERT_TRUE(mapped && mapped->is_at(file));
  fs::rename(folder.write("b", "other bytes"), file);
  EXPECT_EQ(mapped->state(), State::same);
  EXPECT_FALSE(mapped->is_at(file));
}

TEST(MappedFile, IsTouchedByWhatMayHaveSetItsTimeBack) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", "some bytes");
  const auto mapped = map(file, Writers::others);
  ASSERT_TRUE(mapped);
  const auto written = fs::last_write_time(file);
  overwrite(file, "SOME BYTES");
  fs::last_write_time(file, written);
  EXPECT_EQ(mapped->state(), State::touched);
  mapped->accept_touch(mapped->time_of_touch());
  EXPECT_EQ(mapped->state(), State::same);
  fs::rename(file, folder / "b");
  EXPECT_EQ(mapped->state(), State::touched);
}

TEST(ReadFile, GivesTheFullFileWithinBounds) {
  const test::TempDir folder;
  const std::string bytes(100 * kPageBytes, 'a');
  const fs::path file = folder.write("a", bytes);
  EXPECT_EQ(read_text_file(file, bytes.size()).value(), bytes);
  EXPECT_EQ(read_file(file, bytes.size()).value().size(), bytes.size());
  EXPECT_EQ(read_text_file(file, bytes.size() - 1).error().code, ErrorCode::bad_data);
  EXPECT_EQ(read_file(folder / "none", 10).error().code, ErrorCode::missing_input);
  EXPECT_EQ(read_file(folder.path(), 10).error().code, ErrorCode::bad_data);
  EXPECT_EQ(read_file(folder.write("empty", ""), 0).value().size(), 0U);
}

TEST(ReadFile, DetectsThatTheFileWasWrittenMeanwhile) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", "");
  fs::resize_file(file, std::size_t{32} << 20U);
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1000);
  fs::last_write_time(file, long_ago);
  const std::jthread writer([&](const std::stop_token& stop) {
    for (int i = 0; !stop.stop_requested(); ++i)
      fs::last_write_time(file, long_ago + std::chrono::milliseconds(i));
  });
  std::optional<ErrorCode> refused;
  for (int i = 0; i < 100 && !refused; ++i) {
    if (const auto read = read_file(file, std::size_t{32} << 20U); !read)
      refused = read.error().code;
  }
  EXPECT_EQ(refused, ErrorCode::changed);
}

// Two writes within one tick of the system clock have the same modification time.
TEST(ReadFile, WaitsUntilAnyFurtherWritingWouldHaveAnotherTime) {
  const test::TempDir folder;
  const fs::path file = folder.write("a", "bytes");
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(read_file(file, 10));
    const auto written = fs::last_write_time(file);
    overwrite(file, "BYTES");
    EXPECT_NE(fs::last_write_time(file), written);
  }
}

mode_t mode_of(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? status.st_mode & 0777U : 0;
}

TEST(PublishFile, KeepsTheModeOfWhatItReplaces) {
  const test::TempDir folder;
  const auto bytes = std::as_bytes(std::span("text", 4));
  for (const mode_t mode : {0640U, 0600U, 0664U, 0444U}) {
    const fs::path file = folder.write("a", "old");
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    ASSERT_TRUE(publish_file(file, bytes));
    EXPECT_EQ(mode_of(file), mode);
  }
  const mode_t mask = ::umask(027);
  ASSERT_TRUE(publish_file(folder / "new", bytes));
  ::umask(mask);
  EXPECT_EQ(mode_of(folder / "new"), 0640U);
}

TEST(PublishFile, KeepsOwnerAndGroupWhereItMay) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root may give files away";
  const test::TempDir folder;
  const fs::path file = folder.write("a", "old");
  ASSERT_EQ(::chown(file.c_str(), 12345, 23456), 0);
  ASSERT_TRUE(publish_file(file, std::as_bytes(std::span("text", 4))));
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, 12345U);
  EXPECT_EQ(status.st_gid, 23456U);
}

TEST(PublishFile, ReplacesTheTargetOfALinkAndLeavesTheLink) {
  const test::TempDir folder;
  fs::create_directory(folder / "versions");
  folder.write("versions/1", "old");
  fs::create_symlink("versions/current", folder / "link");
  fs::create_symlink("1", folder / "versions/current");
  fs::create_symlink("versions/none yet", folder / "dangling");
  const auto bytes = std::as_bytes(std::span("text", 4));
  ASSERT_TRUE(publish_file(folder / "link", bytes));
  ASSERT_TRUE(publish_file(folder / "dangling", bytes));
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "versions/current"));
  EXPECT_EQ(test::read_bytes(folder / "versions/1"), "text");
  EXPECT_EQ(test::read_bytes(folder / "versions/none yet"), "text");
  EXPECT_TRUE(fs::is_symlink(folder / "dangling"));
  // A cycle of symbolic links leads nowhere.
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_NO_FATAL_FAILURE((void)publish_file(folder / "a", bytes));
}

}  // namespace
}  // namespace trivet
