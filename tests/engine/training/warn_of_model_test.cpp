#include "engine/training/warn_of_model.hpp"

#include <gtest/gtest.h>

#include "storage/data/cloud.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::engine {
namespace {

std::string warnings_of(const Cloud& cloud) {
  StageTimes times;
  const auto model = survey_model(cloud, {"a", "a.ply", 1, {}}, 1024, times);
  EXPECT_TRUE(model);
  std::string all;
  for (const std::string& warning : warn_of_model(*model)) all += warning + "\n";
  return all;
}

Cloud part_of(const Cloud& cloud, const std::function<bool(std::size_t)>& keep) {
  Cloud part = cloud;
  part.triangles = {};
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    if (!keep(t)) continue;
    part.triangles.a.push_back(cloud.triangles.a[t]);
    part.triangles.b.push_back(cloud.triangles.b[t]);
    part.triangles.c.push_back(cloud.triangles.c[t]);
  }
  return part;
}

TEST(WarnOfModel, DoesNotWarnOfACompletePart) {
  EXPECT_EQ(warnings_of(test::cloud_of(test::bracket())), "");
  EXPECT_EQ(warnings_of(test::cloud_of(test::lever())), "");
}

TEST(WarnOfModel, WarnsOfWhatWasLeftOutWhenItWasRead) {
  Cloud cloud = test::cloud_of(test::bracket());
  cloud.num_unused = 1;
  EXPECT_NE(warnings_of(cloud).find("1 vertex on no face left out"), std::string::npos);
  cloud.num_unused = 30;
  cloud.num_without_area = 2;
  EXPECT_NE(warnings_of(cloud).find("30 vertices on no face left out"), std::string::npos);
  EXPECT_NE(warnings_of(cloud).find("2 triangles without area left out"), std::string::npos);
}

TEST(WarnOfModel, WarnsOfASurfaceThatIsOpenOrOfOneSide) {
  const Cloud whole = test::cloud_of(test::bracket());
  const Cloud open = part_of(whole, [&](std::size_t t) {  // without the faces that point up
    const Eigen::Vector3f a = whole.points[whole.triangles.a[t]];
    const Eigen::Vector3f b = whole.points[whole.triangles.b[t]];
    const Eigen::Vector3f c = whole.points[whole.triangles.c[t]];
    return (b - a).cross(c - a).normalized().z() < 0.9F;
  });
  EXPECT_NE(warnings_of(open).find("open"), std::string::npos) << warnings_of(open);

  Cloud sheet;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 40; ++k) {
      const auto x = static_cast<float>(i) / 400, y = static_cast<float>(k) / 400;
      sheet.points.push_back({x, y, 0.2F * x * y});
    }
  }
  for (std::uint32_t i = 0; i + 1 < 40; ++i) {
    for (std::uint32_t k = 0; k + 1 < 40; ++k) {
      const std::uint32_t at = 40 * i + k;
      for (const auto& [a, b, c] :
           {std::array{at, at + 40, at + 1}, std::array{at + 1, at + 40, at + 41}}) {
        sheet.triangles.a.push_back(a);
        sheet.triangles.b.push_back(b);
        sheet.triangles.c.push_back(c);
      }
    }
  }
  EXPECT_NE(warnings_of(sheet).find("one view sees"), std::string::npos) << warnings_of(sheet);
}

TEST(WarnOfModel, WarnsOfFacesThatPointInwards) {
  Cloud turned = test::cloud_of(test::bracket());
  std::swap(turned.triangles.b, turned.triangles.c);
  EXPECT_NE(warnings_of(turned).find("point inwards"), std::string::npos) << warnings_of(turned);
}

TEST(WarnOfSizes, WarnsOfModelsThatDoNotFitTheUnitOrTheOthers) {
  const std::vector<float> parts{0.1F, 0.12F, 0.08F, 100, 5};
  const auto warnings = warn_of_sizes(parts, LengthUnit::meter);
  EXPECT_EQ(warnings[0], "");
  EXPECT_EQ(warnings[1], "");
  EXPECT_NE(warnings[3].find("100 m across"), std::string::npos) << warnings[3];
  EXPECT_NE(warnings[4].find("too large"), std::string::npos) << warnings[4];
  EXPECT_EQ(warn_of_sizes(std::vector<float>{100, 120, 80}, LengthUnit::millimeter),
            std::vector<std::string>(3));
}

}  // namespace
}  // namespace trivet::engine
