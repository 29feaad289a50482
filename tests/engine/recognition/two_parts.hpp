/// Fixture for tests of the whole recognition: one library of two parts, and a scan of both.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "engine/recognition/recognize.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::test {

/// The library is trained once per suite.
class TwoParts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bracket_ = bracket();
    lever_ = lever();
    recognizer_ = Recognizer(trained_library({{"bracket", &bracket_}, {"lever", &lever_}}));
  }

  /// Two parts in front of a wall; the bracket partly occludes the lever.
  static Cloud clutter() {
    static const Shape wall = box({-1, -1, 1.4F}, {1, 1, 1.5F});
    return render_scan(
        {{&wall, Pose::Identity()}, {&bracket_, bracket_pose()}, {&lever_, lever_pose()}});
  }
  static Cloud in_millimeters(Cloud scene) {
    const PointsSpan span = scene.points;
    for (const std::span<float> column : {span.x, span.y, span.z}) {
      for (float& value : column) value *= 1000;
    }
    return scene;
  }
  static Pose bracket_pose() { return pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F}); }
  static Pose lever_pose() { return pose_of({-0.6F, 0.5F, 1.9F}, {0.12F, 0.02F, 0.95F}); }

  static const Detection* find(const SceneResult& result, const std::string& model) {
    for (const Detection& detection : result.detections) {
      if (detection.model == model) return &detection;
    }
    return nullptr;
  }
  static void expect_pose(const Detection* found, const Pose& truth, float diameter) {
    ASSERT_NE(found, nullptr);
    const auto error =
        kernels::pose_distance(truth, found->T_scene_model, {}, Eigen::Vector3f::Zero());
    EXPECT_LT(error.translation, 0.01F * diameter);
    EXPECT_LT(error.rotation_rad, 0.02F);
  }

  static inline Shape bracket_, lever_;
  static inline Recognizer recognizer_{Library{}};
};

}  // namespace trivet::test
