#include "storage/model_name.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet {
namespace {

TEST(ModelName, IsThatOfTheFileWhereItIsOne) {
  for (const std::string name : {"bracket", "M8x40-A2.v1_b", "7", "part_", "a-"})
    EXPECT_EQ(model_name_of("some folder/" + name + ".obj"), name);
}

TEST(ModelName, IsMadeFromAnyOtherFile) {
  EXPECT_EQ(model_name_of("my part (1).obj"), "my_part_1");
  EXPECT_EQ(model_name_of("_tmp/ .hidden part.ply"), "hidden_part");
  EXPECT_EQ(model_name_of("-bolt...v2.stl"), "bolt.v2");
  EXPECT_EQ(model_name_of("Schl\xC3\xBCssel 10 mm.stl"), "Schl_ssel_10_mm");
  EXPECT_EQ(model_name_of("a_ _b.stl"), "a___b") << "underscores of the file stay";
  EXPECT_EQ(model_name_of("\xE9\x9B\xB6\xE4\xBB\xB6.obj"), "model");
  const std::string long_name(300, 'x');
  EXPECT_EQ(model_name_of(long_name + ".obj"), long_name.substr(0, 128));
}

TEST(ModelName, IsAlwaysAName) {
  test::Random random;
  for (int i = 0; i < 2000; ++i) {
    std::string file;
    const std::uint32_t size = random.below(200);
    for (std::uint32_t k = 0; k < size; ++k)
      file += i % 2 == 0 ? static_cast<char>(1 + random.below(255)) : "a.._- 7("[random.below(8)];
    std::erase(file, '/');
    EXPECT_TRUE(is_model_name(model_name_of(file + ".ply"))) << file;
  }
}

}  // namespace
}  // namespace trivet
