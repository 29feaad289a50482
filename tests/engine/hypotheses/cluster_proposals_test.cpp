#include "engine/hypotheses/cluster_proposals.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace trivet::engine {
namespace {

using Rows = std::vector<Row>;

kernels::Hypothesis at(float x, float votes) {
  kernels::Hypothesis hypothesis{Pose::Identity(), votes};
  hypothesis.T_scene_model.translation().x() = x;
  return hypothesis;
}

/// Two models of diameter 1.
class ClusterProposals : public testing::Test {
 protected:
  ClusterProposals() {
    Model model;
    model.diameter = 1;
    library_ = Library({model, model});
  }
  Library library_;
  PoseTable table_;
  ClusterProposalsOptions options_;
};

TEST_F(ClusterProposals, AppendsARowForEachClusterOfASource) {
  const std::vector<Proposals> proposals{{1, Source::ppf, {at(0, 2), at(5, 3), at(0.001F, 4)}},
                                         {0, Source::ppf, {at(1, 1)}},
                                         {1, Source::trisi, {at(0, 1)}}};
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{0, 1, 2, 3}));
  EXPECT_EQ(table_.model, (std::vector<std::uint32_t>{0, 1, 1, 1}));
  EXPECT_EQ(table_.votes, (std::vector<float>{1, 6, 3, 1})) << "the strongest first";
  EXPECT_FLOAT_EQ(table_.share[1], 6.0F / 9);
  EXPECT_EQ(table_.source[3], Source::trisi);
  EXPECT_EQ(table_.share[3], 1) << "of its own source";
  EXPECT_EQ(table_.stage[0], PoseStage::proposed);
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{4, 5, 6, 7}));
}

TEST_F(ClusterProposals, LeavesOutWhatTheLimitsDoNotAllow) {
  options_.limits.region = PoseLimits::Region{{-1, -1, -1}, {1, 1, 1}};
  options_.scale = 10;  // from the region's unit to the library's
  const std::vector<Proposals> proposals{{0, Source::ppf, {at(0, 2), at(9, 3), at(11, 4)}}};
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{0, 1}));
  EXPECT_EQ(table_.votes, (std::vector<float>{3, 2}));
}

TEST_F(ClusterProposals, KeepsTheStrongestOfAllModels) {
  options_.max_rows = 2;
  const std::vector<Proposals> proposals{{0, Source::ppf, {at(0, 2), at(5, 3)}},
                                         {1, Source::ppf, {at(0, 9), at(5, 1)}}};
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{0, 1}));
  EXPECT_EQ(table_.votes, (std::vector<float>{3, 9}));
}

TEST_F(ClusterProposals, RecordsWhatItGivesUpWhereThatIsAskedFor) {
  options_.pose.max_clusters = 2;
  options_.pose.min_cluster_share = 0.5F;
  const std::vector<Proposals> proposals{
      {0, Source::ppf, {at(0, 9), at(2, 3), at(4, 8), at(6, 7)}}};
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{0, 1}));
  EXPECT_EQ(table_.size(), 2U);
  options_.keep_given_up = true;
  EXPECT_EQ(cluster_proposals(library_, proposals, options_, table_), (Rows{2, 3}));
  ASSERT_EQ(table_.size(), 6U);
  EXPECT_EQ(table_.votes[4], 7) << "beyond the number of clusters";
  EXPECT_EQ(table_.votes[5], 3) << "and below the share of the strongest";
  EXPECT_EQ(table_.fate[3], PoseFate::open);
  EXPECT_EQ(table_.fate[4], PoseFate::given_up);
}

}  // namespace
}  // namespace trivet::engine
