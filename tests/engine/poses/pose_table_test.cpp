#include "engine/poses/pose_table.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace trivet::engine {
namespace {

using Rows = std::vector<Row>;

TEST(PoseTable, KeepsRowsWhereTheyAre) {
  PoseTable table;
  Pose there = Pose::Identity();
  there.translation() = Eigen::Vector3f(1, 2, 3);
  EXPECT_EQ(table.add(7, Source::ppf, there, 12, 0.5F), 0U);
  EXPECT_EQ(table.add(8, Source::trisi, Pose::Identity()), 1U);
  ASSERT_EQ(table.size(), 2U);
  EXPECT_EQ(table.model[0], 7U);
  EXPECT_EQ(table.source[1], Source::trisi);
  EXPECT_EQ(table.votes[0], 12);
  EXPECT_EQ(table.share[0], 0.5F);
  EXPECT_EQ(table.T_proposed[0].matrix(), there.matrix());
  EXPECT_EQ(table.T_scene_model[0].matrix(), there.matrix());
  EXPECT_EQ(table.stage[0], PoseStage::proposed);
  EXPECT_EQ(table.fate[0], PoseFate::open);
}

TEST(PoseTable, AppendsPosesOfItsOwnRows) {
  PoseTable table;
  Pose there = Pose::Identity();
  there.translation() = Eigen::Vector3f(1, 2, 3);
  table.add(7, Source::ppf, there);
  // As often as to move all columns several times.
  for (std::uint32_t k = 0; k < 40; ++k) {
    const Row row =
        table.add(7, Source::ppf, k % 2 == 0 ? table.T_proposed[0] : table.T_scene_model[0]);
    ASSERT_EQ(table.T_proposed[row].matrix(), there.matrix()) << k;
    ASSERT_EQ(table.T_scene_model[row].matrix(), there.matrix()) << k;
  }
}

TEST(PoseTable, RecordsTestsInAnyOrder) {
  PoseTable table;
  for (std::uint32_t m = 0; m < 3; ++m) table.add(m, Source::ppf, Pose::Identity());
  const auto tested = [](float score) {
    TestedPose pose;
    pose.score = score;
    pose.test.examination.tolerance = 10 * score;
    pose.T_scene_model.translation().x() = score;
    return pose;
  };
  table.set_tested(2, tested(0.25F));
  table.set_tested(0, tested(0.5F));
  EXPECT_EQ(table.score[2], 0.25F);
  EXPECT_EQ(table.test(2).examination.tolerance, 2.5F);
  EXPECT_EQ(table.test(0).examination.tolerance, 5);
  EXPECT_EQ(table.T_scene_model[0].translation().x(), 0.5F);
  EXPECT_EQ(table.T_proposed[0].translation().x(), 0) << "as it was";
  EXPECT_EQ(table.stage[1], PoseStage::proposed);
  SettledPose settled{tested(0.75F), {}};
  settled.ambiguity.candidates = {{.model = 1, .share = 0.75F}};
  table.set_settled(2, settled);
  EXPECT_EQ(table.tests.size(), 2U) << "a row is tested once";
  EXPECT_EQ(table.score[2], 0.75F);
  EXPECT_EQ(table.test(2).examination.tolerance, 7.5F);
  EXPECT_EQ(table.ambiguity(2).candidates.at(0).model, 1U);
  EXPECT_EQ(table.ambiguity(2).identity(), 0.75F);
  EXPECT_TRUE(table.ambiguity(0).candidates.empty());
  EXPECT_EQ(table.ambiguity(0).identity(), 1) << "nothing was compared";
}

TEST(ByFalling, SortsRowsByAColumnTiesInTheirOrder) {
  const std::vector<float> column{3, 1, 2, 3, 9};
  const Rows rows{2, 3, 0, 1};
  EXPECT_EQ(by_falling(column, rows), (Rows{3, 0, 2, 1}));
  EXPECT_TRUE(by_falling(column, Rows{}).empty());
}

TEST(ExtractBest, LeavesTheRestAndKeepsTheOrderOfBoth) {
  const std::vector<float> column{3, 1, 2, 3, 9};
  Rows rows{1, 2, 3, 0};
  EXPECT_EQ(extract_best(column, 2, rows), (Rows{3, 0}));
  EXPECT_EQ(rows, (Rows{1, 2}));
  EXPECT_EQ(extract_best(column, 2, rows), (Rows{1, 2}));
  EXPECT_TRUE(rows.empty());
  Rows ties{3, 0};
  EXPECT_EQ(extract_best(column, 1, ties), Rows{3}) << "the first of equals";
  EXPECT_TRUE(extract_best(column, 0, ties).empty());
  EXPECT_EQ(ties, Rows{0});
}

}  // namespace
}  // namespace trivet::engine
