// The index is added to a library piece by piece.
#include <gtest/gtest.h>

#include <numeric>
#include <string>

#include "storage/library/library.hpp"
#include "support/craft_library.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet {
namespace {

constexpr std::size_t kStride = 16, kRow = kStride + 4 + 12 + 8;  // bytes of a feature

/// A library of two models without its index.
class LibraryIndex : public test::LibraryTest {
 protected:
  LibraryIndex()
      : writer_(*LibraryWriter::create(file(), {LengthUnit::meter, "trivet test", "{}"})) {
    EXPECT_TRUE(writer_.add(test::random_basis(5, test::kRandomComponents)));
    EXPECT_TRUE(writer_.add(test::random_model("b", 1)));
    EXPECT_TRUE(writer_.add(test::random_model("a", 2)));
  }
  /// A level of n features numbered in order. A third model makes it invalid.
  LevelInPieces level(std::uint32_t n, std::uint32_t num_models) {
    FeatureLevel head;
    head.resolution = 0.5F;
    head.stride = kStride;
    head.models = Column<std::uint32_t>{0, 1};
    head.centroids = Column<std::uint8_t>(2 * kStride, 7);
    head.offsets = std::vector<std::uint32_t>{0, n / 3, n};
    return {head, [this, num_models](std::size_t first, const ListedFeaturesSpan& features) {
              pieces_.push_back(features.size());
              for (std::size_t i = 0; i < features.size(); ++i) {
                const std::size_t which = first + i;
                const auto x = static_cast<float>(which);
                features.model[i] = static_cast<std::uint32_t>(which % num_models);
                features.keypoints.set(i, {x, -x, 2 * x});
                features.frames[i] = {static_cast<std::uint16_t>(which), 1, 2, 3};
                for (std::size_t j = 0; j < kStride; ++j)
                  features.codes[i * kStride + j] = static_cast<std::uint8_t>(which + j);
              }
            }};
  }
  Result<void> add(std::uint32_t n, std::uint32_t num_models, std::size_t piece_bytes) {
    return writer_.add_index(
        [&](const WrittenFeatures& features, std::size_t k) {
          EXPECT_EQ(features.of_models.size(), 2 * kFeatureScales.size());
          EXPECT_EQ(features.of_models.front().model, 0U);
          return k == 0 ? std::optional(level(n, num_models)) : std::nullopt;
        },
        piece_bytes);
  }
  LibraryWriter writer_;
  std::vector<std::size_t> pieces_;
};

TEST_F(LibraryIndex, HoldsWhatWasGivenInPieces) {
  ASSERT_TRUE(add(103, 2, 2 * 10 * kRow + kRow / 2));
  ASSERT_TRUE(writer_.publish());
  std::vector<std::size_t> expected(10, 10);
  expected.push_back(3);
  EXPECT_EQ(pieces_, expected) << "two are in memory, no more than fits";

  const auto library = verify_library(file());
  ASSERT_TRUE(library) << library.error().message;
  ASSERT_EQ(library->index.size(), 1U);
  const FeatureLevel& found = **library->index.level(0);
  ASSERT_EQ(found.size(), 103U);
  EXPECT_EQ(found.resolution, 0.5F);
  EXPECT_EQ(found.centroids[kStride], 7);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto x = static_cast<float>(i);
    EXPECT_EQ(found.model[i], i % 2);
    EXPECT_EQ(found.keypoints[i], Eigen::Vector3f(x, -x, 2 * x));
    EXPECT_EQ(found.frames[i], (RotationCode{static_cast<std::uint16_t>(i), 1, 2, 3}));
    EXPECT_EQ(found.codes[i * kStride + 15], static_cast<std::uint8_t>(i + 15));
  }
}

TEST_F(LibraryIndex, WritesAtLeastAFeatureAtATime) {
  ASSERT_TRUE(add(5, 2, 0));
  ASSERT_TRUE(writer_.publish());
  EXPECT_EQ(pieces_, std::vector<std::size_t>(5, 1));
  EXPECT_TRUE(verify_library(file()));
}

TEST_F(LibraryIndex, RefusesALevelThatBreaksTheFormat) {
  const auto added = add(103, 3, 10 * kRow);
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code, ErrorCode::internal);
  EXPECT_EQ(added.error().message, "model: expected numbers below 2");
}

// The model numbers are inspected before a level is checked: they decide whether the level is
// needed.
TEST_F(LibraryIndex, IsRefusedAtOnceWhereItNamesOtherModels) {
  ASSERT_TRUE(add(103, 2, 10 * kRow));
  ASSERT_TRUE(writer_.publish());
  std::string bytes = test::read_bytes(file());
  haddr_t at = 0;
  test::edit_library(file(), [&](hid_t root) {
    const hdf5::Handle models(H5Dopen2(root, "index/00/models", H5P_DEFAULT));
    at = H5Dget_offset(models.get());
  });
  bytes.at(at) = 5;
  write_file(bytes);
  const auto library = open_library(file());
  ASSERT_FALSE(library);
  EXPECT_EQ(library.error().code, ErrorCode::bad_data);
  EXPECT_NE(library.error().message.find("/index/00/models"), std::string::npos)
      << library.error().message;
}

}  // namespace
}  // namespace trivet
