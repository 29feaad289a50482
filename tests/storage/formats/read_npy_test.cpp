// NumPy arrays of points and of depths.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::big;
using test::is_refused;
using test::kCamera;
using test::kReadOptions;
using test::little;
using test::npy_file;

class ReadNpy : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = kReadOptions) {
    return read_cloud(folder_.write("array.npy", bytes), options);
  }
  test::TempDir folder_;
};

/// The values 0, 1, 2 ... of a type.
template <class T>
std::string counted(int count, bool big_endian) {
  std::string bytes;
  for (int i = 0; i < count; ++i)
    bytes += big_endian ? big(static_cast<T>(i)) : little(static_cast<T>(i));
  return bytes;
}

std::string with_header(const std::string& header, const std::string& body) {
  std::string file("\x93NUMPY\x01\0", 8);
  file += little(static_cast<std::uint16_t>(header.size()));
  file += header;
  file += body;
  return file;
}

TEST_F(ReadNpy, ReadsPointsOfEveryTypeByteOrderAndVersion) {
  struct Typed {
    std::string name;
    std::string (*counted)(int, bool);
  };
  const std::vector<Typed> types{{"i2", counted<std::int16_t>}, {"u2", counted<std::uint16_t>},
                                 {"i4", counted<std::int32_t>}, {"u4", counted<std::uint32_t>},
                                 {"i8", counted<std::int64_t>}, {"u8", counted<std::uint64_t>},
                                 {"f4", counted<float>},        {"f8", counted<double>},
                                 {"i1", counted<std::int8_t>},  {"u1", counted<std::uint8_t>}};
  for (const Typed& type : types) {
    for (const bool big_endian : {false, true}) {
      for (const int version : {1, 2, 3}) {
        const auto cloud = read(npy_file((big_endian ? ">" : "<") + type.name, "(4, 3)",
                                         type.counted(12, big_endian), false, version));
        ASSERT_TRUE(cloud) << type.name << ": " << cloud.error().message;
        ASSERT_EQ(cloud->points.size(), 4U);
        for (std::size_t i = 0; i < 4; ++i) {
          const auto first = static_cast<float>(3 * i);
          EXPECT_EQ(cloud->points[i], Eigen::Vector3f(first, first + 1, first + 2)) << type.name;
        }
        EXPECT_FALSE(cloud->grid || cloud->viewpoint || !cloud->normals.empty());
      }
    }
  }
  EXPECT_TRUE(read(npy_file("|u1", "(4, 3)", counted<std::uint8_t>(12, false))));
}

TEST_F(ReadNpy, ReadsNormalsOfUnitLengthAndRefusesColors) {
  const auto cloud = read(npy_file(
      "<f4", "(2, 6)", little({1.F, 2.F, 3.F, 0.F, 0.6F, -0.8F, 4.F, 5.F, 6.F, 0.F, 0.F, 0.F})));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(cloud->normals[0], Eigen::Vector3f(0, 0.6F, -0.8F));
  EXPECT_EQ(cloud->normals[1], Eigen::Vector3f(0, 0, 0));
  EXPECT_TRUE(is_refused(read(npy_file("<f4", "(2, 6)", counted<float>(12, false))), "row 0"));
}

TEST_F(ReadNpy, ReadsTheOrderOfFortran) {
  // a[i, j] = 3 i + j, with i running fastest.
  std::string columns;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) columns += little(static_cast<float>(3 * i + j));
  const auto cloud = read(npy_file("<f4", "(4, 3)", columns, true));
  ASSERT_TRUE(cloud) << cloud.error().message;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto first = static_cast<float>(3 * i);
    EXPECT_EQ(cloud->points[i], Eigen::Vector3f(first, first + 1, first + 2));
  }
}

TEST_F(ReadNpy, KeepsTheGridOfAnOrganizedCloud) {
  // Two rows of three pixels: one is at the origin, one is not finite.
  const float nan = std::nanf("");
  const std::string rows = little({1.F, 1.F, 5.F, 0.F, 0.F, 0.F, 3.F, 1.F, 5.F}) +
                           little({1.F, 2.F, 5.F, nan, 2.F, 5.F, 3.F, 2.F, 5.F});
  std::string fortran;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t v_u : {0, 3, 1, 4, 2, 5}) fortran += rows.substr(4 * (3 * v_u + k), 4);
  for (const auto& file :
       {npy_file("<f4", "(2, 3, 3)", rows), npy_file("<f4", "(2, 3, 3)", fortran, true)}) {
    const auto cloud = read(file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(test::is_valid(*cloud));
    ASSERT_TRUE(cloud->grid);
    EXPECT_EQ(cloud->grid->width, 3U);
    EXPECT_EQ(cloud->grid->height, 2U);
    EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2, -1, 3}));
    EXPECT_EQ(cloud->points[3], Eigen::Vector3f(3, 2, 5));
    EXPECT_EQ(cloud->viewpoint, Eigen::Vector3f(0, 0, 0));
  }
  // A single row is read as an unorganized cloud.
  const auto list = read(npy_file("<f4", "(1, 6, 3)", rows));
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_FALSE(list->grid);
}

