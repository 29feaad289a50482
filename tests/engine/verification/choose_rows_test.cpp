#include "engine/verification/choose_rows.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace trivet::engine {
namespace {

using Rows = std::vector<Row>;

/// Poses of models with diameter 1, each at x on a line.
class ChooseRows : public testing::Test {
 protected:
  ChooseRows() {
    Model model;
    model.diameter = 1;
    library_ = Library({model, model});
  }
  Row add(float x, float score, float share, std::uint32_t model = 0, Source source = Source::ppf) {
    Pose pose = Pose::Identity();
    pose.translation().x() = x;
    const Row row = table_.add(model, source, pose, 100 * share, share);
    table_.score[row] = score;
    return row;
  }
  Rows all() const {
    Rows rows(table_.size());
    for (Row row = 0; row < rows.size(); ++row) rows[row] = row;
    return rows;
  }
  const ModelInfo& model() const { return library_.models[0]; }

  Library library_;
  PoseTable table_;
};

TEST_F(ChooseRows, RefinesHalfByVisibleSamplesAndHalfByVotes) {
  add(0, 0.9F, 0.1F);
  add(1, 0.8F, 0.2F);
  add(2, 0.3F, 0.9F);
  add(3, 0.2F, 0.8F);
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 2), (Rows{0, 2}));
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 3), (Rows{0, 1, 2})) << "the odd one by score";
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 9), (Rows{0, 1, 2, 3}));
}

TEST_F(ChooseRows, RefinesNothingWithoutEvidence) {
  add(0, 0, 0.9F);
  EXPECT_TRUE(choose_to_refine(table_, all(), model(), 9).empty());
  EXPECT_TRUE(choose_to_judge(table_, all(), model(), 9).empty());
}

TEST_F(ChooseRows, GivesEachPlaceItsPartBeforeAnyHasMore) {
  Rows there;
  for (int k = 0; k < 40; ++k) there.push_back(add(0.001F * static_cast<float>(k), 0.9F, 0.5F));
  const Row aside = add(1, 0.1F, 0.01F);
  const auto best = [&](std::ptrdiff_t count) {
    Rows rows(there.begin(), there.begin() + count);
    rows.push_back(aside);
    return rows;
  };
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 9), best(8)) << "the ninth is another place's";
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 21).size(), 21U) << "what is left goes deeper";
  EXPECT_EQ(choose_to_refine(table_, all(), model(), 41).size(), 33U) << "but not without end";
  Rows judged = choose_to_judge(table_, all(), model(), 9);
  EXPECT_EQ(judged.size(), 27U) << "contours are judged of three times as many";
  judged.resize(25);
  EXPECT_EQ(judged, best(24));
}

TEST_F(ChooseRows, JudgesMoreContoursThanItRefines) {
  for (int k = 0; k < 10; ++k)
    add(static_cast<float>(k), 0.1F * static_cast<float>(10 - k), 0.1F * static_cast<float>(k));
  EXPECT_EQ(choose_to_judge(table_, all(), model(), 2), (Rows{9, 0, 1, 2, 3, 4}))
      << "one by votes, the others by score";
}

TEST_F(ChooseRows, ExaminesTheBestOfWhatRefinementLedToOnePlace) {
  add(0, 0.5F, 0, 0, Source::trisi);
  add(0.005F, 0.4F, 0, 0, Source::ppf);
  add(1, 0.7F, 0);
  add(2, 0.04F, 0);
  EXPECT_EQ(choose_to_examine(table_, all(), model(), 9, 0.05F), (Rows{2, 0}));
  EXPECT_EQ(table_.source[0], Source::ppf) << "the first of those that led there";
  EXPECT_EQ(choose_to_examine(table_, all(), model(), 1, 0.05F), Rows{2});
  EXPECT_EQ(choose_to_examine(table_, all(), model(), 9, 0).size(), 3U);
}

TEST_F(ChooseRows, TreatsCopiesUnderASymmetryAsOnePlace) {
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisf(3.14159274F, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  add(0, 0.5F, 0);
  table_.T_scene_model[add(0, 0.4F, 0)] = turned;
  EXPECT_EQ(choose_to_examine(table_, all(), model(), 9, 0), (Rows{0, 1}));
  ModelInfo symmetric = model();
  symmetric.symmetry.poses = {turned};
  EXPECT_EQ(choose_to_examine(table_, all(), symmetric, 9, 0), Rows{0});
}

TEST_F(ChooseRows, ChoosesOfEachModelForItself) {
  for (int k = 0; k < 4; ++k) add(static_cast<float>(k), 0.5F, 0, k % 2 == 0 ? 1 : 0);
  const Rows chosen = choose_of_each_model(
      table_, all(), library_, [&](const ModelInfo& model, std::span<const Row> rows) {
        EXPECT_EQ(&model, &library_.models[table_.model[rows[0]]]);
        return Rows{rows.back()};
      });
  EXPECT_EQ(chosen, (Rows{3, 2})) << "by model";
}

}  // namespace
}  // namespace trivet::engine
