/// Libraries rewritten by HDF5's command-line tools.
#include <gtest/gtest.h>
#include <signal.h>

#include "apps/commands/in_child.hpp"
#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class LibraryImport : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    ASSERT_TRUE(write_ply(*folder_ / "bracket.ply", test::cloud_of(test::bracket())));
    ASSERT_TRUE(write_ply(*folder_ / "lever.ply", test::cloud_of(test::lever())));
    const test::Outcome trained =
        trivet({"train", "bracket.ply", "lever.ply", "-o", "library.h5", "--preset", "fast"});
    ASSERT_EQ(trained.exit_code, 0) << trained.error;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override {
    if (std::string(TRIVET_H5REPACK).empty()) GTEST_SKIP() << "needs h5repack";
  }

  static test::Setting here() {
    return {.folder = folder_->path(), .environment = {}, .watch = {}};
  }
  static test::Outcome trivet(const std::vector<std::string>& arguments) {
    return test::run_trivet(arguments, here());
  }
  /// Rewrites the library as repacked.h5.
  static void repack(std::vector<std::string> options) {
    options.insert(options.end(), {"library.h5", "repacked.h5"});
    const test::Outcome outcome = test::run_program(TRIVET_H5REPACK, options, here());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.error;
  }
  static test::Outcome import_repacked() {
    std::filesystem::remove(*folder_ / "imported.h5");
    return trivet({"library", "import", "repacked.h5", "-o", "imported.h5"});
  }
  static std::string bytes(const std::string& name) { return test::read_bytes(*folder_ / name); }
  static inline std::unique_ptr<test::TempDir> folder_;
};

// Filters need chunks, which an empty dataset cannot have; -m skips such datasets.
TEST_F(LibraryImport, GivesTheBytesThatWereRepacked) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{},
        {"-m", "1024", "-f", "SHUF", "-f", "GZIP=6"},
        {"-L", "-m", "1024", "-f", "GZIP=1", "-f", "FLET"},
        {"-L"},
        {"-l", "CONTI", "-f", "NONE"}}) {
    const std::string description = testing::PrintToString(options);
    repack(options);
    EXPECT_NE(bytes("repacked.h5"), bytes("library.h5")) << description;
    const test::Outcome imported = import_repacked();
    ASSERT_EQ(imported.exit_code, 0) << description << imported.error;
    EXPECT_TRUE(bytes("imported.h5") == bytes("library.h5")) << description;
  }
}

TEST_F(LibraryImport, IsWhatAnErrorOfOpeningAdvises) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{}, {"-L", "-m", "1024", "-f", "GZIP=1"}}) {
    repack(options);
    const test::Outcome refused = trivet({"library", "list", "repacked.h5"});
    EXPECT_EQ(refused.exit_code, 65);
    EXPECT_NE(refused.error.find("trivet library import"), std::string::npos) << refused.error;
  }
}

TEST_F(LibraryImport, RefusesWhatIsDamagedAndSaysWhere) {
  repack({"-m", "1024", "-f", "GZIP=1"});
  const std::string intact = bytes("repacked.h5");
  folder_->write("repacked.h5", intact.substr(0, intact.size() / 2));
  EXPECT_EQ(import_repacked().exit_code, 65);

  repack({});  // HDF5 does not detect a change of contiguous data
  std::string changed = bytes("repacked.h5");
  const std::size_t middle = changed.size() / 2;
  changed[middle] = static_cast<char>(changed[middle] ^ 1);
  folder_->write("repacked.h5", changed);
  const test::Outcome outcome = import_repacked();
  EXPECT_EQ(outcome.exit_code, 65) << outcome.error;
  EXPECT_NE(outcome.error.find("expected checksum"), std::string::npos) << outcome.error;
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "imported.h5"));
}

// Old structures have no checksums, and HDF5 may end the process when it trusts them.
TEST(InChild, ReportsTheOutcomeOfTheWork) {
  const Error broken{ErrorCode::bad_data, "broken"};
  EXPECT_TRUE(apps::in_child([] { return Result<void>(); }, broken));

  const std::string message(100'000, 'x');  // exceeds the capacity of a pipe
  const Result<void> failed = apps::in_child(
      [&]() -> Result<void> {
        return Error{ErrorCode::cannot_create, message};
      },
      broken);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::cannot_create);
  EXPECT_EQ(failed.error().message, message);

  const Result<void> ended = apps::in_child(
      []() -> Result<void> {
        ::raise(SIGKILL);
        return {};
      },
      broken);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, ErrorCode::bad_data);
  EXPECT_EQ(ended.error().message, "broken");
}

// The root's attributes identify the file format, and h5copy omits them.
TEST_F(LibraryImport, RefusesACopyWithoutTheRoot) {
  if (std::string(TRIVET_H5COPY).empty()) GTEST_SKIP() << "needs h5copy";
  std::filesystem::remove(*folder_ / "repacked.h5");  // it appends to an existing file
  const test::Outcome copied = test::run_program(
      TRIVET_H5COPY, {"-i", "library.h5", "-o", "repacked.h5", "-s", "/models", "-d", "/all"},
      here());
  ASSERT_EQ(copied.exit_code, 0) << copied.error;
  const test::Outcome outcome = import_repacked();
  EXPECT_EQ(outcome.exit_code, 65);
  EXPECT_NE(outcome.error.find("@format"), std::string::npos) << outcome.error;
  std::filesystem::remove(*folder_ / "repacked.h5");
}

}  // namespace
}  // namespace trivet
