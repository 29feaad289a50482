#include "engine/training/incremental_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/libraries/assemble_library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using Order = std::array<std::size_t, 3>;

/// Three models, which lie in a library.
class IncrementalWriter : public test::LibraryTest {
 protected:
  IncrementalWriter() {
    auto writer = LibraryWriter::create(folder() / "whole.h5", header_);
    EXPECT_TRUE(writer && writer->add(basis_));
    for (const std::string name : {"a", "b", "c"}) {
      EXPECT_TRUE(writer->add(test::random_model(name, 3)));
      names_.add(name);
    }
    EXPECT_TRUE(writer->publish());
    complete_ = *open_library(folder() / "whole.h5");
  }
  std::unique_ptr<engine::IncrementalWriter> make_writer(std::vector<std::size_t> sources) const {
    return std::make_unique<engine::IncrementalWriter>(file(), header_, basis_, names_,
                                                       std::move(sources));
  }
  std::shared_ptr<PackedModel> packed(std::size_t m) const {
    return *pack_model(*complete_.model(static_cast<std::uint32_t>(m)), header_.unit,
                       test::kRandomComponents);
  }
  /// The models found by the next run of the same command.
  std::vector<std::string> kept() const {
    std::vector<std::string> names;
    for (const Library& part : engine::recover_parts(engine::parts_folder(file()))) {
      for (const ModelInfo& model : part.models) names.push_back(model.name);
    }
    return names;
  }

  LibraryHeader header_{LengthUnit::millimeter, "test", "{}"};
  TriSpinBasis basis_ = test::random_basis(1, test::kRandomComponents);
  FileLock lock_ = *FileLock::acquire(file());
  NamesToCome names_;
  Library complete_;
};

TEST_F(IncrementalWriter, GivesTheSameBytesInWhateverOrderModelsCome) {
  ASSERT_TRUE(assemble_library(header_, basis_, copies_of(complete_), lock_));
  const std::string expected = test::read_bytes(file());
  Order order{4, 5, 9};
  do {
    const auto writer = make_writer({4, 5, 9});
    for (const std::size_t source : order) {
      const auto rest = writer->add(source, packed(source == 9 ? 2 : source - 4));
      ASSERT_TRUE(rest);
      EXPECT_TRUE(rest->empty());
    }
    EXPECT_EQ(writer->num_written(), 3U);
    ASSERT_TRUE(finish_library(*writer->release(), copies_of(complete_), 3, lock_));
    EXPECT_TRUE(test::read_bytes(file()) == expected);
  } while (std::ranges::next_permutation(order).found);
}

TEST_F(IncrementalWriter, LeavesTheRestToThoseThatAreReadAgain) {
  ASSERT_TRUE(assemble_library(header_, basis_, copies_of(complete_), lock_));
  const std::string expected = test::read_bytes(file());
  const auto writer = make_writer({0, 1});
  const std::shared_ptr<PackedModel> other = packed(2);
  const auto rest = writer->add(2, other);  // not among the first
  ASSERT_TRUE(rest);
  EXPECT_EQ(*rest, PackedModels{other});
  ASSERT_TRUE(writer->add(0, packed(0)));
  EXPECT_EQ(writer->num_written(), 1U);
  ASSERT_TRUE(finish_library(*writer->release(), copies_of(complete_), 1, lock_));
  EXPECT_TRUE(test::read_bytes(file()) == expected);
}

TEST_F(IncrementalWriter, KeepsWhatItWroteForTheNextRun) {
  {
    const auto writer = make_writer({0, 1, 2});
    ASSERT_TRUE(writer->add(1, packed(1)));
    EXPECT_FALSE(fs::exists(engine::parts_folder(file()))) << "no file before the first model";
    ASSERT_TRUE(writer->add(0, packed(0)));
    ASSERT_TRUE(writer->save_contents());
    ASSERT_TRUE(writer->add(2, packed(2)));
  }
  EXPECT_EQ(kept(), (std::vector<std::string>{"a", "b", "c"}));
  {
    const auto again = make_writer({0});
    ASSERT_TRUE(again->add(0, packed(0)));
  }
  EXPECT_EQ(kept(), (std::vector<std::string>{"a", "b", "c", "a"})) << "beside what another wrote";
}

TEST_F(IncrementalWriter, KeepsWhatItWroteOfALibraryThatIsGoingToBeAnother) {
  const auto writer = make_writer({0, 1, 2});
  ASSERT_TRUE(writer->add(0, packed(0)));
  const std::shared_ptr<PackedModel> waiting = packed(2);
  ASSERT_TRUE(writer->add(2, waiting));
  const auto rest = writer->give_up();
  ASSERT_TRUE(rest);
  EXPECT_EQ(*rest, PackedModels{waiting});
  EXPECT_EQ(kept(), std::vector<std::string>{"a"});
  const std::shared_ptr<PackedModel> late = packed(1);
  EXPECT_EQ(*writer->add(1, late), PackedModels{late});
  EXPECT_FALSE(writer->release());
}

}  // namespace
}  // namespace trivet
