#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Values = std::vector<float>;

class ReadIntensity : public testing::Test {
 protected:
  Values read(const std::string& name, const std::string& bytes, bool wanted = true) {
    const Result<Cloud> cloud = read_cloud(folder_.write(name, bytes), {.intensity = wanted});
    EXPECT_TRUE(cloud) << bytes << cloud.error().message;
    if (!cloud) return {};
    EXPECT_TRUE(cloud->intensity.empty() || cloud->intensity.size() == cloud->points.size());
    return {cloud->intensity.begin(), cloud->intensity.end()};
  }
  test::TempDir folder_;
};

constexpr float kRed = 0.299F * 255, kGreen = 0.587F * 255, kBlue = 0.114F * 255;

void expect_near(const Values& found, const Values& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-4F) << i;
}

TEST_F(ReadIntensity, IsAFieldOfPcd) {
  const std::string head = "VERSION .7\nFIELDS x y Intensity z\nSIZE 4 4 2 4\nTYPE F F U F\n";
  const std::string ascii =
      head + "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n0 0 7 1\nnan 1 8 1\n1 0 9 1\n";
  EXPECT_EQ(read("a.pcd", ascii), (Values{7, 9})) << "with the point that is left";
  EXPECT_TRUE(read("a.pcd", ascii, false).empty()) << "nobody asked";
  std::string binary = head + "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n";
  for (const std::uint16_t value : {std::uint16_t{700}, std::uint16_t{65535}})
    binary += test::little(static_cast<float>(value)) + test::little(0.5F) + test::little(value) +
              test::little(2.0F);
  EXPECT_EQ(read("b.pcd", binary), (Values{700, 65535}));
}

TEST_F(ReadIntensity, IsTheBrightnessOfPclsPackedColors) {
  constexpr std::array<std::uint32_t, 3> kColors{0xFF0000, 0x00FF00, 0x0000FF};
  const std::string sizes = "SIZE 4 4 4 4\n", counts = "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ";
  const Values expected{kRed, kGreen, kBlue};
  for (const std::string type : {"F", "U"}) {
    std::string file =
        "VERSION .7\nFIELDS x y z rgb\n" + sizes + "TYPE F F F " + type + "\n" + counts;
    std::string ascii = file + "ascii\n", binary = file + "binary\n";
    float x = 0;
    for (const std::uint32_t color : kColors) {
      binary += test::little(x) + test::little(0.5F) + test::little(2.0F) + test::little(color);
      const std::string whole = std::to_string(color);
      const std::string as_float = fmt::format("{:.9g}", std::bit_cast<float>(color));
      ascii += fmt::format("{} 0.5 2 {}\n", x++, type == "F" ? as_float : whole);
    }
    expect_near(read("c.pcd", binary), expected);
    expect_near(read("d.pcd", ascii), expected);
  }
  // With a fourth channel, the bits may be a signaling NaN: quieting it would change the red.
  const std::string noted = test::little(1.0F) + test::little(0.5F) + test::little(2.0F) +
                            test::little(std::uint32_t{0xFFBF0000});
  expect_near(read("e.pcd", "VERSION .7\nFIELDS x y z rgba\n" + sizes +
                                "TYPE F F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n" + noted),
              {0.299F * 0xBF});
}

TEST_F(ReadIntensity, IsAPropertyOfPlyOrItsColors) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\n";
  EXPECT_EQ(read("a.ply", head + "property float scalar_Intensity\nend_header\n"
                                 "0 0 1 0.25\n1 0 1 0.5\n"),
            (Values{0.25F, 0.5F}));
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  expect_near(read("b.ply", head + colors + "end_header\n0 0 1 255 0 0\n1 0 1 0 255 255\n"),
              {kRed, kGreen + kBlue});
  EXPECT_EQ(read("c.ply", head + colors +
                              "property uchar intensity\nend_header\n0 0 1 255 0 0 3\n"
                              "1 0 1 0 255 255 4\n"),
            (Values{3, 4}))
      << "its own before colors";
  EXPECT_TRUE(read("d.ply", head + "end_header\n0 0 1\n1 0 1\n").empty());
}

TEST_F(ReadIntensity, IsAColumnOfText) {
  EXPECT_EQ(read("a.xyz", "1 2 3 0.7\n4 5 6 0.1\n"), (Values{0.7F, 0.1F}));
  EXPECT_EQ(read("b.pts", "2\n1 2 3 -700 9 9 9\n4 5 6 -100 8 8 8\n"), (Values{-700, -100}));
  EXPECT_EQ(read("c.csv", "x,y,reflectance,z\n1,2,5,3\n4,5,6,6\n"), (Values{5, 6}));
  expect_near(read("d.xyz", "1 2 3 255 0 0\n4 5 6 0 255 0\n"), {kRed, kGreen});
  EXPECT_TRUE(read("e.xyz", "1 2 3 0 0.6 0.8\n4 5 6 0 0.8 0.6\n").empty()) << "normals";
  EXPECT_TRUE(read("f.xyz", "1 2 3 0 0.6 0.8 5\n4 5 6 0 0.8 0.6 5\n").empty()) << "normals";
  EXPECT_TRUE(read("g.xyz", "1 2 3\n4 5 6\n").empty());
  const Values gap = read("h.csv", "x,y,z,intensity\n1,2,3,\n4,5,6,7\n");
  ASSERT_EQ(gap.size(), 2U);
  EXPECT_TRUE(std::isnan(gap[0]));
  EXPECT_EQ(gap[1], 7);
}

}  // namespace
}  // namespace trivet
