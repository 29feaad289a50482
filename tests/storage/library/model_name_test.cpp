#include "storage/library/model_name.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet {
namespace {

TEST(ModelName, IsThatOfTheFileWhereItIsOne) {
  for (const std::string name : {"bracket", "M8x40-A2.v1_b", "7", "part_", "a-", "Schl\xC3\xBCssel",
                                 "\xE9\x9B\xB6\xE4\xBB\xB6\xE4\xB8\x80",
                                 "\xD0\xB3\xD0\xB0\xD0\xB9\xD0\xBA\xD0\xB0-M8", "\xF0\x9F\x94\xA9"})
    EXPECT_EQ(model_name_of("some folder/" + name + ".obj"), name);
}

TEST(ModelName, IsMadeFromAnyOtherFile) {
  EXPECT_EQ(model_name_of("my part (1).obj"), "my_part_1");
  EXPECT_EQ(model_name_of("_tmp/ .hidden part.ply"), "hidden_part");
  EXPECT_EQ(model_name_of("-bolt...v2.stl"), "bolt.v2");
  EXPECT_EQ(model_name_of("Schl\xC3\xBCssel 10 mm.stl"), "Schl\xC3\xBCssel_10_mm");
  EXPECT_EQ(model_name_of("a_ _b.stl"), "a___b") << "underscores of the file stay";
  EXPECT_EQ(model_name_of("\xE9\x9B\xB6 (1).obj"), "\xE9\x9B\xB6_1");
  EXPECT_EQ(model_name_of("(1).obj"), "1");
  EXPECT_EQ(model_name_of("()[].obj"), "model");
  EXPECT_EQ(model_name_of("Schlu\xCC\x88ssel.stl"), "Schl\xC3\xBCssel") << "as macOS writes it";
  EXPECT_EQ(model_name_of("a\xFF\xFE"
                          "b\xC3.obj"),
            "a_b")
      << "bytes that are no UTF-8";
  const std::string long_name(300, 'x');
  EXPECT_EQ(model_name_of(long_name + ".obj"), long_name.substr(0, 128));
  std::string letters;
  while (letters.size() < 300) letters += "\xE9\x9B\xB6";
  EXPECT_EQ(model_name_of(letters + ".obj"), letters.substr(0, 126)) << "no character is cut";
}

// None of these names can leave a folder, reverse a line of text or imitate another name.
TEST(ModelName, IsNothingThatActsOnPathsOrText) {
  for (const std::string& name : {std::string(),
                                  std::string("a/b"),
                                  std::string("../a"),
                                  std::string(".a"),
                                  std::string("a..b"),
                                  std::string("a b"),
                                  std::string("a\\b"),
                                  std::string("a\0b", 3),
                                  std::string("a\nb"),
                                  std::string("a\x1B[2J"),
                                  std::string("a\x7F"),
                                  std::string("a\xC2\x9B"),
                                  std::string("a\xE2\x80\xAE"
                                              "b"),
                                  std::string("a\xE2\x81\xA6"),
                                  std::string("a\xD8\x9C"),
                                  std::string("a\xC2\xA0"
                                              "b"),
                                  std::string("a\xE2\x80\x8B"
                                              "b"),
                                  std::string("\xEF\xBB\xBF"
                                              "a"),
                                  std::string("a\xEF\xBF\xBD"),
                                  std::string("a\xE2\x80\xA8"),
                                  std::string("a\xC0\xAF"),
                                  std::string("a\xED\xA0\x80"),
                                  std::string("a\xF4\x90\x80\x80"),
                                  std::string("a\xE9\x9B"),
                                  std::string(129, 'x'),
                                  std::string("a,b"),
                                  std::string("a=b"),
                                  std::string("a:b")}) {
    EXPECT_FALSE(is_model_name(name)) << name;
  }
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
