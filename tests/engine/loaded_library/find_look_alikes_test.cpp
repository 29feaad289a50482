#include "engine/loaded_library/find_look_alikes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/common/thread_limit.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

/// A bracket, a moved bracket with a shorter fin, and a part that resembles neither.
class FindLookAlikes : public testing::Test {
 protected:
  static test::Shape like_the_bracket() {
    test::Shape shape = test::box({-0.08F, -0.05F, 0}, {0.08F, 0.05F, 0.02F});
    shape.join(test::box({-0.07F, -0.04F, 0.02F}, {-0.03F, 0.01F, 0.11F}));
    shape.join(test::box({-0.03F, -0.02F, 0.02F}, {0.03F, -0.005F, 0.06F}));
    shape.join(test::ellipsoid({0.025F, 0.02F, 0.03F}, 24)
                   .moved(Pose(Eigen::Translation3f(0.045F, 0.025F, 0.035F))));
    return shape.moved(move());
  }
  static Pose move() { return test::pose_of({0.4F, -1.1F, 0.7F}, {0.3F, -0.1F, 0.05F}); }

  static void SetUpTestSuite() {
    static const test::Shape bracket = test::bracket(), like = like_the_bracket(),
                             lever = test::lever();
    library_ = test::trained_library({{"bracket", &bracket}, {"like", &like}, {"lever", &lever}},
                                     {.tri_spin_images = false});
    frames_ = *shape_frames(library_);
  }
  static inline Library library_;
  static inline std::vector<kernels::ShapeFrame> frames_;
};

TEST_F(FindLookAlikes, ReportsThePoseOfALookAlike) {
  const std::vector<LookAlike> look_alikes = *find_look_alikes(library_, frames_, 0);
  ASSERT_FALSE(look_alikes.empty());
  EXPECT_EQ(look_alikes[0].model, 1U) << "the alikest first";
  const auto error = kernels::pose_distance(look_alikes[0].T_model_other, move().inverse(), {},
                                            library_.models[1].center);
  EXPECT_LT(error.translation, 0.03F * library_.models[0].diameter);
  EXPECT_LT(error.rotation_rad, 0.14F) << "refinement reaches 8 degrees";
  EXPECT_TRUE(std::ranges::none_of(look_alikes, [](const LookAlike& s) { return s.model != 1; }));
}

TEST_F(FindLookAlikes, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto poses = [](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<float> out;
    const auto found = *find_look_alikes(library_, *shape_frames(library_), 1);
    for (const LookAlike& look_alike : found) {
      const Eigen::Matrix4f pose = look_alike.T_model_other.matrix();
      out.push_back(static_cast<float>(look_alike.model));
      out.insert(out.end(), pose.data(), pose.data() + 16);
    }
    return out;
  };
  EXPECT_FALSE(poses(1).empty());
  EXPECT_EQ(poses(1), poses(2));
}

}  // namespace
}  // namespace trivet::engine
