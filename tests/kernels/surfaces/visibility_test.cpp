#include "kernels/surfaces/visibility.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_model.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;
using test::Shape;

struct Samples {
  Points points;
  Normals normals;
};

/// Points on random triangles, with normals from the winding.
Samples sample(Random& random, const Shape& shape, std::size_t n) {
  Samples out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = 3 * random.below(static_cast<std::uint32_t>(shape.triangles.size()));
    const Vector3f a = shape.vertices[t], b = shape.vertices[t + 1], c = shape.vertices[t + 2];
    const float u = random.uniform(0.05F, 0.9F), v = random.uniform(0.05F, 0.95F - u);
    out.points.push_back(a + u * (b - a) + v * (c - a));
    out.normals.push_back((b - a).cross(c - a).normalized());
  }
  return out;
}

RayScene scene_of(const Shape& shape) {
  auto scene = RayScene::from_mesh(shape.vertices, shape.triangles);
  EXPECT_TRUE(scene);
  return std::move(scene).value();
}

std::vector<ViewMask> views(const RayScene& scene, const Samples& samples, float offset = 1e-3F) {
  std::vector<ViewMask> masks(samples.points.size());
  compute_views(scene, samples.points, samples.normals, offset, kAllViews, masks);
  return masks;
}

/// A box without its lid: its inside sees the sky only through the opening.
Shape open_box() {
  Shape shape = test::box({-1, -1, 0}, {1, 1, 1});
  Shape open;
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const Vector3f a = shape.vertices[3 * t], b = shape.vertices[3 * t + 1],
                   c = shape.vertices[3 * t + 2];
    if (a.z() + b.z() + c.z() < 3) open.add(a, b, c);
  }
  return open;
}

// Whether view d is unobstructed from a point; empty where the result depends on rounding.
std::optional<bool> reference_visible(const Shape& shape, const Vector3f& point,
                                      const Vector3f& normal, float offset, std::size_t d) {
  const double cosine = normal.cast<double>().dot(view_direction(d).cast<double>());
  const double limit = std::cos(80 * std::numbers::pi / 180);
  if (std::abs(cosine - limit) < 1e-4) return std::nullopt;
  if (cosine < limit) return false;
  const auto hit = reference::nearest_hit(shape.vertices, shape.triangles, point + offset * normal,
                                          view_direction(d));
  if (!hit) return std::nullopt;
  return *hit == reference::kInfinity;
}

TEST(ViewDirections, AreUnitVectorsSpreadOverTheSphere) {
  for (std::size_t d = 0; d < kNumViews; ++d) {
    EXPECT_NEAR(view_direction(d).norm(), 1, 1e-6);
    for (std::size_t e = 0; e < d; ++e) {  // 4 pi / 256 each: a square of 12.7 degrees
      EXPECT_LT(view_direction(d).dot(view_direction(e)), std::cos(0.19)) << d << " " << e;
    }
  }
}

TEST(ViewDirections, KeepTheNumberingThatLibrariesRelyOn) {
  const double longitude = 100 * std::numbers::pi * (3 - std::sqrt(5));
  const double z = 1 - 201.0 / 256, r = std::sqrt(1 - z * z);
  EXPECT_TRUE(view_direction(100).cast<double>().isApprox(
      Eigen::Vector3d(r * std::cos(longitude), r * std::sin(longitude), z), 1e-6));
}

TEST(NearestView, AgreesWithReference) {
  Random random;
  for (int k = 0; k < 2000; ++k) {
    const Vector3f direction = random.direction();
    std::size_t expected = 0;
    for (std::size_t d = 0; d < kNumViews; ++d) {
      if ((view_direction(d) - direction).norm() < (view_direction(expected) - direction).norm()) {
        expected = d;
      }
    }
    const std::size_t found = nearest_view(random.uniform(0.1F, 9) * direction);
    // Rounding may choose the other of two equally near views.
    EXPECT_NEAR((view_direction(found) - direction).norm(),
                (view_direction(expected) - direction).norm(), 1e-5);
    EXPECT_LT((view_direction(found) - direction).norm(), 0.2F);
  }
  for (std::size_t d = 0; d < kNumViews; ++d) EXPECT_EQ(nearest_view(view_direction(d)), d);
}

TEST(ComputeViews, AgreesWithReferenceInAndAroundAnOpenBox) {
  Random random;
  const Shape shape = open_box();
  const RayScene scene = scene_of(shape);
  Samples samples = sample(random, shape, 60);
  for (std::size_t i = 0; i < 30; ++i) samples.normals.set(i, -samples.normals[i]);  // the inside
  const auto masks = views(scene, samples);
  int compared = 0;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    for (std::size_t d = 0; d < kNumViews; ++d) {
      const auto expected =
          reference_visible(shape, samples.points[i], samples.normals[i], 1e-3F, d);
      if (!expected) continue;
      ++compared;
      EXPECT_EQ(is_visible(masks[i], d), *expected) << "sample " << i << " view " << d;
    }
  }
  EXPECT_GT(compared, 15000);
}

