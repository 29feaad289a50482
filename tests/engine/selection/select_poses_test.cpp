#include "engine/selection/select_poses.hpp"

#include <gtest/gtest.h>

namespace trivet {
namespace {

using engine::PoseTable;
using engine::Refusal;
using engine::Row;
using Rows = std::vector<Row>;
using Names = std::vector<std::string>;

/// A tested pose of a table.
struct Tested {
  std::uint32_t model = 0;
  float score = 0;
  std::uint32_t first = 0, num_pixels = 0;  ///< it explains the pixels from `first` on
  float x = 0;                              // /< shift of its model in diameters
  std::vector<Pose> alternatives{};
};

PoseTable table_of(const std::vector<Tested>& poses) {
  PoseTable table;
  for (const Tested& pose : poses) {
    engine::SettledPose settled;
    settled.pose.score = pose.score;
    settled.pose.T_scene_model.translation().x() = pose.x;
    settled.pose.test.examination.area = static_cast<float>(pose.num_pixels) * 1e-6F;
    for (std::uint32_t i = 0; i < pose.num_pixels; ++i)
      settled.pose.test.explained.pixels.push_back(pose.first + i);
    settled.ambiguity.alternatives = pose.alternatives;
    table.set_settled(table.add(pose.model, Source::ppf, Pose::Identity()), std::move(settled));
  }
  return table;
}

Rows all_rows(const PoseTable& table) {
  Rows rows(table.size());
  for (Row row = 0; row < rows.size(); ++row) rows[row] = row;
  return rows;
}

/// Two models, and an image of 10 x 10 measured pixels.
class SelectPoses : public testing::Test {
 protected:
  SelectPoses() {
    Model large;
    large.name = "large";
    large.diameter = 1;
    Model small = large;
    small.name = "small";
    library_ = Library({large, small});
    kernels::RangeImage image;
    image.geometry.fx = image.geometry.fy = 1;
    image.geometry.width = image.geometry.height = 10;
    image.depth.assign(100, 1);
    scene_.images.push_back(std::move(image));
  }
  engine::Selection select(const PoseTable& table, const engine::SelectOptions& options) const {
    const Rows rows = all_rows(table);
    return engine::select_poses({library_, scene_, table, rows}, options);
  }
  Names names(const std::vector<Tested>& poses, const engine::SelectOptions& options) const {
    Names out;
    const PoseTable table = table_of(poses);
    for (const Row row : select(table, options).chosen)
      out.push_back(library_.models[table.model[row]].name);
    return out;
  }
  Library library_;
  engine::PreparedScene scene_;
};

TEST_F(SelectPoses, PrefersTheLargerSurfaceWhereTwoClaimOnePlace) {
  const std::vector<Tested> both{{0, 0.55F, 0, 80}, {1, 0.6F, 0, 8}};
  EXPECT_EQ(names(both, {}), Names{"large"});
}

TEST_F(SelectPoses, LetsNoPoseThatIsRefusedHideOneThatIsReported) {
  const std::vector<Tested> both{{0, 0.75F, 0, 80}, {1, 0.85F, 0, 8}};
  // The small model covers little of the large one, which is refused later because of its score.
  EXPECT_EQ(names(both, {}), (Names{"small", "large"}));
  EXPECT_EQ(names(both, {.min_score = 0.7F}), (Names{"small", "large"})) << "whatever is asked for";
  const std::vector<Tested> stricter{{0, 0.85F, 0, 80}, {1, 0.95F, 0, 8}};
  EXPECT_EQ(names(stricter, {}), Names{"large"});
  EXPECT_EQ(names(stricter, {.min_score = 0.9F}), (Names{"small", "large"}));
}

// The same two, but the larger one is doubtful: with a higher rank it would hide the other.
TEST_F(SelectPoses, LetsNoDoubtfulPoseHideAnother) {
  const std::vector<Tested> both{{0, 0.45F, 0, 80}, {1, 0.5F, 0, 8}};
  EXPECT_EQ(names(both, {}), Names{"small"});
  EXPECT_EQ(names(both, {.doubtful_score = 0.1F}), (Names{"small", "large"}));
  EXPECT_EQ(names(both, {.doubtful_score = 0.46F}), Names{"small"});
}

// Duplicates are then found from the poses alone, within each model, by the plain score.
TEST_F(SelectPoses, DetectsCopiesByTheirPosesWhereExplainedPixelsAreLeftOut) {
  std::vector<Tested> three{{0, 0.55F, 0, 80}, {1, 0.6F, 0, 8}, {0, 0.52F, 90, 5}};
  const engine::SelectOptions options{.by_pixels = false};
  EXPECT_EQ(names(three, options), (Names{"small", "large"}));
  three[2].x = 0.3F;  // of a diameter of 1
  EXPECT_EQ(names(three, options), (Names{"small", "large", "large"}));
}

TEST_F(SelectPoses, LeavesOutWhatABetterDoubtfulOneExplains) {
  const std::vector<Tested> three{{0, 0.3F, 0, 10}, {0, 0.2F, 0, 10}, {0, 0.2F, 50, 10}};
  EXPECT_EQ(names(three, {.doubtful_score = 0.1F}), (Names{"large", "large"}));
}

// Two poses claim the pixels of a third: the one with more of them is named.
TEST_F(SelectPoses, ReportsWhyAPoseWasRejected) {
  const std::vector<Tested> all{
      {0, 0.9F, 0, 40}, {1, 0.8F, 40, 40}, {1, 0.7F, 34, 10}, {0, 0.3F, 80, 10}, {1, 0.2F, 0, 10}};
  const engine::Selection selection = select(table_of(all), {});
  EXPECT_EQ(selection.chosen, (Rows{0, 1}));
  ASSERT_EQ(selection.refused.size(), 3U);
  const Refusal& between = selection.refused[0];
  EXPECT_EQ(between.row, 2U);
  EXPECT_EQ(between.reason, Rejection::explained);
  EXPECT_EQ(between.explained_by, 0U);
  EXPECT_FLOAT_EQ(between.explained_share, 0.6F);
  const Refusal& alone = selection.refused[1];
  EXPECT_EQ(alone.row, 3U);
  EXPECT_EQ(alone.reason, Rejection::too_low);
  EXPECT_EQ(alone.explained_by, std::nullopt);
  const Refusal& beneath = selection.refused[2];
  EXPECT_EQ(beneath.reason, Rejection::too_low) << "that alone would have refused it";
  EXPECT_EQ(beneath.explained_by, 0U);
  EXPECT_FLOAT_EQ(beneath.explained_share, 1);
}

TEST_F(SelectPoses, CountsAPixelForTheFirstThatExplainsIt) {
  // The second pose covers 10 of the first pose's 40 pixels, and then 30 more.
  const std::vector<Tested> all{{0, 0.9F, 0, 40}, {0, 0.8F, 30, 40}, {0, 0.7F, 20, 20}};
  const engine::Selection selection = select(table_of(all), {});
  ASSERT_EQ(selection.refused.size(), 1U);
  EXPECT_EQ(selection.refused[0].explained_by, 0U);
  EXPECT_FLOAT_EQ(selection.refused[0].explained_share, 1);
}

// The first pose was chosen and then refused. Of the poses that it hid, the second hides the third,
// a remaining pose hides the fourth, and the fifth scores too low.
TEST_F(SelectPoses, SelectsWhatOnlyARejectedPoseHid) {
  const std::vector<Tested> all{{0, 0.97F, 0, 60},  {1, 0.92F, 0, 30}, {1, 0.9F, 0, 20},
                                {1, 0.93F, 50, 20}, {1, 0.7F, 30, 10}, {0, 0.96F, 60, 40}};
  const engine::SelectOptions options;
  const PoseTable table = table_of(all);
  const Rows rows = all_rows(table);
  engine::Selection selection = select(table, options);
  ASSERT_EQ(selection.chosen, (Rows{0, 5}));
  const auto choose = [&](const Rows& standing) {
    return engine::choose_unexplained({library_, scene_, table, rows}, standing, options,
                                      selection.refused);
  };
  EXPECT_TRUE(choose({0, 5}).empty());
  EXPECT_EQ(selection.refused.size(), 4U);
  EXPECT_EQ(choose({5}), Rows{1});
  const auto refusal_of = [&](Row row) {
    return std::ranges::find(selection.refused, row, &Refusal::row);
  };
  ASSERT_EQ(selection.refused.size(), 3U);
  EXPECT_EQ(refusal_of(2)->explained_by, 1U);
  EXPECT_EQ(refusal_of(3)->explained_by, 5U);
  EXPECT_EQ(refusal_of(4)->explained_by, 0U) << "would be refused anyway";
  EXPECT_TRUE(choose({1, 5}).empty()) << "all are compared with what stands";
}

TEST_F(SelectPoses, ReportsPosesBeyondTheLimit) {
  const std::vector<Tested> three{{0, 0.9F, 0, 10}, {0, 0.8F, 20, 10}, {1, 0.7F, 20, 10}};
  const PoseTable table = table_of(three);
  const Rows rows = all_rows(table);
  const engine::Selection selection = select(table, {.max_instances = 1});
  EXPECT_EQ(selection.chosen, Rows{0});
  ASSERT_EQ(selection.refused.size(), 2U);
  EXPECT_EQ(selection.refused[0].reason, Rejection::too_many);
  EXPECT_EQ(selection.refused[1].reason, Rejection::explained);
  EXPECT_EQ(selection.refused[1].explained_by, 1U) << "what is not asked for explains, too";
  std::vector<Refusal> refused = selection.refused;
  EXPECT_TRUE(
      engine::choose_unexplained({library_, scene_, table, rows}, selection.chosen, {}, refused)
          .empty());
  EXPECT_EQ(refused.size(), 2U);
}

/// Poses of one table: first the refused ones, then the detections.
class BestRefused : public SelectPoses {
 protected:
  Rows best(std::vector<Tested> refused_poses, const std::vector<Tested>& detected,
            std::uint32_t limit) const {
    std::vector<Refusal> refused;
    for (Row row = 0; row < refused_poses.size(); ++row) refused.push_back({row});
    std::vector<Tested> all = std::move(refused_poses);
    all.insert(all.end(), detected.begin(), detected.end());
    const PoseTable table = table_of(all);
    Rows detections;
    for (std::size_t row = refused.size(); row < all.size(); ++row)
      detections.push_back(static_cast<Row>(row));
    return engine::best_refused(library_, table, refused, detections, limit);
  }
};

TEST_F(BestRefused, LeavesTheBestOfEachModel) {
  const std::vector<Tested> poses{
      {0, 0.1F, 0, 10, 0}, {0, 0.3F, 0, 10, 1}, {0, 0.2F, 0, 10, 2}, {1, 0.25F, 0, 10, 0}};
  EXPECT_EQ(best(poses, {}, 2), (Rows{1, 3, 2}));
  EXPECT_EQ(best(poses, {}, 9), (Rows{1, 3, 2, 0}));
}

TEST_F(BestRefused, PrefersWhatMayBeAFurtherInstance) {
  const PoseTable table = table_of(
      {{0, 0.9F, 0, 10, 0}, {0, 0.4F, 0, 10, 1}, {0, 0.3F, 0, 10, 2}, {1, 0.2F, 0, 10, 3}});
  const std::vector<Refusal> refused{
      {1, Rejection::too_low, 0, 0.8F}, {2, Rejection::too_low}, {3, Rejection::too_low, 0, 0.8F}};
  const Rows detections{0};
  const auto best = [&](std::uint32_t limit) {
    return engine::best_refused(library_, table, refused, detections, limit);
  };
  EXPECT_EQ(best(1), (Rows{2, 3})) << "the better one lies beneath one of its own model";
  EXPECT_EQ(best(2), (Rows{1, 2, 3})) << "by falling score";
}

TEST_F(BestRefused, ReportsNoPlacementTwice) {
  const std::vector<Tested> poses{
      {0, 0.4F, 0, 10, 0}, {0, 0.3F, 0, 10, 0.09F}, {0, 0.2F, 0, 10, 0.11F}, {1, 0.1F, 0, 10, 0}};
  EXPECT_EQ(best(poses, {}, 9), (Rows{0, 2, 3}));
  EXPECT_EQ(best(poses, {{0, 0.9F, 0, 10, 0}}, 9), (Rows{2, 3})) << "a detection of it";
  Pose alternative = Pose::Identity();
  alternative.translation().x() = 0.09F;
  EXPECT_EQ(best(poses, {{0, 0.9F, 0, 10, 5, {alternative}}}, 9), Rows{3})
      << "an alternative of one";
}

}  // namespace
}  // namespace trivet