TEST_F(ReadNpy, ReadsDepthsAsItDoesThoseOfAPng) {
  std::vector<std::uint16_t> depths(16 * 20);
  for (std::size_t i = 0; i < depths.size(); ++i)
    depths[i] = static_cast<std::uint16_t>(i % 5 * 777);
  const auto expected =
      read_cloud(folder_.write("depth.png", test::depth_png(20, 16, depths)), kReadOptions);
  ASSERT_TRUE(expected);
  std::string u2, f4, f8;
  for (const std::uint16_t depth : depths) {
    u2 += big(depth);
    f4 += little(depth == 0 ? std::nanf("") : static_cast<float>(depth));
    f8 += little(depth == 0 ? std::numeric_limits<double>::infinity() : double(depth));
  }
  for (const auto& file : {npy_file(">u2", "(16, 20)", u2), npy_file("<f4", "(16, 20)", f4),
                           npy_file("<f8", "(16, 20, 1)", f8)}) {
    const auto cloud = read(file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(cloud->grid);
    EXPECT_EQ(cloud->camera, kCamera);
    EXPECT_EQ(cloud->viewpoint, expected->viewpoint);
    EXPECT_EQ(cloud->grid->width, 20U);
    EXPECT_EQ(cloud->grid->point_index, expected->grid->point_index);
    ASSERT_EQ(cloud->points.size(), expected->points.size());
    for (std::size_t i = 0; i < cloud->points.size(); ++i)
      ASSERT_EQ(cloud->points[i], expected->points[i]);
  }
  EXPECT_TRUE(is_refused(read(npy_file(">u2", "(16, 20)", u2), {}), "--camera CAMERA.json"));
  EXPECT_TRUE(is_refused(
      read(npy_file(">u2", "(16, 20)", u2), {.camera = kCamera, .max_pixels = 319}), "16"));
}

TEST_F(ReadNpy, TreatsNegativeDepthsAsNoneUnlessThereAreNoOthers) {
  std::string some, all;
  for (int i = 0; i < 256; ++i) {
    some += little(i < 100 ? -1.F : 500.F);
    all += little(-500.F);
  }
  const auto cloud = read(npy_file("<f4", "(16, 16)", some));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 156U);
  EXPECT_TRUE(is_refused(read(npy_file("<f4", "(16, 16)", all)), "negate"));
}

TEST_F(ReadNpy, ReadsWhatOtherWritersPut) {
  const std::string body = counted<float>(12, false);
  for (const std::string header :
       {"{\"descr\":\"<f4\",\"fortran_order\":False,\"shape\":(4,3)}",
        "{'shape': (4L, 3L), 'descr': '<f4', 'fortran_order': False}   \n",
        "{ 'fortran_order' : False, 'shape' : ( 4 , 3 , ), 'descr' : '<f4', }\n"}) {
    EXPECT_TRUE(read(with_header(header, body))) << header;
  }
  for (const std::string header :
       {"", "{}", "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3)",
        "{'descr': '<f4', 'fortran_order': 0, 'shape': (4, 3)}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (4, 3)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3), 'more': 1}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, -3)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (12)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': [4, 3]}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999, 3)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3)} + exit(1)"}) {
    EXPECT_TRUE(is_refused(read(with_header(header, body)), "byte ")) << header;
  }
}

TEST_F(ReadNpy, SaysWhatAnArrayIsThatCannotBeRead) {
  const std::string body = counted<float>(12, false);
  const auto refused = [&](const std::string& type, const std::string& shape,
                           const std::string& text) {
    EXPECT_TRUE(is_refused(read(npy_file(type, shape, body)), text)) << type << " " << shape;
  };
  refused("|O", "(12,)", "Python objects");
  refused("<f2", "(8, 3)", "astype");
  refused("<c8", "(2, 3)", "astype");
  refused("=f4", "(4, 3)", "astype");
  refused("", "(4, 3)", "astype");
  refused("<f4", "(12,)", "found (12)");
  refused("<f4", "()", "48 behind");
  refused("<f4", "(3, 4)", "a.T");
  refused("<f4", "(0, 3)", "empty");
  refused("<f4", "(5, 3)", "truncated");
  refused("<f4", "(3, 3)", "several arrays");
  refused("<f4", "(4611686018427387904, 4)", "truncated");
  refused("<f4", "(18446744073709551615, 18446744073709551615)", "truncated");
  refused("|u1", "(4, 4, 3)", "picture");
  const std::string fields =
      "{'descr': [('x', '<f4'), ('y', '<f4')], 'fortran_order': False, 'shape': (6,)}\n";
  EXPECT_TRUE(is_refused(read(with_header(fields, body)), "a structured one of named fields"));
  EXPECT_TRUE(is_refused(read(npy_file("<f4", "(4, 3)", body, false, 4)), "version 1.0"));
  EXPECT_TRUE(is_refused(read("PK, a file of several arrays"), "signature"));
  EXPECT_TRUE(is_refused(read(npy_file("<f4", "(4, 3)", body), {.max_points = 3}), "limit of 3"));
}

}  // namespace
}  // namespace trivet
