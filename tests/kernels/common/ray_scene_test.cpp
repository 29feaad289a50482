#include "kernels/common/ray_scene.hpp"

#include <gtest/gtest.h>

#include <array>
#include <new>
#include <thread>

#include "storage/common/wait_for_memory.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_model.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;
using test::Shape;
constexpr float kFar = std::numeric_limits<float>::infinity();

Shape triangle_soup(Random& random, std::size_t n) {
  Shape soup;
  const auto corner = [&] {
    return Vector3f(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (std::size_t t = 0; t < n; ++t) {
    const Vector3f a = corner();
    soup.add(a, a + 0.5F * corner(), a + 0.5F * corner());
  }
  return soup;
}

/// Threads of a service may lack memory. Embree's builder crashes or hangs when one of its
/// allocations throws, and an abandoned scene must not pass for a complete one.
TEST(RayScene, IsCompleteOrNoneWhereverMemoryIsMissing) {
  std::thread(wait_for_memory_on_this_thread).join();
  Random random(1);
  const Shape soup = triangle_soup(random, 300);
  Points origins, directions;
  for (int k = 0; k < 100; ++k) {
    origins.push_back(2 * random.direction());
    directions.push_back(random.direction() - origins[origins.size() - 1]);
  }
  /// The ray distances to a mesh and, beside it, to an instance of it.
  const auto distances = [&]() -> Result<std::vector<float>> {
    const Result<RayScene> mesh = RayScene::from_mesh(soup.vertices, soup.triangles);
    if (!mesh) return mesh.error();
    const Result<RayScene> placed =
        RayScene::from_instances(std::array{RayScene::Instance{&*mesh, Pose::Identity()}});
    if (!placed) return placed.error();
    std::vector<float> found;
    for (std::size_t k = 0; k < origins.size(); ++k) {
      found.push_back(mesh->intersect(origins[k], directions[k], 0, kFar).distance);
      found.push_back(placed->intersect(origins[k], directions[k], 0, kFar).distance);
    }
    return found;
  };
  const Result<std::vector<float>> whole = distances();
  ASSERT_TRUE(whole) << whole.error().message;
  int num_failed = 0;
  for (std::int64_t n = 1;; ++n) {
    test::fail_allocation(n);
    try {
      const Result<std::vector<float>> found = distances();
      if (!found) {
        ++num_failed;
      } else {
        ASSERT_EQ(*found, *whole) << "allocation " << n;
      }
    } catch (const std::bad_alloc&) {
      ++num_failed;
    }
    const bool has_failed = test::has_failed_allocation();
    test::fail_allocation(0);
    if (!has_failed) break;
  }
  EXPECT_GT(num_failed, 10);
}

TEST(RayScene, AgreesWithReferenceOnRandomTriangles) {
  for (const std::size_t n : {1, 2, 3, 64, 500}) {
    Random random(n);
    const Shape soup = triangle_soup(random, n);
    const auto scene = RayScene::from_mesh(soup.vertices, soup.triangles);
    ASSERT_TRUE(scene);
    int compared = 0;
    for (int k = 0; k < 300; ++k) {
      const Vector3f origin = 2 * random.direction();
      const Vector3f direction = random.uniform(0.5F, 2) * (random.direction() - origin);
      const auto expected =
          reference::nearest_hit(soup.vertices, soup.triangles, origin, direction);
      if (!expected) continue;
      ++compared;
      const Hit hit = scene->intersect(origin, direction, 0, kFar);
      ASSERT_EQ(static_cast<bool>(hit), *expected < reference::kInfinity)
          << "n " << n << " ray " << k;
      EXPECT_EQ(scene->occluded(origin, direction, 0, kFar), static_cast<bool>(hit));
      if (!hit) continue;
      EXPECT_NEAR(hit.distance, *expected, 1e-4);
      ASSERT_LT(hit.primitive, n);
      EXPECT_EQ(hit.instance, Hit::kNone);
      const Vector3f a = soup.vertices[3 * hit.primitive];
      EXPECT_NEAR(hit.normal.norm(), 1, 1e-5);
      EXPECT_NEAR(hit.normal.dot(origin + hit.distance * direction - a), 0, 1e-4);
      const Vector3f by_winding = (soup.vertices[3 * hit.primitive + 1] - a)
                                      .cross(soup.vertices[3 * hit.primitive + 2] - a);
      EXPECT_GT(hit.normal.dot(by_winding), 0);
    }
    EXPECT_GT(compared, 250) << "n " << n;
  }
}

TEST(RayScene, AgreesWithReferenceOnDiscsThatStopRaysFromTheFront) {
  Random random;
  const Points centers = random.dyadic_cloud(100, 1);
  Normals normals;
  for (std::size_t i = 0; i < centers.size(); ++i) normals.push_back(random.direction());
  constexpr float kRadius = 0.1F;
  const auto scene = RayScene::from_discs(centers, normals, kRadius);
  ASSERT_TRUE(scene);
  int met = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector3f origin = 3 * random.direction();
    const Vector3f direction = 0.7F * random.direction() - origin;
    double expected = reference::kInfinity;
    bool grazes = false;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      const Eigen::Vector3d n = normals[i].cast<double>(), o = origin.cast<double>(),
                            d = direction.cast<double>(), c = centers[i].cast<double>();
      const double t = n.dot(c - o) / n.dot(d);
      const double from_center = (o + t * d - c).norm();
      grazes |= std::abs(from_center - 0.1) < 1e-3 || std::abs(n.dot(d) / d.norm()) < 1e-2;
      if (n.dot(d) < 0 && t > 0 && from_center < 0.1) expected = std::min(expected, t);
    }
    if (grazes) continue;
    const Hit hit = scene->intersect(origin, direction, 0, 10);
    EXPECT_EQ(scene->occluded(origin, direction, 0, 10), static_cast<bool>(hit));
    ASSERT_EQ(static_cast<bool>(hit), expected < reference::kInfinity);
    if (!hit) continue;
    ++met;
    EXPECT_NEAR(static_cast<double>(hit.distance), expected, 1e-5);
    EXPECT_NEAR(std::abs(hit.normal.dot(normals[hit.primitive])), 1, 1e-5);
  }
  EXPECT_GT(met, 100);
}

