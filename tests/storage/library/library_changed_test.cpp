// A library that other processes overwrite in place is detected, and no longer read.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "storage/library/library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using test::random_model;
using test::read_bytes;

class LibraryChangedTest : public test::LibraryTest {
 protected:
  LibraryChangedTest() {
    write("lib.h5", 1);
    bytes_ = read_bytes(file());
  }
  void write(const char* name, std::uint64_t seed) const {
    auto writer = LibraryWriter::create(folder() / name, {LengthUnit::meter, "trivet test", "{}"});
    if (!writer || !writer->add(basis_) || !writer->add(random_model("a", seed)) ||
        !writer->publish())
      throw std::runtime_error("cannot write the library");
  }
  void overwrite(std::string_view bytes) const {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
  }
  static void expect_changed(const Library& library, const fs::path& file) {
    const Result<void> same = library.unchanged();
    ASSERT_FALSE(same);
    EXPECT_EQ(same.error().code, ErrorCode::changed);
    EXPECT_NE(same.error().message.find(file.string()), std::string::npos);
    EXPECT_TRUE(library.is_changed());
  }

  const TriSpinBasis basis_ = test::random_basis(3, test::kRandomComponents);
  std::string bytes_;
};

TEST_F(LibraryChangedTest, StaysWhereAnotherGetsItsName) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library);
  ASSERT_TRUE(library->samples(0));
  EXPECT_TRUE(library->unchanged());
  write("new.h5", 2);
  fs::rename(folder() / "new.h5", file());
  EXPECT_TRUE(library->unchanged());
  EXPECT_TRUE(library->check_all());
  const Result<Library> next = open_library(file());
  fs::rename(file(), folder() / "kept.h5");
  fs::create_hard_link(folder() / "kept.h5", folder() / "another.h5");
  fs::permissions(folder() / "kept.h5", fs::perms::owner_read);
  EXPECT_TRUE(next && next->unchanged() && next->check_all() && next->unchanged());
  EXPECT_FALSE(next->is_changed());
}

TEST_F(LibraryChangedTest, IsReportedByNameAndStaysChanged) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library && library->check_all());
  overwrite(bytes_);  // same bytes, but a reader may have seen others in between
  expect_changed(*library, file());
  const Result<Library> reopened = open_library(file());
  EXPECT_TRUE(reopened && reopened->check_all() && reopened->unchanged());
}

TEST_F(LibraryChangedTest, IsNoFaultOfTheProcessWhenItIsCutOff) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library);
  overwrite("");
  const Result<void> checked = library->check_all();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::changed) << checked.error().message;
  expect_changed(*library, file());
}

// A scene that is being searched goes on with what it began with: other bytes would be indices
// out of bounds.
TEST_F(LibraryChangedTest, WhatWasCheckedStaysInAnOpenLibrary) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library);
  const auto samples = library->samples(0);
  const auto pairs = library->pairs(0);
  ASSERT_TRUE(samples && pairs);
  const std::vector<float> x((*samples)->samples.x.begin(), (*samples)->samples.x.end());
  const auto offsets = (*pairs)->ppf.offsets;
  const std::vector<std::uint32_t> begins(offsets.begin(), offsets.end());
  for (const std::string& bytes : {std::string(bytes_.size(), '\xff'), std::string()}) {
    overwrite(bytes);
    EXPECT_TRUE(std::ranges::equal((*samples)->samples.x, x));
    EXPECT_TRUE(std::ranges::equal((*pairs)->ppf.offsets, begins));
  }
  library->release_memory(0);
  EXPECT_TRUE(std::ranges::equal((*samples)->samples.x, x)) << "copies of a changed file stay";
  expect_changed(*library, file());
}

TEST_F(LibraryChangedTest, IsCheckedAgainAfterItsMemoryWasReleased) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library && library->check_all());
  library->release_memory(0);
  EXPECT_TRUE(library->check_all());
  library->release_memory(0);
  overwrite(std::string(bytes_.size(), '\xff'));
  const Result<void> checked = library->check_all();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::changed);
}

TEST_F(LibraryChangedTest, IsFoundChangedThoughItsTimeWasSetBack) {
  const Result<Library> library = open_library(file());
  ASSERT_TRUE(library && library->check_all());
  const auto written = fs::last_write_time(file());
  const std::span<const float> column = (*library->samples(0))->samples.x;
  const auto at = static_cast<std::streamoff>(
      bytes_.find(std::string_view(reinterpret_cast<const char*>(column.data()), 16)));
  std::fstream(file(), std::ios::in | std::ios::out | std::ios::binary).seekp(at) << "other";
  fs::last_write_time(file(), written);
  EXPECT_FALSE(library->is_changed()) << "only the bytes can show it";
  expect_changed(*library, file());
}

// Opening a file during a write fails or gives one of the written libraries.
TEST_F(LibraryChangedTest, IsNeverReadAsAMixtureOfTwo) {
  write("new.h5", 2);
  const std::string other = read_bytes(folder() / "new.h5");
  std::mt19937 random(7);
  for (int i = 0; i < 60; ++i) {
    overwrite(i % 2 == 0 ? bytes_ : other);
    const Result<Library> library = open_library(file());
    ASSERT_TRUE(library) << library.error().message;
    const std::size_t cut = random() % bytes_.size();
    if (i % 3 == 0) {
      overwrite((i % 2 == 0 ? other : bytes_).substr(0, cut));
    } else {
      std::fstream(file(), std::ios::in | std::ios::out | std::ios::binary)
          .seekp(static_cast<std::streamoff>(cut))
          .put('\x55');
    }
    const Result<void> checked = library->check_all();
    EXPECT_TRUE(checked || checked.error().code == ErrorCode::changed) << checked.error().message;
    expect_changed(*library, file());
  }
}

}  // namespace
}  // namespace trivet
