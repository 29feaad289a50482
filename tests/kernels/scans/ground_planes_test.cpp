#include "kernels/scans/ground_planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr std::uint32_t kAcross = 40, kDown = 30;

/// Images that look straight at surfaces at these depths.
RangeImage facing_image(const std::vector<float>& depths) {
  RangeImage image;
  image.geometry = {Pose::Identity(), 100, 100, 19.5F, 14.5F, kAcross, kDown};
  image.depth.assign(depths.begin(), depths.end());
  return image;
}

std::vector<float> flat_depths(float depth) {
  return std::vector<float>(std::size_t{kAcross} * kDown, depth);
}

void put(std::vector<float>& depths, std::array<std::uint32_t, 4> box, float depth) {
  for (std::uint32_t v = box[1]; v < box[3]; ++v) {
    for (std::uint32_t u = box[0]; u < box[2]; ++u) depths[kAcross * v + u] = depth;
  }
}

Plane facing_plane(float depth) { return {Vector3f(0, 0, -1), -depth, 0, 0.01F}; }

TEST(FindGround, IsTheTableAndNotThePlateOnIt) {
  std::vector<float> depths = flat_depths(1);
  put(depths, {5, 5, 30, 25}, 0.9F);
  const std::vector<Plane> planes{facing_plane(0.9F), facing_plane(1)};
  EXPECT_EQ(find_ground(facing_image(depths), planes, 9), (std::vector<std::uint8_t>{0, 1}));
}

TEST(FindGround, TellsTheFaceOfABodyByAHoleInIt) {
  std::vector<float> depths = flat_depths(1);
  const std::vector<Plane> planes{facing_plane(1)};
  put(depths, {10, 10, 13, 13}, 1.1F);
  EXPECT_EQ(find_ground(facing_image(depths), planes, 9).front(), 0);
  EXPECT_EQ(find_ground(facing_image(depths), planes, 10).front(), 1) << "stray measurements";
  put(depths, {10, 10, 13, 13}, 0);
  EXPECT_EQ(find_ground(facing_image(depths), planes, 9).front(), 1) << "not measured";
  put(depths, {10, 10, 13, 13}, 1.015F);
  EXPECT_EQ(find_ground(facing_image(depths), planes, 9).front(), 1) << "both scatter by 0.01";
  put(depths, {10, 10, 13, 13}, 1.025F);
  EXPECT_EQ(find_ground(facing_image(depths), planes, 9).front(), 0);
}

/// The size of the largest patch by repeated passes of labels over all pairs of neighbors.
std::size_t largest_patch_beyond(const std::vector<float>& depths, float beyond) {
  std::vector<std::size_t> label(depths.size());
  for (std::size_t k = 0; k < label.size(); ++k) label[k] = depths[k] > beyond ? k + 1 : 0;
  for (bool changed = true; changed;) {
    changed = false;
    const auto join = [&](std::size_t a, std::size_t b) {
      if (label[a] == 0 || label[b] == 0 || label[a] == label[b]) return;
      label[a] = label[b] = std::min(label[a], label[b]);
      changed = true;
    };
    for (std::size_t k = 0; k < label.size(); ++k) {
      if (k % kAcross + 1 < kAcross) join(k, k + 1);
      if (k + kAcross < label.size()) join(k, k + kAcross);
    }
  }
  std::vector<std::size_t> count(label.size() + 1);
  for (const std::size_t l : label) ++count[l];
  count[0] = 0;
  return *std::max_element(count.begin(), count.end());
}

TEST(FindGround, FindsPatchesOfAnyFormAsANaiveReferenceDoes) {
  for (std::uint64_t trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    test::Random random(trial);
    const float share = random.uniform(0.2F, 0.7F);
    std::vector<float> depths = flat_depths(1);
    for (float& depth : depths) {
      if (random.uniform(0, 1) < share) depth = 1.2F;
    }
    const RangeImage image = facing_image(depths);
    const std::vector<Plane> planes{facing_plane(1)};
    const std::size_t size = largest_patch_beyond(depths, 1.02F);
    EXPECT_EQ(find_ground(image, planes, size).front(), 0);
    EXPECT_EQ(find_ground(image, planes, size + 1).front(), 1);
  }
}

}  // namespace
}  // namespace trivet::kernels
