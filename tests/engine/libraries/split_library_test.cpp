#include "engine/libraries/split_library.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

class SplitLibrary : public test::LibraryTest {
 protected:
  /// Models a, b, c ... with pair tables of these sizes, all of one step.
  Library library_of(const std::vector<std::size_t>& num_entries, bool has_features) const {
    Result<LibraryWriter> writer =
        LibraryWriter::create(file(), {LengthUnit::millimeter, "test", "{}"});
    EXPECT_TRUE(writer);
    if (has_features) {
      EXPECT_TRUE(writer->add(test::random_basis(1, test::kRandomComponents)));
    }
    char name = 'a';
    for (const std::size_t n : num_entries) {
      test::RandomModelSize size{.num_entries = n};
      if (!has_features) size.num_features = 0;
      EXPECT_TRUE(writer->add(test::random_model(std::string(1, name++), 7, size)));
    }
    EXPECT_TRUE(writer->publish());
    return *open_library(file());
  }
};

TEST_F(SplitLibrary, KeepsEveryModelAndTheComponentsAsTheyAre) {
  const Library whole = library_of({500, 400, 300, 200, 100}, true);
  const auto files = split_library(whole, 2, folder() / "parts");
  ASSERT_TRUE(files) << files.error().message;
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ(files->front().filename(), "lib-1.h5");
  std::set<std::string> names;
  for (const auto& part_file : *files) {
    const Result<Library> part = open_library(part_file);
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_EQ(part->header.unit, whole.header.unit);
    EXPECT_EQ(part->header.parameters, whole.header.parameters);
    EXPECT_EQ(test::difference(part->basis, whole.basis), "");
    for (const Model& model : part->models) {
      EXPECT_TRUE(names.insert(model.name).second);
      const auto same = std::ranges::find(whole.models, model.name, &Model::name);
      ASSERT_NE(same, whole.models.end());
      EXPECT_EQ(test::difference(model, *same), "");
    }
  }
  EXPECT_EQ(names.size(), 5U);
}

TEST_F(SplitLibrary, BalancesBytesAndLeavesNoPartEmpty) {
  const auto sizes = [&](const std::vector<std::size_t>& num_entries, std::size_t num_parts) {
    std::vector<std::size_t> out;
    for (const auto& part : split_models(library_of(num_entries, false), num_parts))
      out.push_back(part.size());
    return out;
  };
  using Sizes = std::vector<std::size_t>;
  EXPECT_EQ(sizes({1000, 1000, 1000, 1000}, 2), (Sizes{2, 2}));
  EXPECT_EQ(sizes({1000, 1000, 1000, 100'000}, 2), (Sizes{3, 1}));
  EXPECT_EQ(sizes({100'000, 1000, 1000}, 3), (Sizes{1, 1, 1}));
  EXPECT_EQ(sizes({1000, 1000, 100'000}, 3), (Sizes{1, 1, 1}));
  EXPECT_EQ(sizes({1000, 1000, 1000}, 1), Sizes{3});
}

TEST_F(SplitLibrary, RefusesMorePartsThanModels) {
  const Library whole = library_of({100, 100}, false);
  for (const std::size_t n : {0, 3}) {
    const auto files = split_library(whole, n, folder() / "parts");
    ASSERT_FALSE(files);
    EXPECT_EQ(files.error().code, ErrorCode::usage);
  }
}

}  // namespace
}  // namespace trivet
