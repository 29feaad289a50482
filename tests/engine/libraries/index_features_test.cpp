#include "engine/libraries/index_features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "engine/common/thread_limit.hpp"
#include "kernels/spin_images/rotation_code.hpp"
#include "support/library_file.hpp"
#include "support/random_model.hpp"

namespace trivet::engine {
namespace {

/// Three models, two with the same resolution, in a file with its index.
class IndexFeatures : public test::LibraryTest {
 protected:
  IndexFeatures() {
    for (std::uint64_t seed = 1; seed <= 3; ++seed)
      models_.push_back(test::random_model(std::string(1, static_cast<char>('a' + seed)), seed,
                                           {.num_features = 1500 * seed}));
    models_[1].features[0].resolution = models_[0].features[0].resolution;
    write(file(), models_);
  }
  static void write(const std::filesystem::path& to, const std::vector<Model>& models,
                    std::size_t piece_bytes = LibraryWriter::kPieceBytes) {
    auto writer = LibraryWriter::create(to, {LengthUnit::meter, "trivet test", "{}"});
    if (!writer || !writer->add(test::random_basis(5, test::kRandomComponents)))
      throw std::runtime_error("cannot write the library");
    for (const Model& model : models) {
      if (!writer->add(model)) throw std::runtime_error("cannot add a model");
    }
    if (!add_index(*writer, piece_bytes) || !writer->publish())
      throw std::runtime_error("cannot publish");
  }
  std::vector<Model> models_;
};

TEST_F(IndexFeatures, HoldsEveryFeatureOnceBesideItsKeypointAndFrame) {
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message;
  std::set<std::tuple<float, std::uint32_t, std::size_t>> visited;  // resolution, model, row
  std::size_t expected = 0;
  for (const Model& model : models_)
    for (const TriSpinFeatures& features : model.features) expected += features.size();
  for (std::size_t k = 0; k < library->index.size(); ++k) {
    const auto read = library->index.level(k);
    ASSERT_TRUE(read) << read.error().message;
    const FeatureLevel& level = **read;
    if (k > 0) {
      EXPECT_LT(library->index.shape(k - 1).resolution, level.resolution);
    }
    for (std::size_t i = 0; i < level.size(); ++i) {
      const Model& model = models_[level.model[i]];
      const TriSpinFeatures& own =
          *std::ranges::find(model.features, level.resolution, &TriSpinFeatures::resolution);
      std::size_t row = 0;
      while (row < own.size() && own.keypoints[row] != level.keypoints[i]) ++row;
      ASSERT_LT(row, own.size());
      const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
          own.frames[row].data());
      EXPECT_LT((kernels::decode_rotation(level.frames[i]) - frame).cwiseAbs().maxCoeff(), 1e-3F);
      EXPECT_TRUE(
          std::ranges::equal(own.codes.subspan(row * own.num_components, own.num_components),
                             level.codes.subspan(i * level.stride, own.num_components)));
      EXPECT_TRUE(visited.emplace(level.resolution, level.model[i], row).second);
    }
  }
  EXPECT_EQ(visited.size(), expected);
}

TEST_F(IndexFeatures, HoldsEachListByModelsAndRows) {
  const auto library = open_library(file());
  ASSERT_TRUE(library);
  std::size_t most_lists = 0;
  for (std::size_t n = 0; n < library->index.size(); ++n) {
    const FeatureLevel& level = **library->index.level(n);
    const std::size_t stride = level.stride, num_lists = level.offsets.size() - 1;
    most_lists = std::max(most_lists, num_lists);
    const auto nearest = [&](std::size_t i) {
      std::size_t best = 0;
      int least = std::numeric_limits<int>::max();
      for (std::size_t l = 0; l < num_lists; ++l) {
        int squared = 0;
        for (std::size_t j = 0; j < stride; ++j) {
          const int d = level.codes[i * stride + j] - level.centroids[l * stride + j];
          squared += d * d;
        }
        if (squared < least) best = l;
        least = std::min(least, squared);
      }
      return best;
    };
    // The lists built naively: features by model and row, each appended to its list.
    std::vector<std::vector<std::pair<std::uint32_t, Eigen::Vector3f>>> expected(num_lists);
    std::map<std::pair<std::uint32_t, float>, std::size_t> list_of;  // by model and keypoint
    for (std::size_t i = 0; i < level.size(); ++i)
      list_of[{level.model[i], level.keypoints.x[i]}] = nearest(i);
    for (std::uint32_t m = 0; m < models_.size(); ++m) {
      for (const TriSpinFeatures& own : models_[m].features) {
        for (std::size_t row = 0; own.resolution == level.resolution && row < own.size(); ++row)
          expected[list_of.at({m, own.keypoints.x[row]})].emplace_back(m, own.keypoints[row]);
      }
    }
    for (std::size_t l = 0; l < num_lists; ++l) {
      ASSERT_EQ(level.offsets[l + 1] - level.offsets[l], expected[l].size());
      for (std::size_t k = 0; k < expected[l].size(); ++k) {
        const std::size_t i = level.offsets[l] + k;
        ASSERT_EQ(level.model[i], expected[l][k].first);
        ASSERT_EQ(level.keypoints[i], expected[l][k].second);
      }
    }
  }
  EXPECT_GT(most_lists, 1U);
}

TEST_F(IndexFeatures, MakesTheSameFileFromPiecesOfAnySize) {
  const std::string whole = test::read_bytes(file());
  for (const std::size_t piece_bytes : {std::size_t{3000}, std::size_t{44'000}}) {
    write(folder() / "pieces.h5", models_, piece_bytes);
    EXPECT_TRUE(test::read_bytes(folder() / "pieces.h5") == whole) << piece_bytes;
  }
  const auto verified = verify_library(folder() / "pieces.h5");
  EXPECT_TRUE(verified) << verified.error().message;
  std::vector<Model> few(models_);
  few.resize(1);
  write(file(), few);
  write(folder() / "pieces.h5", few, 1);  // one feature at a time
  EXPECT_TRUE(test::read_bytes(folder() / "pieces.h5") == test::read_bytes(file()));
}

TEST_F(IndexFeatures, MakesTheSameFileWithAnyNumberOfThreads) {
  for (const unsigned threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    write(folder() / "threads.h5", models_, 20'000);
    EXPECT_TRUE(test::read_bytes(folder() / "threads.h5") == test::read_bytes(file())) << threads;
  }
}

TEST_F(IndexFeatures, IsTheSameInWhateverOrderModelsWereAdded) {
  const std::vector<Model> turned(models_.rbegin(), models_.rend());
  write(folder() / "turned.h5", turned);
  const auto a = open_library(file()), b = open_library(folder() / "turned.h5");
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->index.size(), b->index.size());
  for (std::size_t k = 0; k < a->index.size(); ++k) {
    const FeatureLevel &one = **a->index.level(k), &other = **b->index.level(k);
    EXPECT_TRUE(std::ranges::equal(one.centroids, other.centroids));
    EXPECT_TRUE(std::ranges::equal(one.codes, other.codes));
    EXPECT_TRUE(std::ranges::equal(one.model, other.model));
    EXPECT_TRUE(std::ranges::equal(one.keypoints.z, other.keypoints.z));
    EXPECT_TRUE(std::ranges::equal(one.frames, other.frames));
  }
}

TEST_F(IndexFeatures, IsTheSameFromTheFileAndFromItsModels) {
  const auto library = open_library(file());
  ASSERT_TRUE(library);
  const auto built = index_features(*library);
  ASSERT_TRUE(built);
  ASSERT_EQ(built->size(), library->index.size());
  for (std::size_t k = 0; k < built->size(); ++k) {
    const FeatureLevel &a = (*built)[k], &b = **library->index.level(k);
    EXPECT_EQ(a.resolution, b.resolution);
    EXPECT_TRUE(std::ranges::equal(a.models, b.models));
    EXPECT_TRUE(std::ranges::equal(a.codes, b.codes));
    EXPECT_TRUE(std::ranges::equal(a.model, b.model));
    EXPECT_TRUE(std::ranges::equal(a.keypoints.x, b.keypoints.x));
    EXPECT_TRUE(std::ranges::equal(a.frames, b.frames));
  }
}

TEST_F(IndexFeatures, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto library = open_library(file());
  const auto codes = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    const auto index = index_features(*library);
    return std::vector<std::uint8_t>(index->front().codes.begin(), index->front().codes.end());
  };
  EXPECT_EQ(codes(1), codes(2));
}

TEST_F(IndexFeatures, IsRefusedByNameWhereItIsDamaged) {
  auto bytes = test::read_bytes(file());
  {
    const auto library = open_library(file());
    ASSERT_TRUE(library);
    const std::span<const std::uint8_t> column = (*library->index.level(0))->codes;
    const std::string_view codes(reinterpret_cast<const char*>(column.data()), column.size());
    const std::size_t at = bytes.find(codes);
    ASSERT_NE(at, std::string::npos);
    bytes[at + 100] = static_cast<char>(bytes[at + 100] ^ 4);
  }
  write_file(bytes);
  const auto library = open_library(file());
  ASSERT_TRUE(library) << library.error().message << ": nothing of it was read yet";
  const auto checked = library->index.level(0);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::damaged);
  EXPECT_NE(checked.error().message.find("/index/00/codes"), std::string::npos)
      << checked.error().message;
  EXPECT_FALSE(library->index.level(0)) << "it stays damaged";
  EXPECT_FALSE(verify_library(file()));
}

}  // namespace
}  // namespace trivet::engine
