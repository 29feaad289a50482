/// Compares the object information of a BOP data set with the formulas of the benchmark's scripts,
/// reimplemented here: pixel by pixel, over an image and the eight of its size around it.
#include "engine/simulation/bop_truth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "support/shapes.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;

constexpr int kWidth = 64, kHeight = 48;
const Vector3d kLow(-30, -20, -10), kHigh(30, 20, 10);  // of the box [mm]

ScanModel box_model() {
  const test::Shape box = test::box(kLow.cast<float>() / 1000, kHigh.cast<float>() / 1000);
  ScanModel model;
  model.name = "box";
  model.vertices = box.vertices;
  model.triangles = box.triangles;
  return model;
}

Camera camera() { return {60, 62, 31.25, 23.75, 0.5}; }

Vector3d ray_of(int u, int v) {
  return {(u - camera().cx) / camera().fx, (v - camera().cy) / camera().fy, 1};
}

/// Depth of the box along the optical axis; 0: the pixel's ray misses it.
double box_depth(int u, int v, const Pose& pose) {
  const Eigen::Isometry3d into(pose.cast<double>().inverse());
  const Vector3d origin = into.translation(), direction = into.linear() * ray_of(u, v);
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double a = (kLow[axis] - origin[axis]) / direction[axis],
                 b = (kHigh[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : 0;
}

/// min x, min y, max x - min x, max y - min y
struct Extent {
  int num = 0;
  std::array<int, 4> box{-1, -1, -1, -1};
  void add(int x, int y) {
    if (num++ == 0) box = {x, y, 0, 0};
    const int right = std::max(box[0] + box[2], x), bottom = std::max(box[1] + box[3], y);
    box[0] = std::min(box[0], x);
    box[1] = std::min(box[1], y);
    box[2] = right - box[0];
    box[3] = bottom - box[1];
  }
};

struct Expected {
  Extent all, visible;
  int num_inside = 0, num_valid = 0;
};

Expected expect(const Pose& pose, const std::vector<std::uint16_t>& depths) {
  Expected out;
  for (int v = -kHeight; v < 2 * kHeight; ++v) {
    for (int u = -kWidth; u < 2 * kWidth; ++u) {
      const double z = box_depth(u, v, pose);
      if (!(z > 0)) continue;
      out.all.add(u, v);
      if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
      ++out.num_inside;
      const std::uint16_t raw = depths[static_cast<std::size_t>(v * kWidth + u)];
      if (raw > 0) ++out.num_valid;
      const double behind = (z - raw * camera().depth_scale) * ray_of(u, v).norm();
      if (raw == 0 || behind <= 15) out.visible.add(u, v);
    }
  }
  return out;
}

Pose pose_at(float x, float y, float z) {
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::AngleAxisf(0.9F, Eigen::Vector3f(2, -3, 1).normalized()).toRotationMatrix();
  pose.translation() << x, y, z;
  return pose;
}

/// A wall in front of, close behind, and far behind an object at 400 mm, in stripes, with holes.
std::vector<std::uint16_t> striped_wall() {
  std::vector<std::uint16_t> depths;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const int v = i / kWidth;
    const double wall = v % 4 == 0 ? 300 : v % 4 == 1 ? 392 : 600;  // [mm]
    const bool hole = i % 5 == 0;
    depths.push_back(static_cast<std::uint16_t>(hole ? 0 : std::lround(wall / 0.5)));
  }
  return depths;
}

class BopTruth : public testing::Test {
 protected:
  void describe(const Pose& pose, const std::vector<std::uint16_t>& depths) {
    const std::vector<ScanModel> models{box_model()};
    const auto truth = engine::BopTruth::create(models);
    ASSERT_TRUE(truth) << truth.error().message;
    image_.camera = camera();
    image_.instances.resize(1);
    image_.instances[0].object_id = 1;
    image_.instances[0].T_camera_model = pose;
    auto views = truth->describe(depths, kWidth, image_);
    ASSERT_TRUE(views) << views.error().message;
    ASSERT_EQ(views->size(), 1U);
    view_ = std::move(views->front());
  }
  const BopInstance& instance() const { return image_.instances[0]; }
  static int count(const std::vector<std::uint8_t>& mask) {
    EXPECT_EQ(mask.size(), std::size_t{kWidth} * kHeight);
    return static_cast<int>(std::count(mask.begin(), mask.end(), 255));
  }

  BopImage image_;
  engine::ObjectView view_;
};

TEST_F(BopTruth, AgreesWithTheFormulasOfTheBenchmark) {
  const auto depths = striped_wall();
  // At the center; across the left border; across the lower right corner.
  for (const Pose& pose : {pose_at(0, 0, 400), pose_at(-200, 10, 400), pose_at(205, 160, 400)}) {
    const Expected expected = expect(pose, depths);
    describe(pose, depths);
    ASSERT_GT(expected.visible.num, 4);
    EXPECT_EQ(instance().px_count_all, expected.all.num);
    EXPECT_EQ(instance().px_count_valid, expected.num_valid);
    EXPECT_EQ(instance().px_count_visib, expected.visible.num);
    EXPECT_DOUBLE_EQ(instance().visib_fract,
                     expected.visible.num / static_cast<double>(expected.all.num));
    EXPECT_EQ(instance().bbox_obj, expected.all.box) << "beyond the image too";
    EXPECT_EQ(instance().bbox_visib, expected.visible.box);
    EXPECT_EQ(count(view_.mask), expected.num_inside);
    EXPECT_EQ(count(view_.mask_visible), expected.visible.num);
  }
}

TEST_F(BopTruth, GivesNoBoxesOfHiddenObjects) {
  describe(pose_at(0, 0, 400), std::vector<std::uint16_t>(kWidth * kHeight, 600));  // 300 mm
  EXPECT_GT(instance().px_count_all, 10);
  EXPECT_EQ(instance().px_count_valid, instance().px_count_all);
  EXPECT_EQ(instance().px_count_visib, 0);
  EXPECT_EQ(instance().visib_fract, 0);
  EXPECT_EQ(instance().bbox_obj, (std::array{-1, -1, -1, -1}));
  EXPECT_EQ(instance().bbox_visib, (std::array{-1, -1, -1, -1}));
  EXPECT_EQ(count(view_.mask_visible), 0);
}

TEST_F(BopTruth, CountsWhatIsBeyondTheImage) {
  describe(pose_at(-320, 0, 400), std::vector<std::uint16_t>(kWidth * kHeight, 0));
  EXPECT_GT(instance().px_count_all, 10);
  EXPECT_EQ(instance().px_count_visib, 0);
  EXPECT_EQ(instance().bbox_obj[2], -1);
  describe(pose_at(0, 0, -400), std::vector<std::uint16_t>(kWidth * kHeight, 0));
  EXPECT_EQ(instance().px_count_all, 0) << "behind the camera";
  EXPECT_EQ(instance().visib_fract, 0);
}

}  // namespace
}  // namespace trivet
