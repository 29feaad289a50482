#include "storage/files/nearest_name.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace trivet {
namespace {

const std::vector<std::string_view> kKnown{"file", "scale", "symmetries", "symmetry_axis", "fx"};

TEST(NearestName, IsWhatWasProbablyMeant) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"scal", "scale"},
      {"sclae", "scale"},
      {"Scale", "scale"},
      {"scales", "scale"},
      {"flie", "file"},
      {"symetries", "symmetries"},
      {"symmetry-axis", "symmetry_axis"},
      {"SymmetryAxis", "symmetry_axis"},
      {"color", ""},
      {"x", ""},
      {"", ""},
      {"f", ""},
      {"Fx", "fx"},
      {std::string(100'000, 's'), ""},
  };
  for (const auto& [name, nearest] : cases) EXPECT_EQ(nearest_name(name, kKnown), nearest) << name;
  EXPECT_EQ(nearest_name("scal", {}), "");
}

TEST(NearestName, IsNamedWhereANameIsUnknown) {
  EXPECT_EQ(unknown_name("scal", kKnown), "found 'scal'; did you mean 'scale'?");
  EXPECT_EQ(unknown_name("\x1B[2J", kKnown),
            "expected one of file, scale, symmetries, symmetry_axis, fx, found '\\u001B[2J'");
}

}  // namespace
}  // namespace trivet