TEST(ComputeViews, GivesNoViewToANormalThatIsNone) {
  const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
  Samples samples{Points(1), Normals(1)};
  samples.points.set(0, {0, 0, 1});
  samples.normals.set(0, Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(views(scene_of(cube), samples)[0], ViewMask{});
}

TEST(OrientOutward, TurnsEveryNormalOfAClosedSurfaceOutwardWhateverItsWinding) {
  Random random;
  Shape shape = test::box({-1, -1, -1}, {1, 1, 1});
  shape.join(test::prism(40, test::circle(0.4), 1, 3));
  for (const bool inverted : {false, true}) {
    const RayScene scene = scene_of(inverted ? shape.inside_out() : shape);
    const Samples outward = sample(random, shape, 300);
    Samples mixed = outward;
    for (std::size_t i = 0; i < 300; ++i) {
      if (random.below(2) == 0) mixed.normals.set(i, -mixed.normals[i]);
    }
    std::vector<ViewMask> masks(300);
    orient_outward(scene, mixed.points, mixed.normals, 1e-3F, masks);
    const auto expected = views(scene, outward);
    for (std::size_t i = 0; i < 300; ++i) {
      if (masks[i] == ViewMask{}) continue;  // where the prism stands on the box
      EXPECT_EQ(mixed.normals[i], outward.normals[i]) << i;
      EXPECT_EQ(masks[i], expected[i]) << i;
    }
  }
}

TEST(OrientOutward, KeepsTheNormalsOfAnOpenSheet) {
  Random random;
  Shape sheet;
  sheet.add({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const RayScene scene = scene_of(sheet);
  for (const Shape& side : {sheet, sheet.inside_out()}) {
    Samples samples = sample(random, side, 50);
    const Normals before = samples.normals;
    std::vector<ViewMask> masks(50);
    orient_outward(scene, samples.points, samples.normals, 1e-3F, masks);
    EXPECT_TRUE(test::same_bits(samples.normals, before));
  }
}

TEST(OrientOutward, GivesNoViewToWhatLiesInside) {
  Random random;
  const Shape inner = test::box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  Shape shape = test::box({-1, -1, -1}, {1, 1, 1});
  shape.join(inner);
  Samples samples = sample(random, inner, 50);
  std::vector<ViewMask> masks(50);
  orient_outward(scene_of(shape), samples.points, samples.normals, 1e-3F, masks);
  for (const ViewMask& mask : masks) EXPECT_EQ(mask, ViewMask{});
}

// The spheres around the points of a grid represent the surface, as the header derives.
TEST(OrientOutward, WorksOnCloudsByTheDocumentedSpheres) {
  constexpr int kSide = 20;
  constexpr float kSpacing = 2.0F / kSide;
  Samples samples;
  Normals outward;
  Random random;
  const Shape cube = test::box({-1, -1, -1}, {1, 1, 1});
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const float side = face % 2 == 0 ? 1 : -1;
    for (int i = 0; i < kSide * kSide; ++i) {
      Vector3f point, normal = Vector3f::Zero();
      normal[axis] = side;
      point[axis] = side;
      point[(axis + 1) % 3] = (static_cast<float>(i % kSide) + 0.5F) * kSpacing - 1;
      point[(axis + 2) % 3] = (static_cast<float>(i / kSide) + 0.5F) * kSpacing - 1;
      samples.points.push_back(point);
      samples.normals.push_back(random.below(2) == 0 ? normal : -normal);
      outward.push_back(normal);
    }
  }
  const auto scene = RayScene::from_spheres(samples.points, kCloudRadius * kSpacing);
  ASSERT_TRUE(scene);
  std::vector<ViewMask> masks(samples.points.size());
  orient_outward(*scene, samples.points, samples.normals, kCloudOffset * kSpacing, masks);
  EXPECT_TRUE(test::same_bits(samples.normals, outward));
  // A cube is convex: all views above the horizon of a face are free.
  EXPECT_EQ(masks, views(scene_of(cube), {samples.points, outward}));
}

TEST(OrientOutward, GivesTheSameBitsForAnyChunking) {
  Random random;
  const Shape shape = open_box();
  const RayScene scene = scene_of(shape);
  const Samples samples = sample(random, shape, 65);
  Normals whole = samples.normals;
  std::vector<ViewMask> expected(65);
  orient_outward(scene, samples.points, whole, 1e-3F, expected);
  for (const std::size_t grain : {1, 64}) {
    Normals split = samples.normals;
    std::vector<ViewMask> oriented(65), computed(65);
    test::for_chunks(65, grain, [&](std::size_t first, std::size_t count) {
      orient_outward(scene, samples.points.view().slice(first, count),
                     split.span().slice(first, count), 1e-3F,
                     std::span(oriented).subspan(first, count));
      compute_views(scene, samples.points.view().slice(first, count),
                    whole.view().slice(first, count), 1e-3F, kAllViews,
                    std::span(computed).subspan(first, count));
    });
    EXPECT_TRUE(test::same_bits(whole, split));
    EXPECT_EQ(oriented, expected);
    EXPECT_EQ(computed, expected);
  }
}

TEST(ComputeViews, TriesTheWantedDirectionsAlone) {
  Random random;
  const Shape shape = open_box();
  const RayScene scene = scene_of(shape);
  const Samples samples = sample(random, shape, 50);
  const ViewMask wanted{0xF0F0, 0, ~std::uint64_t{0}, 1};
  std::vector<ViewMask> some(50);
  compute_views(scene, samples.points, samples.normals, 1e-3F, wanted, some);
  const std::vector<ViewMask> all = views(scene, samples);
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t w = 0; w < kViewWords; ++w) EXPECT_EQ(some[i][w], all[i][w] & wanted[w]);
  }
}

TEST(OrientOutward, AllocatesNothing) {
  Random random;
  const Shape shape = open_box();
  const RayScene scene = scene_of(shape);
  Samples samples = sample(random, shape, 20);
  std::vector<ViewMask> masks(20);
  EXPECT_EQ(test::allocations_in([&] {
              orient_outward(scene, samples.points, samples.normals, 1e-3F, masks);
              compute_views(scene, samples.points, samples.normals, 1e-3F, kAllViews, masks);
              nearest_view({1, 2, 3});
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
