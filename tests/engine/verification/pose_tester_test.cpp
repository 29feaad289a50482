#include "engine/verification/pose_tester.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// An L of 20 mm height with a boss of 15 mm on its face, and its mirror image [m].
test::Shape hand(float side) {
  const auto block = [&](Eigen::Vector3f low, Eigen::Vector3f high) {
    if (side < 0) {
      std::swap(low.x(), high.x());
      low.x() *= -1;
      high.x() *= -1;
    }
    return test::box(low, high);
  };
  test::Shape shape = block({-0.05F, -0.04F, 0}, {0.05F, 0.01F, 0.02F});
  shape.join(block({-0.05F, 0.01F, 0}, {0.01F, 0.04F, 0.02F}));
  shape.join(block({-0.035F, -0.025F, 0.02F}, {-0.015F, -0.005F, 0.035F}));
  return shape;
}

/// A screw whose head, a block of 30 mm x 22 mm x 12 mm, rests on z = 0.
test::Shape screw() {
  test::Shape shape = test::box({-0.015F, -0.011F, 0}, {0.015F, 0.011F, 0.012F});
  return shape.join(test::prism(32, test::circle(0.006), -0.03, 0));
}

class PoseTesterOnATable : public testing::Test {
 protected:
  PreparedScene scan_of(const std::vector<test::Placed>& placed) {
    StageTimes times;
    auto scene = prepare_scene(test::render_scan(placed), {}, times);
    EXPECT_TRUE(scene) << scene.error().message;
    return std::move(*scene);
  }
  /// Tests the only model of a library at a pose.
  static TestedPose examine(const Recognizer& recognizer, const PreparedScene& scene,
                            const Pose& pose, const PoseTestOptions& options = {}) {
    const PoseTester tester(*tested_model(recognizer.library(), 0), scene, options);
    kernels::ExamineScratch scratch;
    return tester.examine(**recognizer.surface(0), recognizer.score(), pose, scratch);
  }
  static Recognizer recognizer_of(const test::Shape& shape) {
    return Recognizer(test::trained_library({{"part", &shape}}, {.tri_spin_images = false}));
  }

  /// Seen from above, aslant; z points up.
  const Pose table_ = test::pose_of({2.7F, 0, 0}, {0, 0, 0.6F});
  const test::Shape slab_ = test::box({-1, -1, -0.1F}, {1, 1, 0});
};

TEST_F(PoseTesterOnATable, RefusesTheMirroredPartThatWouldReachIntoTheTable) {
  const test::Shape left = hand(-1), right = hand(1);
  const PreparedScene scene = scan_of({{&slab_, table_}, {&left, table_}});
  const TestedPose there = examine(recognizer_of(left), scene, table_);
  EXPECT_GT(there.score, 0.9F);
  EXPECT_EQ(there.test.depth_in_ground, 0);
  // Turned over, the other hand has the same L, and its boss below.
  const Pose turned = table_ * test::pose_of({0, std::numbers::pi_v<float>, 0}, {0, 0, 0.02F});
  const TestedPose other = examine(recognizer_of(right), scene, turned);
  EXPECT_GT(other.test.examination.consistent, 0.7F * other.test.examination.covered);
  EXPECT_NEAR(other.test.depth_in_ground, 0.015F, 0.001F);
  EXPECT_EQ(other.score, 0);
}

// A pose in the middle of what deviates is as far off as that, however exactly all is measured.
TEST_F(PoseTesterOnATable, IsLessCertainOfPartsThatDeviateFromTheirModels) {
  const test::Shape model = hand(1);
  test::Shape part = model;
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    const Eigen::Vector3f p = part.vertices[i];
    part.vertices.set(i,
                      {1.02F * p.x(), p.y(), 1.03F * p.z()});  // 1 mm at its ends, as castings are
  }
  const PreparedScene scene = scan_of({{&slab_, table_}, {&part, table_}});
  const Recognizer recognizer = recognizer_of(model);
  PoseTestOptions options;
  const TestedPose exact = examine(recognizer, scene, table_, options);
  options.verify.model_deviation = 0.001F;
  const TestedPose deviating = examine(recognizer, scene, table_, options);
  EXPECT_GT(deviating.score, 0.9F);
  const auto sigma_of_shift = [](const TestedPose& pose) {
    return std::sqrt(pose.test.covariance.topLeftCorner<3, 3>().trace());
  };
  EXPECT_LT(sigma_of_shift(exact), 0.0005F);
  EXPECT_GT(sigma_of_shift(deviating), 0.0006F);
}

