#include "engine/training/ahead_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "engine/libraries/assemble_library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using Order = std::array<std::size_t, 3>;

/// Three models, which lie in a library.
class AheadWriter : public test::LibraryTest {
 protected:
  AheadWriter() {
    auto writer = LibraryWriter::create(folder() / "whole.h5", header_);
    EXPECT_TRUE(writer && writer->add(basis_));
    for (const std::string name : {"a", "b", "c"}) {
      EXPECT_TRUE(writer->add(test::random_model(name, 3)));
      names_.add(name);
    }
    EXPECT_TRUE(writer->publish());
    whole_ = *open_library(folder() / "whole.h5");
  }
  engine::AheadWriter ahead(std::vector<std::size_t> sources) const {
    return {header_, basis_, lock_, names_, std::move(sources)};
  }
  std::shared_ptr<PackedModel> packed(std::size_t m) const {
    auto part = LibraryWriter::create(folder() / "part.h5", header_);
    EXPECT_TRUE(part && part->add(basis_));
    return *part->pack(whole_.models[m]);
  }
  /// What lies beside the library of models and the lock.
  std::size_t num_temporary() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        fs::directory_iterator(folder()),
        [](const auto& entry) { return entry.path().extension() == ".tmp"; }));
  }

  LibraryHeader header_{LengthUnit::millimeter, "test", "{}"};
  TriSpinBasis basis_ = test::random_basis(1, test::kRandomComponents);
  FileLock lock_ = *FileLock::acquire(file());
  NamesToCome names_;
  Library whole_;
};

TEST_F(AheadWriter, GivesTheSameBytesInWhateverOrderModelsCome) {
  ASSERT_TRUE(assemble_library(header_, basis_, copies_of(whole_), lock_));
  const std::string expected = test::read_bytes(file());
  Order order{4, 5, 9};
  do {
    engine::AheadWriter writer = ahead({4, 5, 9});
    for (const std::size_t source : order)
      ASSERT_TRUE(writer.add(source, packed(source == 9 ? 2 : source - 4)));
    EXPECT_EQ(writer.num_written(), 3U);
    ASSERT_TRUE(finish_library(*writer.release(), copies_of(whole_), 3, lock_));
    EXPECT_TRUE(test::read_bytes(file()) == expected);
  } while (std::ranges::next_permutation(order).found);
}

TEST_F(AheadWriter, LeavesTheRestToThoseThatAreReadAgain) {
  ASSERT_TRUE(assemble_library(header_, basis_, copies_of(whole_), lock_));
  const std::string expected = test::read_bytes(file());
  engine::AheadWriter writer = ahead({0, 1});
  ASSERT_TRUE(writer.add(2, packed(2)));  // not among the first
  ASSERT_TRUE(writer.add(0, packed(0)));
  EXPECT_EQ(writer.num_written(), 1U);
  ASSERT_TRUE(finish_library(*writer.release(), copies_of(whole_), 1, lock_));
  EXPECT_TRUE(test::read_bytes(file()) == expected);
}

TEST_F(AheadWriter, BeginsNoFileBeforeTheFirstModelAndKeepsNoneThatIsGivenUp) {
  engine::AheadWriter writer = ahead({0, 1});
  ASSERT_TRUE(writer.add(1, packed(1)));
  EXPECT_EQ(num_temporary(), 0U);
  EXPECT_FALSE(ahead({0}).release());
  ASSERT_TRUE(writer.add(0, packed(0)));
  EXPECT_EQ(num_temporary(), 1U);
  writer.give_up();
  EXPECT_EQ(num_temporary(), 0U);
  ASSERT_TRUE(writer.add(0, packed(0)));
  EXPECT_FALSE(writer.release());
}

}  // namespace
}  // namespace trivet
