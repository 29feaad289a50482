#include "storage/files/file_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "support/temp_dir.hpp"

namespace trivet {
namespace {

TEST(FileLock, IsHeldByOneAtATimeAndLeavesNothing) {
  const test::TempDir folder;
  {
    const auto first = FileLock::acquire(folder / "library.h5");
    ASSERT_TRUE(first) << first.error().message;
    const auto second = FileLock::acquire(folder / "library.h5");
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::cannot_create);
    EXPECT_NE(second.error().message.find(std::to_string(::getpid())), std::string::npos)
        << second.error().message;
    EXPECT_TRUE(FileLock::acquire(folder / "other.h5"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_TRUE(FileLock::acquire(folder / "library.h5"));
}

TEST(FileLock, EndsWithItsProcess) {
  const test::TempDir folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = FileLock::acquire(folder / "library.h5");
    ::raise(SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  ASSERT_FALSE(std::filesystem::is_empty(folder.path())) << "its file is still there";
  folder.write(".library.h5.123.0.tmp", "half");
  folder.write(".library.h5.new.tmp", "a file of somebody else");
  const auto lock = FileLock::acquire(folder / "library.h5");
  ASSERT_TRUE(lock) << lock.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder / ".library.h5.123.0.tmp"));
  EXPECT_TRUE(std::filesystem::exists(folder / ".library.h5.new.tmp"));
}

TEST(FileLock, NeedsAFolder) {
  const test::TempDir folder;
  const auto lock = FileLock::acquire(folder / "none/library.h5");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().code, ErrorCode::cannot_create);
}

}  // namespace
}  // namespace trivet
