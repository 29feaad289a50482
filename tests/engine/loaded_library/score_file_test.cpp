#include "engine/loaded_library/score_file.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "engine/loaded_library/default_score.hpp"
#include "support/fitted_score.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Json = nlohmann::ordered_json;

Result<FittedScore> parse(const std::string& text) {
  return parse_score(std::as_bytes(std::span(text)), "score.json");
}

TEST(DefaultScore, IsThatOfItsFile) {
  const kernels::ScoreModel &score = default_score(), &expected = test::fitted_score();
  EXPECT_EQ(score.bias, expected.bias);
  EXPECT_EQ(score.knots, expected.knots);
  EXPECT_EQ(score.weights, expected.weights);
}

// Thus a fit to the same detections leaves the file unchanged.
TEST(ScoreFile, WritesWhatItReads) {
  const std::string text = test::read_bytes(test::kFittedScore);
  const Result<FittedScore> score = parse(text);
  ASSERT_TRUE(score) << score.error().message;
  EXPECT_EQ(score_text(*score), text);
}

TEST(ScoreFile, KeepsFiveDigitsOfEachNumber) {
  FittedScore score{default_score(), "a \"fit\"\nof two lines"};
  score.model.bias = {-1.0F / 3, 1e-7F};
  score.model.weights[1][0] = {12345.678F, 0, 2.5e-5F, 1};
  const Result<FittedScore> read = parse(score_text(score));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->origin, score.origin);
  EXPECT_EQ(read->model.bias, (std::array{-0.33333F, 1e-7F}));
  EXPECT_EQ(read->model.weights[1][0], (std::array{12346.0F, 0.0F, 2.5e-5F, 1.0F}));
}

TEST(ScoreFile, NamesTheFaultOfABadFile) {
  const Json good = Json::parse(test::read_bytes(test::kFittedScore));
  struct Case {
    std::function<void(Json&)> break_it;
    const char* fault;
  };
  for (const Case& one : {
           Case{[](Json& j) { j = Json::array(); }, "expected an object"},
           Case{[](Json& j) { j["format"] = "gear"; }, "format: expected \"trivet score\""},
           Case{[](Json& j) { j["version"] = 2; }, "version"},
           Case{[](Json& j) { j.erase("origin"); }, "origin"},
           Case{[](Json& j) { j["bias"].erase("shared"); }, "bias: expected \"shared\", found"},
           Case{[](Json& j) { j["parts"].erase("relief"); }, "parts: expected \"relief\""},
           Case{[](Json& j) { j["parts"]["luck"] = j["parts"]["relief"]; }, "luck"},
           Case{[](Json& j) { j["parts"]["relief"].erase("knots"); }, "parts.relief"},
           Case{[](Json& j) { j["parts"]["relief"]["knots"].push_back(9); }, "5 numbers instead"},
           Case{[](Json& j) { j["parts"]["relief"]["knots"][1] = 9; }, "do not fall"},
           Case{[](Json& j) { j["parts"]["relief"]["shared"][1] = -1; }, "relief.shared[1]"},
           Case{[](Json& j) { j["parts"]["relief"]["shared"][1] = nullptr; }, "relief.shared[1]"},
           Case{[](Json& j) { j["parts"]["relief"]["shared"][1] = 1e39; }, "relief.shared[1]"},
       }) {
    Json bad = good;
    one.break_it(bad);
    const Result<FittedScore> read = parse(bad.dump());
    ASSERT_FALSE(read) << one.fault;
    EXPECT_EQ(read.error().code, ErrorCode::bad_data);
    EXPECT_NE(read.error().message.find(one.fault), std::string::npos) << read.error().message;
    EXPECT_TRUE(read.error().message.starts_with("score.json: ")) << read.error().message;
  }
  EXPECT_FALSE(parse(good.dump().substr(0, 500)));
  EXPECT_FALSE(parse(R"({"format": "trivet score", "version": 1, "origin": "", "bias": 1e999})"));
}

}  // namespace
}  // namespace trivet
