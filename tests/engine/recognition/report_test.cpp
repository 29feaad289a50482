#include "engine/recognition/report.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

namespace trivet::engine {
namespace {

/// A search of a scene whose file has a tenth of the library's unit.
class Report : public testing::Test {
 protected:
  Report() {
    std::vector<Model> models(2);
    models[0].name = "nut";
    models[1].name = "bolt";
    library_ = Library(std::move(models));
    scene_.scale = 0.1;
    scene_.sensor.noise = 0.02F;
    scene_.sensor.range = 3;
    scene_.images.resize(1);
  }
  /// Adds a detection to the found poses. Returns its row.
  Row add(std::uint32_t model, SettledPose settled) {
    const Row row = found_.poses.add(model, Source::ppf, Pose::Identity());
    found_.poses.set_settled(row, std::move(settled));
    found_.poses.fate[row] = PoseFate::detection;
    found_.detections.push_back(row);
    return row;
  }
  static SettledPose scored(float score, float x = 0) {
    SettledPose settled;
    settled.pose.score = score;
    settled.pose.T_scene_model.translation().x() = x;
    return settled;
  }
  void add_rejected(std::uint32_t model, float score, PoseFate fate, std::optional<Row> by = {},
                    float share = 0) {
    const Row row = add(model, scored(score, 1));
    found_.detections.pop_back();
    found_.rejected.push_back(row);
    found_.poses.fate[row] = fate;
    found_.poses.explained_by[row] = by;
    found_.poses.explained_share[row] = share;
  }
  SceneResult reported() const { return report(library_, scene_, found_, {}); }

  SearchResult found_;
  Library library_;
  PreparedScene scene_;
};

TEST_F(Report, OrdersDetectionsByScoreAndThenBySelection) {
  add(0, scored(0.5F, 1));
  add(1, scored(0.9F, 2));
  add(0, scored(0.5F, 3));
  const SceneResult result = reported();
  ASSERT_EQ(result.detections.size(), 3U);
  EXPECT_EQ(result.detections[0].model, "bolt");
  EXPECT_FLOAT_EQ(result.detections[0].T_scene_model.translation().x(), 20);
  EXPECT_FLOAT_EQ(result.detections[1].T_scene_model.translation().x(), 10);
  EXPECT_FLOAT_EQ(result.detections[2].T_scene_model.translation().x(), 30);
}

TEST_F(Report, GivesLengthsInTheFilesUnit) {
  SettledPose turned = scored(0.9F);
  turned.pose.test.examination.tolerance = 0.2F;
  turned.pose.test.examination.mean_square = 0.25F;
  turned.pose.test.examination.deviation = 0.05F;
  turned.pose.test.examination.residual = 0;  // all of it may be correlated noise
  turned.ambiguity.alternatives.push_back(scored(0, 4).pose.T_scene_model);
  turned.ambiguity.turns = TurnExtent{{{0, 0, 1}, {0.5F, 0, 0}}, -1, 1};
  turned.ambiguity.candidates = {{.model = 0, .share = 0.75F},
                                 {.model = 1, .share = 0.25F, .log_odds = -1, .num_measured = 7}};
  turned.ambiguity.candidates[1].T_scene_model.translation().x() = 3;
  add(0, turned);
  const SceneResult result = reported();
  const Detection& detection = result.detections[0];
  EXPECT_FLOAT_EQ(detection.rmse, 1);
  EXPECT_FLOAT_EQ(detection.deviation, 0.5F);
  EXPECT_FLOAT_EQ(detection.alternatives[0].translation().x(), 40);
  EXPECT_FLOAT_EQ(detection.turns->axis.point.x(), 5);
  ASSERT_EQ(detection.candidates.size(), 2U);
  EXPECT_EQ(detection.candidates[0].model, detection.model);
  EXPECT_EQ(detection.identity(), 0.75F);
  EXPECT_EQ(detection.candidates[1].model, "bolt");
  EXPECT_EQ(detection.candidates[1].log_odds, -1);
  EXPECT_EQ(detection.candidates[1].rays, 7U);
  EXPECT_FLOAT_EQ(detection.candidates[1].T_scene_model.translation().x(), 30);
  EXPECT_FLOAT_EQ(result.stats.noise, 0.2F);
  EXPECT_FLOAT_EQ(result.stats.sensor->noise, 0.2F);
  EXPECT_FLOAT_EQ(result.stats.sensor->range, 30);
}

TEST_F(Report, GivesTheSharesOfTheFullSilhouetteAlsoOutsideTheScan) {
  SettledPose beyond = scored(0.9F);
  beyond.pose.test.examination.covered = 20;
  beyond.pose.test.examination.consistent = 20;
  beyond.pose.test.examination.outside = 60;
  SettledPose hidden = scored(0.8F);
  hidden.pose.test.examination.covered = 40;
  hidden.pose.test.examination.consistent = 10;
  hidden.pose.test.examination.occluded = 30;
  add(0, beyond);
  add(1, hidden);
  add(0, scored(0));
  const SceneResult result = reported();
  EXPECT_FLOAT_EQ(result.detections[0].visible_fraction, 0.25F)
      << "not all: most is not in the scan";
  EXPECT_FLOAT_EQ(result.detections[0].outside_fraction, 0.75F);
  EXPECT_FLOAT_EQ(result.detections[0].hidden_fraction, 0);
  EXPECT_FLOAT_EQ(result.detections[1].visible_fraction, 0.25F);
  EXPECT_FLOAT_EQ(result.detections[1].hidden_fraction, 0.75F);
  EXPECT_EQ(result.detections[2].visible_fraction, 0) << "nothing is seen of nothing";
}

TEST_F(Report, ReportsNoSensorWhereSixImagesShowASurface) {
  scene_.images.resize(6);
  EXPECT_FALSE(reported().stats.sensor);
}

TEST_F(Report, LeadsFromRejectedPosesToTheirDetections) {
  const Row nut = add(0, scored(0.6F));
  add(1, scored(0.9F));
  add_rejected(0, 0.4F, PoseFate::explained, nut, 0.7F);
  add_rejected(1, 0.3F, PoseFate::too_low);
  const SceneResult result = reported();
  ASSERT_EQ(result.rejected.size(), 2U);
  EXPECT_EQ(result.rejected[0].explained_by, 1U) << "that of the lower score comes second";
  EXPECT_EQ(result.rejected[0].explained_share, 0.7F);
  EXPECT_FLOAT_EQ(result.rejected[0].T_scene_model.translation().x(), 10);
  EXPECT_EQ(result.rejected[1].explained_by, std::nullopt);
  EXPECT_EQ(result.rejected[1].reason, Rejection::too_low);
}

}  // namespace
}  // namespace trivet::engine