TEST_F(PoseTesterOnATable, FindsAScrewInAFaceThatFillsTheView) {
  const test::Shape part = screw();
  const PreparedScene scene = scan_of({{&slab_, table_}, {&part, table_}});
  const TestedPose in_it = examine(recognizer_of(part), scene, table_);
  EXPECT_GT(in_it.score, 0.9F);
  EXPECT_EQ(in_it.test.examination.violation, 0);
  EXPECT_EQ(in_it.test.depth_in_ground, 0);
}

TEST_F(PoseTesterOnATable, RefusesATallBlockInPlaceOfALowOne) {
  const test::Shape low = test::box({-0.05F, -0.03F, 0}, {0.05F, 0.03F, 0.02F}),
                    tall = test::box({-0.05F, -0.03F, -0.03F}, {0.05F, 0.03F, 0.02F});
  const PreparedScene scene = scan_of({{&slab_, table_}, {&low, table_}});
  EXPECT_EQ(examine(recognizer_of(low), scene, table_).test.depth_in_ground, 0);
  const TestedPose sunk = examine(recognizer_of(tall), scene, table_);
  EXPECT_NEAR(sunk.test.depth_in_ground, 0.03F, 0.001F);
  EXPECT_EQ(sunk.score, 0);
  // The face of a plate that lies on the table has a back side: something may be let into it.
  const test::Shape plate = test::box({-0.15F, -0.12F, 0}, {0.15F, 0.12F, 0.04F});
  const Pose on_plate = table_ * test::pose_of({0, 0, 0}, {0, 0, 0.04F});
  const PreparedScene with_plate = scan_of({{&slab_, table_}, {&plate, table_}, {&low, on_plate}});
  EXPECT_EQ(examine(recognizer_of(tall), with_plate, on_plate).test.depth_in_ground, 0);
}

// Scanners with a laser line see little of the inside of a box.
TEST_F(PoseTesterOnATable, ScoresWhatIsMostlyNotMeasured) {
  const test::Shape part = hand(1);
  Cloud scan = test::render_scan({{&slab_, table_}, {&part, table_}});
  const Pose T_part_camera = table_.inverse();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f point = T_part_camera * Eigen::Vector3f(scan.points[i]);
    if (point.x() < 0.005F && point.x() > -0.05F && point.z() > 0.001F && point.z() < 0.021F)
      scan.points.set(i, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  }
  StageTimes times;
  const auto scene = prepare_scene(std::move(scan), {}, times);
  ASSERT_TRUE(scene) << scene.error().message;
  const TestedPose there = examine(recognizer_of(part), *scene, table_);
  EXPECT_GT(there.test.examination.unknown, there.test.examination.consistent);
  EXPECT_GT(there.score, 0.1F);
}

TEST_F(PoseTesterOnATable, FindsAPartUnderAPlate) {
  // A plate above an end of the part, whose face is larger than the part and has the table behind it.
  const test::Shape part = hand(1), plate = test::box({-0.2F, -0.2F, 0.05F}, {0.01F, 0.2F, 0.06F});
  const PreparedScene scene = scan_of({{&slab_, table_}, {&part, table_}, {&plate, table_}});
  const TestedPose there = examine(recognizer_of(part), scene, table_);
  EXPECT_GT(there.test.examination.occluded, 0);
  EXPECT_LT(there.test.examination.violation, 0.02F * there.test.examination.covered);
  EXPECT_GT(there.score, 0.5F);
  // Nothing is seen of a part that the same plate hides altogether.
  const Pose below = table_ * test::pose_of({0, 0, 0}, {-0.1F, 0, 0});
  EXPECT_GT(examine(recognizer_of(part), scene, below).test.examination.violation, 0);
}

}  // namespace
}  // namespace trivet::engine
