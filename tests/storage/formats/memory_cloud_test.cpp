// Arrays in memory give the same clouds as files with the same content.
#include "storage/formats/memory_cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::depth_png;
using test::kCamera;
using test::kReadOptions;
using test::little;
using test::npy_file;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes;
  for (const T value : values) bytes += little(value);
  return bytes;
}

/// Whether the clouds are identical bit by bit.
testing::AssertionResult are_same(const Result<Cloud>& found, const Result<Cloud>& expected) {
  if (!found || !expected)
    return testing::AssertionFailure() << (found ? expected : found).error().message;
  const auto same = [](const auto& a, const auto& b, auto of) { return of(a) == of(b); };
  const bool grids =
      found->grid.has_value() == expected->grid.has_value() &&
      (!found->grid || same(*found->grid, *expected->grid, [](const PixelGrid& grid) {
        return std::tie(grid.width, grid.height, grid.point_index);
      }));
  const bool good = test::same_bits(found->points, expected->points) &&
                    test::same_bits(found->normals, expected->normals) && grids &&
                    found->offset == expected->offset && found->camera == expected->camera &&
                    found->viewpoint == expected->viewpoint &&
                    found->num_invalid == expected->num_invalid &&
                    same(found->triangles, expected->triangles, [](const Triangles& triangles) {
                      return std::tie(triangles.a, triangles.b, triangles.c);
                    });
  if (!good) return testing::AssertionFailure() << "the clouds differ";
  return testing::AssertionSuccess();
}

testing::AssertionResult is_error(const Result<Cloud>& result, ErrorCode code,
                                  std::string_view text) {
  if (result) return testing::AssertionFailure() << "was taken";
  const Error& error = result.error();
  const bool good = error.code == code && error.message.find(text) != std::string::npos;
  return (good ? testing::AssertionSuccess() : testing::AssertionFailure()) << error.message;
}
testing::AssertionResult is_usage(const Result<Cloud>& result, std::string_view text) {
  return is_error(result, ErrorCode::usage, text);
}
testing::AssertionResult is_refused_array(const Result<Cloud>& result, std::string_view text) {
  return is_error(result, ErrorCode::bad_data, text);
}

class MemoryCloud : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& name, const std::string& bytes) {
    return read_cloud(folder_.write(name, bytes), kReadOptions);
  }
  test::TempDir folder_;
};
using CloudFromPoints = MemoryCloud;
using CloudFromDepths = MemoryCloud;

TEST_F(CloudFromPoints, IsTheCloudOfAFile) {
  const std::vector<float> xyz{0, 0, 0, 1.5F, kNaN, 2, 3, 4.25F, -5, 0.1F, 0.2F, INFINITY, 7, 8, 9};
  const std::vector<double> wide(xyz.begin(), xyz.end());
  const auto cloud = cloud_from_points(ArrayView::packed(xyz.data(), 5, 3));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_TRUE(test::is_valid(*cloud));
  EXPECT_EQ(cloud->num_invalid, 2U);
  EXPECT_TRUE(are_same(cloud, read("f4.npy", npy_file("<f4", "(5, 3)", bytes_of(xyz)))));
  EXPECT_TRUE(
      are_same(cloud, read("text.xyz", "0 0 0\n1.5 nan 2\n3 4.25 -5\n0.1 0.2 inf\n7 8 9\n")));
  EXPECT_TRUE(are_same(cloud_from_points(ArrayView::packed(wide.data(), 5, 3)), cloud));
  EXPECT_TRUE(are_same(cloud_from_points(ArrayView::packed(xyz.data(), 1, 5, 3)), cloud))
      << "a single row is a list of points";
}

TEST_F(CloudFromPoints, LosesNoDigitsFarFromZero) {
  const std::vector<double> xyz{512345.123, 5403210.987, 431.001, 512348.124, 5403210.988, 431.002,
                                512345.125, 5403212.989, 432.503, 512346.626, 5403211.49,  430.004};
  const auto cloud = cloud_from_points(ArrayView::packed(xyz.data(), 4, 3));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_FALSE(cloud->offset.isZero());
  EXPECT_TRUE(are_same(cloud, read("far.npy", npy_file("<f8", "(4, 3)", bytes_of(xyz)))));
  EXPECT_TRUE(is_refused_array(cloud_from_points(ArrayView::packed(xyz.data(), 4, 3),
                                                 {.name = "far points", .keep_origin = true}),
                               "far points: "));
}