TEST(RayScene, AgreesWithReferenceOnSpheres) {
  Random random;
  const Points centers = random.dyadic_cloud(100, 1);
  constexpr float kRadius = 0.1F;
  const auto scene = RayScene::from_spheres(centers, kRadius);
  ASSERT_TRUE(scene);
  for (int k = 0; k < 500; ++k) {
    const Vector3f origin = 3 * random.direction();
    const Vector3f direction = 0.7F * random.direction() - origin;
    double expected = reference::kInfinity, loose = expected, tight = expected;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      expected = std::min(expected, reference::ray_sphere(origin, direction, centers[i], kRadius));
      tight =
          std::min(tight, reference::ray_sphere(origin, direction, centers[i], kRadius * 0.999));
      loose =
          std::min(loose, reference::ray_sphere(origin, direction, centers[i], kRadius * 1.001));
    }
    if (loose < reference::kInfinity && tight - loose > 0.01) continue;  // a grazing ray
    const Hit hit = scene->intersect(origin, direction, 0, kFar);
    ASSERT_EQ(static_cast<bool>(hit), expected < reference::kInfinity) << "ray " << k;
    EXPECT_EQ(scene->occluded(origin, direction, 0, kFar), static_cast<bool>(hit));
    if (!hit) continue;
    EXPECT_NEAR(hit.distance, expected, 1e-3);
    const Vector3f outward = origin + hit.distance * direction - centers[hit.primitive];
    EXPECT_GT(hit.normal.dot(outward), 0.99F * kRadius);
  }
}

TEST(RayScene, TracesAPacketAsItsRaysOneByOne) {
  Random random(7);
  const Shape soup = triangle_soup(random, 60);
  const auto scene = RayScene::from_mesh(soup.vertices, soup.triangles);
  ASSERT_TRUE(scene);
  std::size_t num_occluded = 0;
  for (std::size_t n = 0; n <= RayScene::kPacket; ++n) {
    for (int k = 0; k < 50; ++k) {
      const Vector3f origin = random.direction();
      Points directions;
      for (std::size_t i = 0; i < n; ++i) directions.push_back(random.direction());
      const std::uint32_t found = scene->occluded(origin, directions);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ((found >> i & 1U) != 0, scene->occluded(origin, directions[i], 0, kFar));
        num_occluded += found >> i & 1U;
      }
      EXPECT_EQ(found >> n, 0U) << "no bits beside those of the rays";
    }
  }
  EXPECT_GT(num_occluded, 100U);
  EXPECT_LT(num_occluded, 1700U);
}

TEST(RayScene, HitsOnlyBetweenNearAndFar) {
  const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
  const auto scene = RayScene::from_mesh(cube.vertices, cube.triangles);
  ASSERT_TRUE(scene);
  const Vector3f origin(0.3F, 0.2F, -5), forward(0, 0, 2);  // enters at 2, leaves at 3
  EXPECT_FALSE(scene->occluded(origin, forward, 0, 1.9F));
  EXPECT_TRUE(scene->occluded(origin, forward, 0, 2.1F));
  EXPECT_FALSE(scene->occluded(origin, forward, 2.1F, 2.9F));
  EXPECT_FLOAT_EQ(scene->intersect(origin, forward, 2.1F, kFar).distance, 3);
  EXPECT_FALSE(scene->occluded(origin, forward, 3.1F, kFar));
  EXPECT_FALSE(scene->occluded(origin, -forward, 0, kFar));
}

