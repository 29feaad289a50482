#include "engine/recognition/report.hpp"

#include <gtest/gtest.h>

namespace trivet::engine {
namespace {

/// A search of a scene whose file is in tenths of the library's unit.
class Report : public testing::Test {
 protected:
  Report() {
    for (const char* name : {"nut", "bolt"}) library_.models.emplace_back().name = name;
    scene_.scale = 0.1;
    scene_.sensor.noise = 0.02F;
    scene_.sensor.range = 3;
    scene_.images.resize(1);
  }
  static Candidate candidate(std::uint32_t model, float score, float x = 0) {
    Candidate out;
    out.model = model;
    out.score = score;
    out.T_scene_model.translation().x() = x;
    return out;
  }
  SceneResult reported(SearchResult found) const {
    return report(library_, scene_, std::move(found), {});
  }
  Library library_;
  PreparedScene scene_;
};

TEST_F(Report, OrdersDetectionsByScoreAndThenAsTheyWereTaken) {
  const SceneResult result =
      reported({.detections = {candidate(0, 0.5F, 1), candidate(1, 0.9F, 2), candidate(0, 0.5F, 3)},
                .rejected = {}});
  ASSERT_EQ(result.detections.size(), 3U);
  EXPECT_EQ(result.detections[0].model, "bolt");
  EXPECT_FLOAT_EQ(result.detections[0].T_scene_model.translation().x(), 20);
  EXPECT_FLOAT_EQ(result.detections[1].T_scene_model.translation().x(), 10);
  EXPECT_FLOAT_EQ(result.detections[2].T_scene_model.translation().x(), 30);
}

TEST_F(Report, TellsLengthsInTheFilesUnit) {
  Candidate turned = candidate(0, 0.9F);
  turned.tolerance = 0.2F;
  turned.examination.mean_square = 0.25F;
  turned.examination.residual = 0;  // all of it may be correlated noise
  turned.alternatives.push_back(candidate(0, 0, 4).T_scene_model);
  turned.turns = TurnExtent{{{0, 0, 1}, {0.5F, 0, 0}}, -1, 1};
  turned.siblings = {1};
  const SceneResult result = reported({.detections = {turned}, .rejected = {}});
  const Detection& detection = result.detections[0];
  EXPECT_FLOAT_EQ(detection.rmse, 1);
  EXPECT_FLOAT_EQ(detection.alternatives[0].translation().x(), 40);
  EXPECT_FLOAT_EQ(detection.turns->axis.point.x(), 5);
  EXPECT_EQ(detection.siblings, std::vector<std::string>{"bolt"});
  EXPECT_FLOAT_EQ(result.stats.noise, 0.2F);
  EXPECT_FLOAT_EQ(result.stats.sensor->noise, 0.2F);
  EXPECT_FLOAT_EQ(result.stats.sensor->range, 30);
}

TEST_F(Report, TellsTheSharesOfTheWholeSilhouetteAlsoOfWhatLiesOutsideTheScan) {
  Candidate beyond = candidate(0, 0.9F);
  beyond.examination.covered = 20;
  beyond.examination.consistent = 20;
  beyond.examination.outside = 60;
  Candidate hidden = candidate(1, 0.8F);
  hidden.examination.covered = 40;
  hidden.examination.consistent = 10;
  hidden.examination.occluded = 30;
  const SceneResult result =
      reported({.detections = {beyond, hidden, candidate(0, 0)}, .rejected = {}});
  EXPECT_FLOAT_EQ(result.detections[0].visible_fraction, 0.25F)
      << "not all: most is not in the scan";
  EXPECT_FLOAT_EQ(result.detections[0].outside_fraction, 0.75F);
  EXPECT_FLOAT_EQ(result.detections[0].hidden_fraction, 0);
  EXPECT_FLOAT_EQ(result.detections[1].visible_fraction, 0.25F);
  EXPECT_FLOAT_EQ(result.detections[1].hidden_fraction, 0.75F);
  EXPECT_EQ(result.detections[2].visible_fraction, 0) << "nothing is seen of nothing";
}

TEST_F(Report, TellsOfNoSensorWhereSixImagesSeeASurface) {
  scene_.images.resize(6);
  EXPECT_FALSE(reported({}).stats.sensor);
}

TEST_F(Report, LeadsFromRejectedPosesToTheirDetections) {
  SearchResult found{.detections = {candidate(0, 0.6F), candidate(1, 0.9F)}, .rejected = {}};
  found.rejected.push_back({candidate(0, 0.4F, 1), Rejection::explained, 0, 0.7F});
  found.rejected.push_back({candidate(1, 0.3F, 1), Rejection::too_low});
  const SceneResult result = reported(std::move(found));
  ASSERT_EQ(result.rejected.size(), 2U);
  EXPECT_EQ(result.rejected[0].explained_by, 1U) << "that of the lower score comes second";
  EXPECT_EQ(result.rejected[0].explained_share, 0.7F);
  EXPECT_FLOAT_EQ(result.rejected[0].T_scene_model.translation().x(), 10);
  EXPECT_EQ(result.rejected[1].explained_by, std::nullopt);
  EXPECT_EQ(result.rejected[1].reason, Rejection::too_low);
}

}  // namespace
}  // namespace trivet::engine