TEST_F(CloudFromPoints, KeepsTheGridOfAnOrganizedCloud) {
  const std::vector<float> xyz{1, 1, 5, 0, 0, 0, 3, 1, 5, 1, 2, 5, kNaN, 2, 5, 3, 2, 5};
  std::vector<float> normals(xyz.size(), 0);
  for (std::size_t i = 2; i < normals.size(); i += 3) normals[i] = -1;
  normals[0] = kNaN;
  const MemoryCloudOptions options{.normals = ArrayView::packed(normals.data(), 2, 3, 3)};
  const auto cloud = cloud_from_points(ArrayView::packed(xyz.data(), 2, 3, 3), options);
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(cloud->grid);
  EXPECT_TRUE(test::is_valid(*cloud));
  EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2, -1, 3}));
  std::vector<float> both;
  for (std::size_t i = 0; i < 6; ++i) {
    both.insert(both.end(), &xyz[3 * i], &xyz[3 * i] + 3);
    both.insert(both.end(), &normals[3 * i], &normals[3 * i] + 3);
  }
  EXPECT_TRUE(are_same(cloud, read("grid.npy", npy_file("<f4", "(2, 3, 6)", bytes_of(both)))));
}

TEST_F(CloudFromPoints, AcceptsAnyStrides) {
  const std::vector<float> xyz{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const auto expected = cloud_from_points(ArrayView::packed(xyz.data(), 4, 3));
  const std::vector<float> transposed{1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12};
  EXPECT_TRUE(
      are_same(cloud_from_points(ArrayView::strided(transposed.data(), 4, 3, 1, 4)), expected));
  std::vector<float> backward(xyz.rbegin(), xyz.rend());
  EXPECT_TRUE(are_same(cloud_from_points(ArrayView::strided(backward.data() + 11, 4, 3, -3, -1)),
                       expected));
  std::vector<float> padded;
  for (std::size_t i = 0; i < 4; ++i)
    padded.insert(padded.end(), {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2], -1});
  EXPECT_TRUE(are_same(cloud_from_points(ArrayView::strided(padded.data(), 4, 3, 4)), expected));
  // Shape (2, 2, 3) with columns before rows: two dimensions are swapped.
  const auto image = cloud_from_points(ArrayView::packed(xyz.data(), 2, 2, 3));
  const std::vector<float> swapped{1, 2, 3, 7, 8, 9, 4, 5, 6, 10, 11, 12};
  EXPECT_TRUE(are_same(cloud_from_points({swapped.data(), 3, {2, 2, 3}, {3, 6, 1}}), image));
}

TEST_F(CloudFromPoints, ReadsTrianglesAndDropsThoseOfDroppedPoints) {
  const std::vector<float> xyz{0, 0, 0, 1, 0, 0, 0, 1, 0, kNaN, 0, 0, 1, 1, 0};
  const std::vector<std::uint32_t> faces{0, 1, 2, 1, 3, 2, 1, 4, 2};
  const std::vector<std::int64_t> wide(faces.begin(), faces.end());
  const auto cloud_of = [&](const ArrayView& triangles) {
    return cloud_from_points(ArrayView::packed(xyz.data(), 5, 3), {.triangles = triangles});
  };
  const auto cloud = cloud_of(ArrayView::packed(faces.data(), 3, 3));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_TRUE(test::is_valid(*cloud));
  EXPECT_TRUE(
      are_same(cloud, read("mesh.off",
                           "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n1 1 0\n3 0 1 2\n3 1 3 2\n"
                           "3 1 4 2\n")));
  EXPECT_TRUE(are_same(cloud_of(ArrayView::packed(wide.data(), 3, 3)), cloud));
  for (const std::int64_t wrong : {-1, 5}) {
    std::vector<std::int64_t> bad = wide;
    bad[4] = wrong;
    EXPECT_TRUE(is_refused_array(cloud_of(ArrayView::packed(bad.data(), 3, 3)), "triangle 1"));
  }
  EXPECT_TRUE(is_usage(cloud_of(ArrayView::packed(faces.data(), 1, 4)), "(m, 3)"));
  EXPECT_TRUE(cloud_of(ArrayView::packed<std::uint32_t>(nullptr, 0, 3)));
}

