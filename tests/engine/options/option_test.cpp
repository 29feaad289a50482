#include "engine/options/option.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/evaluation/degrade_scene.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/options/train_options.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "support/changed_option.hpp"

namespace trivet {
namespace {

template <class Options>
class EachOption : public testing::Test {};
using AllOptions = testing::Types<TrainOptions, RecognizeOptions, ScanOptions, DegradeOptions>;
TYPED_TEST_SUITE(EachOption, AllOptions);

TYPED_TEST(EachOption, IsDescribedAndHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const Option<TypeParam>& option : options_of<TypeParam>()) {
    EXPECT_TRUE(names.insert(option.info.name).second) << option.info.name;
    EXPECT_FALSE(option.info.label.empty()) << option.info.name;
    EXPECT_FALSE(option.info.help.empty()) << option.info.name;
    EXPECT_FALSE(option.info.group.empty()) << option.info.name;
    EXPECT_TRUE(check_option(option.info, option.get(TypeParam{}))) << "the usual value is valid";
  }
}

TYPED_TEST(EachOption, IsReadAndSetByItsDeclarationAlone) {
  for (const Option<TypeParam>& option : options_of<TypeParam>()) {
    TypeParam options;
    const OptionValue changed = test::changed_value(option.info, option.get(options));
    const Result<void> set = set_option(option, test::text_of(changed), options);
    ASSERT_TRUE(set) << set.error().message;
    EXPECT_EQ(option.get(options), changed) << option.info.name;
    EXPECT_FALSE(options == TypeParam{}) << option.info.name;
    for (const Option<TypeParam>& other : options_of<TypeParam>()) {
      if (other.info.name == option.info.name) continue;
      EXPECT_EQ(other.get(options), other.get(TypeParam{}))
          << other.info.name << " changed with " << option.info.name;
    }
  }
}

TYPED_TEST(EachOption, IsRefusedBeyondItsRange) {
  for (const Option<TypeParam>& option : options_of<TypeParam>()) {
    const OptionRange& range = option.info.range;
    std::vector<std::string> wrong;
    if (std::isfinite(range.low))
      wrong.push_back(value_text(range.above_low ? range.low : range.low - 1));
    if (std::isfinite(range.high) && range.high < 1e6) wrong.push_back(value_text(range.high + 1));
    if (option.info.kind != OptionKind::names || !option.info.choices.empty())
      wrong.emplace_back("luck");
    if (option.info.kind == OptionKind::count) wrong.emplace_back("1.5");
    if (option.info.kind == OptionKind::numbers) wrong.emplace_back("1,2");
    for (const std::string& text : wrong) {
      TypeParam options;
      const Result<void> set = set_option(option, text, options);
      ASSERT_FALSE(set) << option.info.name << " = " << text;
      EXPECT_EQ(set.error().code, ErrorCode::usage);
      EXPECT_EQ(set.error().message.rfind(std::string(option.info.name) + ": expected ", 0), 0U)
          << set.error().message;
      EXPECT_EQ(options, TypeParam{}) << "stays as it was";
    }
  }
}

TEST(Option, IsPrintedAsAPersonWouldWriteIt) {
  EXPECT_EQ(value_text(0.04), "0.04");
  EXPECT_EQ(value_text(true), "yes");
  EXPECT_EQ(value_text(std::vector<std::string>{"a", "b"}), "a, b");
  EXPECT_EQ(value_text(std::vector<double>{1, 0.5}), "1, 0.5");
  const auto default_text = [](std::string_view name) {
    const auto* const option = find_option<RecognizeOptions>(name);
    return option_text(option->info, option->get({}));
  };
  EXPECT_EQ(default_text("normal-window"), "2 to 7, by the scan's noise");
  EXPECT_EQ(default_text("max-distance"), "any");
  EXPECT_EQ(default_text("ablate"), "none");
}

TEST(Option, AcceptsAutoOnlyWhereTheProgramCanChoose) {
  RecognizeOptions options;
  options.normal_window = 3.0F;
  ASSERT_TRUE(set_option(*find_option<RecognizeOptions>("normal-window"), "auto", options));
  EXPECT_FALSE(options.normal_window);
  EXPECT_FALSE(set_option(*find_option<RecognizeOptions>("min-score"), "auto", options));
}

}  // namespace
}  // namespace trivet
