#include "kernels/surfaces/subsample_by_normals.hpp"

#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;
constexpr float kThirtyDegrees = 0.5236F;

struct Oriented {
  Points points;
  Normals normals;
};

Oriented subsample(const Oriented& in, float cell, float max_angle = kThirtyDegrees) {
  Oriented out;
  SubsampleScratch scratch;
  subsample_by_normals({in.points, in.normals}, cell, max_angle, out.points, out.normals, scratch);
  return out;
}

Oriented random_cloud(Random& random, std::size_t n) {
  Oriented out{random.dyadic_cloud(n), {}};
  for (std::size_t i = 0; i < n; ++i) out.normals.push_back(random.direction());
  return out;
}

// A unit cube's surface around the origin, with its six outward normals.
Oriented cube(Random& random, std::size_t n) {
  Oriented out;
  for (std::size_t i = 0; i < n; ++i) {
    const int axis = static_cast<int>(random.below(3));
    const float side = random.below(2) == 0 ? -1.0F : 1.0F;
    Eigen::Vector3f p(random.uniform(-0.5F, 0.5F), random.uniform(-0.5F, 0.5F),
                      random.uniform(-0.5F, 0.5F));
    p[axis] = 0.5F * side;
    out.points.push_back(p);
    out.normals.push_back(side * Eigen::Vector3f::Unit(axis));
  }
  return out;
}

TEST(SubsampleByNormals, AgreesWithReferenceOnRandomClouds) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    const Oriented in = random_cloud(random, n);
    const Oriented found = subsample(in, 1);

    std::size_t at = 0;
    for (const auto& [voxel, indices] : reference::voxels(in.points, 1)) {
      std::vector<std::vector<std::uint32_t>> groups;
      for (const std::uint32_t i : indices) {
        bool joined = false;
        for (auto& group : groups) {
          const Eigen::Vector3d seed = in.normals[group[0]].cast<double>();
          const Eigen::Vector3d normal = in.normals[i].cast<double>();
          if (std::atan2(seed.cross(normal).norm(), seed.dot(normal)) <= kThirtyDegrees) {
            group.push_back(i);
            joined = true;
            break;
          }
        }
        if (!joined) groups.push_back({i});
      }
      for (const auto& group : groups) {
        Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
        for (const std::uint32_t i : group) {
          position += in.points[i].cast<double>() / static_cast<double>(group.size());
          normal += in.normals[i].cast<double>();
        }
        ASSERT_LT(at, found.points.size());
        ASSERT_LT((found.points[at].cast<double>() - position).norm(), 3e-7);
        ASSERT_LT((found.normals[at].cast<double>() - normal.normalized()).norm(), 2e-7);
        ++at;
      }
    }
    EXPECT_EQ(at, found.points.size());
    EXPECT_EQ(at, found.normals.size());
  }
}

TEST(SubsampleByNormals, KeepsEdgesAndCornersOfACubeSharp) {
  Random random;
  const Oriented found = subsample(cube(random, 5000), 0.25F);
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    EXPECT_EQ(found.normals[i].cwiseAbs().maxCoeff(), 1);  // one face's normal
    EXPECT_EQ(found.points[i].dot(found.normals[i]), 0.5F) << "off the face";
  }
  const auto corner = reference::within(found.points, {0.5F, 0.5F, 0.5F}, 0.25);
  EXPECT_EQ(corner.size(), 3U);
}

TEST(SubsampleByNormals, TreatsTheTwoSidesOfAThinWallApart) {
  Oriented wall;
  for (int i = 0; i < 10; ++i) {
    wall.points.push_back({0.5F, 0.5F, i % 2 == 0 ? 0.5F : 0.51F});
    wall.normals.push_back({0, 0, i % 2 == 0 ? -1.0F : 1.0F});
  }
  const Oriented found = subsample(wall, 1);
  ASSERT_EQ(found.points.size(), 2U);
  EXPECT_EQ(found.points[0], Eigen::Vector3f(0.5F, 0.5F, 0.5F));
  EXPECT_EQ(found.normals[1], Eigen::Vector3f(0, 0, 1));
}

TEST(SubsampleByNormals, FoundsGroupsByTheLowestIndex) {
  // Each normal lies 20 degrees from the next: a cell around the middle one would contain all
  // three.
  Oriented fan;
  for (const float degrees : {0.0F, 20.0F, 40.0F}) {
    const float angle = degrees * 0.0174533F;
    fan.points.push_back({0.5F, 0.5F, 0.5F});
    fan.normals.push_back({std::sin(angle), 0, std::cos(angle)});
  }
  EXPECT_EQ(subsample(fan, 1).points.size(), 2U);
  const std::vector<std::uint32_t> middle_first{1, 0, 2};
  const Oriented other{test::permuted(fan.points, middle_first),
                       test::permuted(fan.normals, middle_first)};
  EXPECT_EQ(subsample(other, 1).points.size(), 1U);
}

TEST(SubsampleByNormals, SkipsPointsWithoutNormalOrPosition) {
  const float nan = std::nanf("");
  Oriented in;
  in.points.push_back({0.5F, 0.5F, 0.5F});
  in.normals.push_back({nan, nan, nan});
  in.points.push_back({nan, 0.5F, 0.5F});
  in.normals.push_back({0, 0, 1});
  EXPECT_TRUE(subsample(in, 1).points.empty());
  in.points.push_back({0.25F, 0.5F, 0.5F});
  in.normals.push_back({0, 1, 0});
  const Oriented found = subsample(in, 1);
  ASSERT_EQ(found.points.size(), 1U);
  EXPECT_EQ(found.points[0], Eigen::Vector3f(0.25F, 0.5F, 0.5F));
}

TEST(SubsampleByNormals, GivesTheFirstNormalWhereTheMeanIsZero) {
  Oriented in;
  for (const float z : {1.0F, -1.0F}) {
    in.points.push_back({0.5F, 0.5F, 0.5F});
    in.normals.push_back({0, 0, z});
  }
  const Oriented found = subsample(in, 1, 4);
  ASSERT_EQ(found.normals.size(), 1U);
  EXPECT_EQ(found.normals[0], Eigen::Vector3f(0, 0, 1));
}

TEST(SubsampleByNormals, AllocatesNothingTheSecondTime) {
  Random random;
  const Oriented in = cube(random, 1000);
  Oriented out;
  SubsampleScratch scratch;
  const auto run = [&] {
    subsample_by_normals({in.points, in.normals}, 0.25F, kThirtyDegrees, out.points, out.normals,
                         scratch);
  };
  run();
  run();
  EXPECT_EQ(test::allocations_in(run), 0U);
}

}  // namespace
}  // namespace trivet::kernels
