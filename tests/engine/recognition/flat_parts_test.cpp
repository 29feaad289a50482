#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

constexpr int kScenes = 6;

/// An L cut out of sheet metal of 3 mm.
test::Shape sheet() {
  test::Shape shape = test::box({-0.06F, -0.04F, 0}, {0.06F, 0, 0.003F});
  shape.join(test::box({-0.06F, 0, 0}, {-0.01F, 0.04F, 0.003F}));
  return shape;
}

/// A scan and where the part is in it.
struct Scene {
  Cloud cloud;
  Pose truth;
};

/// A part on a slanted table, beside another one.
Scene scene_of(const test::Shape& part, int number) {
  static const test::Shape table = test::box({-1, -1, 0}, {1, 1, 0.1F}), other = test::lever();
  const auto k = static_cast<float>(number);
  // The table's face is its side at z = 0, which looks at the camera; parts stand on it along -z.
  const Pose on_table = test::pose_of({0.25F + 0.05F * k, 0.1F * k - 0.2F, 0}, {0, 0, 0.7F});
  const auto placed = [&](float turn, float x, float y) {
    return on_table * test::pose_of({0, 0, turn}, {x, y, 0}) *
           test::pose_of({3.14159265F, 0, 0}, {0, 0, 0});
  };
  const Pose truth = placed(1.1F * k, 0.06F, 0.02F * k - 0.05F);
  Cloud cloud = test::render_scan(
      {{&table, on_table}, {&part, truth}, {&other, placed(2.3F * k, -0.12F, 0.01F * k)}});
  return {std::move(cloud), truth};
}

// Nothing on its face tells where in its plane a sheet lies, only where it ends.
TEST(FlatParts, AreFoundByTheirEdges) {
  const test::Shape part = sheet();
  const Recognizer recognizer(
      test::trained_library({{"sheet", &part}}, {.tri_spin_images = false}));
  kernels::CounterRandom random(3, 0, 0);
  int found = 0;
  for (int k = 0; k < kScenes; ++k) {
    Scene scene = scene_of(part, k);
    for (float& z : scene.cloud.points.span().z) z += static_cast<float>(1e-4 * random.normal());
    const auto result = recognize(recognizer, scene.cloud, {}, {.method = Method::ppf});
    ASSERT_TRUE(result) << result.error().message;
    if (result->detections.size() != 1) continue;
    const kernels::PoseDistance apart = kernels::pose_distance(
        scene.truth, result->detections.front().T_scene_model, {}, {0, 0, 0});
    found += apart.translation < 0.003F && apart.rotation_rad < 0.05F ? 1 : 0;
  }
  EXPECT_GE(found, 5) << "with the only detection within 3 mm and 3 degrees";
}

}  // namespace
}  // namespace trivet
