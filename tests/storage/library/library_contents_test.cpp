// The contents reported by an unfinished library, for resuming its training.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <span>
#include <string>

#include "storage/library/library.hpp"
#include "support/craft_library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using test::difference;
using test::random_model;

/// A library of three models, two of which were reported before the last one was added.
class LibraryContents : public test::LibraryTest {
 protected:
  LibraryContents() {
    auto writer = LibraryWriter::create_lasting(file(), unfinished(), header_);
    EXPECT_TRUE(writer && writer->add(basis_));
    EXPECT_TRUE(writer->add(models_[0]) && writer->add(models_[1]));
    EXPECT_TRUE(writer->write_contents(contents(0)));
    EXPECT_TRUE(writer->add(models_[2]));
    EXPECT_TRUE(writer->write_contents(contents(1)));
    writer_ = std::move(*writer);
  }
  fs::path unfinished() const { return folder() / "0.models"; }
  fs::path contents(int n) const { return folder() / ("contents-" + std::to_string(n)); }

  LibraryHeader header_{LengthUnit::millimeter, "trivet test", "{}"};
  TriSpinBasis basis_ = test::random_basis(5, test::kRandomComponents);
  std::array<Model, 3> models_{random_model("m1", 1), random_model("m0", 2), random_model("m2", 3)};
  std::optional<LibraryWriter> writer_;
};

TEST_F(LibraryContents, OutlastTheWriter) {
  writer_.reset();
  EXPECT_FALSE(fs::exists(file()));
  const auto first = open_contents(contents(0));
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(first->check_all()) << first->check_all().error().message;
  EXPECT_EQ(first->header, header_);
  ASSERT_EQ(first->models.size(), 2U);
  EXPECT_EQ(difference(*first->model(0), models_[1]), "");
  EXPECT_EQ(difference(*first->model(1), models_[0]), "");
  const auto second = open_contents(contents(1));
  ASSERT_TRUE(second) << second.error().message;
  ASSERT_EQ(second->models.size(), 1U);
  EXPECT_EQ(difference(*second->model(0), models_[2]), "");
}

TEST_F(LibraryContents, AreOfNoConcernToTheLibrary) {
  ASSERT_TRUE(writer_->publish());
  EXPECT_FALSE(fs::exists(unfinished()));
  const std::string published = test::read_bytes(file());
  auto writer = LibraryWriter::create(file(), header_);
  ASSERT_TRUE(writer && writer->add(basis_));
  for (const Model& model : models_) ASSERT_TRUE(writer->add(model));
  ASSERT_TRUE(writer->publish());
  EXPECT_TRUE(test::read_bytes(file()) == published);
}

TEST_F(LibraryContents, AreNoLibrary) {
  const auto opened = open_library(contents(0));
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("what training keeps beside one"), std::string::npos)
      << opened.error().message;
  EXPECT_FALSE(open_contents(unfinished()));
  ASSERT_TRUE(writer_->publish());
  EXPECT_FALSE(open_contents(file()));
  EXPECT_FALSE(open_contents(contents(0))) << "the models are not where they were";
}

TEST_F(LibraryContents, ShowDamageOfTheFileThatTheyDescribe) {
  writer_.reset();
  std::string bytes = test::read_bytes(unfinished());
  const Library first = *open_contents(contents(0));
  // The last byte of the last large column of a model.
  const std::span<const PpfEntry> entries = (*first.pairs(0))->ppf.entries;
  const std::string_view column(reinterpret_cast<const char*>(entries.data()),
                                entries.size_bytes());
  const std::size_t at = bytes.find(column);
  ASSERT_NE(at, bytes.npos);
  bytes[at + column.size() - 1] ^= 1;
  { std::ofstream(unfinished(), std::ios::binary) << bytes; }
  const auto damaged = open_contents(contents(0));
  ASSERT_TRUE(damaged) << damaged.error().message;
  EXPECT_FALSE(damaged->check_all());
  fs::resize_file(unfinished(), at);
  const auto truncated = open_contents(contents(0));
  ASSERT_FALSE(truncated);
  EXPECT_EQ(truncated.error().code, ErrorCode::bad_data);
  EXPECT_NE(truncated.error().message.find("inside the file"), std::string::npos)
      << truncated.error().message;
}

/// Reports the first model in a child process with a file size limit; returns the exit code.
int save_contents_of_first(const fs::path& folder, const TriSpinBasis& basis, rlim_t limit,
                           std::span<const Model> models) {
  std::signal(SIGXFSZ, SIG_IGN);  // makes writes fail instead
  const rlimit room{limit, limit};
  ::setrlimit(RLIMIT_FSIZE, &room);
  auto writer = LibraryWriter::create_lasting(folder / "full.h5", folder / "1.models",
                                              {LengthUnit::millimeter, "trivet test", "{}"});
  if (!writer || !writer->add(basis)) return 1;
  if (!writer->add(models[0])) return 2;
  if (writer->add(models[1])) return 3;
  return writer->write_contents(folder / "contents-full") ? 0 : 4;
}

TEST_F(LibraryContents, ListTheModelsWrittenBeforeTheDiskWasFull) {
  const Model large = random_model(
      "large", 3, {.num_entries = 50000, .num_distance_bins = 20, .num_angle_bins = 10});
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0)
    std::exit(save_contents_of_first(folder(), basis_, 300'000, std::array{models_[0], large}));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  ASSERT_EQ(WEXITSTATUS(status), 0);
  const auto kept = open_contents(folder() / "contents-full");
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_TRUE(kept->check_all());
  ASSERT_EQ(kept->models.size(), 1U);
  EXPECT_EQ(difference(*kept->model(0), models_[0]), "");
}

TEST_F(LibraryContents, ReportAFileInTheWay) {
  const auto again = LibraryWriter::create_lasting(file(), unfinished(), header_);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::cannot_create);
}

}  // namespace
}  // namespace trivet