TEST(RayScene, LetsNoRayThroughSharedEdges) {
  const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
  const auto scene = RayScene::from_mesh(cube.vertices, cube.triangles);
  ASSERT_TRUE(scene);
  const Vector3f inside(0.1F, -0.2F, 0.3F);
  for (int i = 0; i <= 64; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 4; ++corner) {
        Vector3f edge;  // points along the cube's twelve edges
        edge[axis] = static_cast<float>(i) / 32 - 1;
        edge[(axis + 1) % 3] = (corner & 1) != 0 ? 1 : -1;
        edge[(axis + 2) % 3] = (corner & 2) != 0 ? 1 : -1;
        EXPECT_TRUE(scene->occluded(inside, edge - inside, 0, kFar)) << edge.transpose();
      }
    }
  }
}

TEST(RayScene, PlacesInstancesAsIfTheirVerticesWereMoved) {
  Random random;
  const Shape shape = triangle_soup(random, 40);
  const auto scene = RayScene::from_mesh(shape.vertices, shape.triangles);
  ASSERT_TRUE(scene);
  const Pose first = random.motion(), second = random.motion();
  const std::array instances{RayScene::Instance{&*scene, first},
                             RayScene::Instance{&*scene, second}};
  const auto placed = RayScene::from_instances(instances);
  const Shape joined = shape.moved(first).join(shape.moved(second));
  const auto expected = RayScene::from_mesh(joined.vertices, joined.triangles);
  ASSERT_TRUE(placed && expected);
  int hits = 0, agreed = 0;
  for (int k = 0; k < 500; ++k) {
    const Vector3f origin = 4 * random.direction();
    const Vector3f direction = random.direction() - origin;
    const Hit a = placed->intersect(origin, direction, 0, kFar);
    const Hit b = expected->intersect(origin, direction, 0, kFar);
    if (b) ++hits;
    if (!a || !b || a.primitive + 40 * a.instance != b.primitive)
      continue;  // an edge, counted below
    ++agreed;
    EXPECT_NEAR(a.distance, b.distance, 1e-4);
    EXPECT_NEAR(a.normal.dot(b.normal), 1, 1e-4);
  }
  EXPECT_GT(hits, 100);
  EXPECT_GE(agreed, hits - 3);
}

TEST(RayScene, OfNoInstancesStopsNoRay) {
  const auto scene = RayScene::from_instances({});
  ASSERT_TRUE(scene);
  EXPECT_FALSE(scene->occluded({0, 0, 0}, {0, 0, 1}, 0, kFar));
  EXPECT_FALSE(scene->intersect({0, 0, 0}, {0, 0, 1}, 0, kFar));
}

TEST(RayScene, KeepsInstancedScenesAlive) {
  std::optional<RayScene> world;
  {
    const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
    auto scene = RayScene::from_mesh(cube.vertices, cube.triangles);
    ASSERT_TRUE(scene);
    const std::array instances{RayScene::Instance{&*scene, Pose::Identity()}};
    auto placed = RayScene::from_instances(instances);
    ASSERT_TRUE(placed);
    world = std::move(placed).value();
  }
  EXPECT_TRUE(world->occluded({0, 0, -5}, {0, 0, 1}, 0, kFar));
}

TEST(RayScene, RefusesNothingToShootAt) {
  const auto mesh = RayScene::from_mesh(PointsView{}, Triangles{});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, ErrorCode::bad_data);
  const auto cloud = RayScene::from_spheres(PointsView{}, 1);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::bad_data);
}

TEST(RayScene, QueriesAllocateNothing) {
  const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
  const auto scene = RayScene::from_mesh(cube.vertices, cube.triangles);
  ASSERT_TRUE(scene);
  EXPECT_EQ(test::allocations_in([&] {
              scene->occluded({0, 0, -5}, {0, 0, 1}, 0, kFar);
              scene->intersect({0, 0, -5}, {0, 0, 1}, 0, kFar);
            }),
            0U);
}

TEST(RaySceneIntersectMany, AgreesWithOneRayAtATime) {
  const test::Shape shape = test::ellipsoid({0.3F, 0.5F, 0.8F}, 20);
  const Result<RayScene> scene = RayScene::from_mesh(shape.vertices, shape.triangles);
  ASSERT_TRUE(scene);
  test::Random random;
  const Vector3f eye(0.1F, -0.2F, 3);
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8},
                              std::size_t{9}, std::size_t{500}}) {
    Points directions(n);
    for (std::size_t i = 0; i < n; ++i)
      directions.set(i, {random.uniform(-0.3F, 0.3F), random.uniform(-0.3F, 0.3F), -1});
    std::vector<float> distances(n);
    Normals normals(n);
    scene->intersect_many(eye, directions, distances, normals);
    for (std::size_t i = 0; i < n; ++i) {
      const Hit one =
          scene->intersect(eye, directions[i], 0, std::numeric_limits<float>::infinity());
      ASSERT_EQ(std::isfinite(distances[i]), static_cast<bool>(one));
      if (!one) continue;
      EXPECT_NEAR(distances[i], one.distance, 1e-5F);
      EXPECT_LT((normals[i] - one.normal).norm(), 1e-4F);
    }
  }
}

}  // namespace
}  // namespace trivet::kernels