TEST_F(CloudFromPoints, RefusesWhatCannotBe) {
  const std::vector<float> xyz{1, 2, 3, 4, 5, 6};
  const std::size_t huge = std::numeric_limits<std::size_t>::max();
  const std::ptrdiff_t far = std::numeric_limits<std::ptrdiff_t>::min();
  EXPECT_TRUE(is_usage(cloud_from_points({}), "(n, 3)"));
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::packed(xyz.data(), 3, 2)), "found (3, 2)"));
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::packed<float>(nullptr, 2, 3)), "null"));
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::packed(xyz.data(), huge, 3)), "memory"));
  const auto* const between = reinterpret_cast<const float*>(  // never read
      reinterpret_cast<std::uintptr_t>(xyz.data()) + 2);
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::packed(between, 1, 3)), "multiples of 4"));
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::strided(xyz.data(), 2, 3, far)), "memory"));
  EXPECT_TRUE(is_usage(cloud_from_points({xyz.data(), 4, {1, 2, 3}, {6, 3, 1}}), "dimensions"));
  EXPECT_TRUE(is_usage(cloud_from_points(ArrayView::packed(xyz.data(), 2, 3),
                                         {.normals = ArrayView::packed(xyz.data(), 1, 3)}),
                       "normals"));
  EXPECT_TRUE(
      is_refused_array(cloud_from_points({xyz.data(), 3, {huge, huge, 3}, {0, 0, 1}}), "limit"));
  EXPECT_TRUE(is_refused_array(
      cloud_from_points(ArrayView::packed(xyz.data(), 2, 3), {.max_points = 1}), "limit of 1"));
  EXPECT_TRUE(
      is_refused_array(cloud_from_points(ArrayView::packed<float>(nullptr, 0, 3)), "found none"));
  const std::vector<float> nothing(6, kNaN);
  EXPECT_TRUE(is_refused_array(cloud_from_points(ArrayView::packed(nothing.data(), 2, 3)),
                               "none is finite"));
}

TEST_F(CloudFromDepths, IsTheCloudOfAPng) {
  std::vector<std::uint16_t> depths(20 * 16);
  for (std::size_t i = 0; i < depths.size(); ++i)
    depths[i] = static_cast<std::uint16_t>(i % 5 * 777);
  const auto expected = read("depth.png", depth_png(20, 16, depths));
  EXPECT_TRUE(
      are_same(cloud_from_depths(ArrayView::packed(depths.data(), 16, 20), kCamera), expected));
  std::vector<float> floats(depths.begin(), depths.end());
  for (float& depth : floats) depth = depth == 0 ? kNaN : depth;
  EXPECT_TRUE(
      are_same(cloud_from_depths(ArrayView::packed(floats.data(), 16, 20), kCamera), expected));
  // Columns stored one after the other, as doubles.
  std::vector<double> columns;
  for (std::size_t u = 0; u < 20; ++u)
    for (std::size_t v = 0; v < 16; ++v) columns.push_back(depths[20 * v + u]);
  EXPECT_TRUE(are_same(
      cloud_from_depths(ArrayView::strided(columns.data(), 16, 20, 1, 16), kCamera), expected));
  const std::vector<std::uint16_t> dark(20 * 16, 0);
  EXPECT_TRUE(are_same(cloud_from_depths(ArrayView::packed(dark.data(), 16, 20), kCamera),
                       read("dark.png", depth_png(20, 16, dark))));
}

TEST_F(CloudFromDepths, RefusesWhatCannotBe) {
  const std::vector<float> depths(20 * 16, -1);
  const ArrayView image = ArrayView::packed(depths.data(), 16, 20);
  const std::size_t huge = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(is_refused_array(cloud_from_depths(image, kCamera), "negate"));
  EXPECT_TRUE(is_refused_array(cloud_from_depths(image, {}), "fx, fy and depth_scale"));
  EXPECT_TRUE(is_refused_array(cloud_from_depths(image, kCamera, {.max_pixels = 319}), "16"));
  EXPECT_TRUE(is_refused_array(cloud_from_depths(ArrayView::packed<float>(nullptr, 0, 20), kCamera),
                               "20 x 0"));
  EXPECT_TRUE(is_refused_array(
      cloud_from_depths(ArrayView::strided(depths.data(), huge, huge, 0, 0), kCamera), "pixels"));
  EXPECT_TRUE(
      is_usage(cloud_from_depths(ArrayView::packed<float>(nullptr, 16, 20), kCamera), "null"));
  EXPECT_TRUE(is_usage(cloud_from_depths(ArrayView::packed(depths.data(), 4, 4, 20), kCamera),
                       "(height, width)"));
}

}  // namespace
}  // namespace trivet
