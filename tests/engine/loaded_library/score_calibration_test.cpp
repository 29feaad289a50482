#include "engine/loaded_library/score_calibration.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "engine/loaded_library/default_score.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Json = nlohmann::json;

ScoreCalibration some_calibration() {
  ScoreCalibration calibration{{}, 5, 40, 90};
  calibration.adaptation.shift = -0.37F;
  for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k)
    calibration.adaptation.weights[k] = 1 + 0.03F * static_cast<float>(k);
  return calibration;
}

TEST(ScoreCalibration, ReadsBackWhatWasWritten) {
  const test::TempDir folder;
  ASSERT_TRUE(write_calibration(folder / "cell.json", some_calibration()));
  const Result<ScoreCalibration> read = read_calibration(folder / "cell.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, some_calibration());
}

TEST(ScoreCalibration, NamesScoresByTheirNumbers) {
  const std::string name = score_name(calibrated_score(some_calibration()));
  EXPECT_EQ(name.size(), 16U);
  EXPECT_EQ(score_name(calibrated_score(some_calibration())), name);
  EXPECT_NE(score_name(default_score()), name);
  EXPECT_EQ(score_name(calibrated_score({})), score_name(default_score()));
}

TEST(ScoreCalibration, NamesTheFaultOfABadFile) {
  const test::TempDir folder;
  ASSERT_TRUE(write_calibration(folder / "cell.json", some_calibration()));
  const Json good = Json::parse(test::read_bytes(folder / "cell.json"));
  const std::string part(kernels::kScoreParts[0].name);
  const auto message = [&](const std::string& text) {
    const Result<ScoreCalibration> read = read_calibration(folder.write("bad.json", text));
    EXPECT_FALSE(read) << text;
    return read ? "" : read.error().message;
  };
  struct Case {
    std::function<void(Json&)> break_it;
    const char* fault;
  };
  for (const Case& one : {
           Case{[](Json& j) { j = Json::array(); }, "expected an object"},
           Case{[](Json& j) { j["format"] = "gear"; }, "format: expected \"trivet score calibrat"},
           Case{[](Json& j) { j["version"] = 2; }, "version"},
           Case{[](Json& j) { j["score"] = "0123456789abcdef"; }, "calibrate again"},
           Case{[](Json& j) { j.erase("shift"); }, "shift"},
           Case{[](Json& j) { j["shift"] = "much"; }, "shift"},
           Case{[](Json& j) { j["shift"] = 3; }, "raise the log odds of no pose by more than 2.3"},
           Case{[](Json& j) { j["shift"] = -1e30; }, "shift"},
           Case{[&](Json& j) { j["weights"][part] = -1; }, "from 0 to 3"},
           Case{[&](Json& j) { j["weights"][part] = 1e9; }, "from 0 to 3"},
           Case{[&](Json& j) { j["weights"][part] = nullptr; }, "weights"},
           Case{[&](Json& j) { j["weights"].erase(part); }, "weights"},
           Case{[](Json& j) { j["weights"]["luck"] = 1; }, "weights"},
           Case{[](Json& j) { j["weights"] = 7; }, "weights"},
           Case{[](Json& j) { j["made_from"]["scans"] = -1; }, "made_from.scans"},
           Case{[](Json& j) { j.erase("made_from"); }, "made_from"},
       }) {
    Json bad = good;
    one.break_it(bad);
    const std::string found = message(bad.dump());
    EXPECT_NE(found.find(one.fault), std::string::npos) << found;
    EXPECT_NE(found.find("bad.json"), std::string::npos) << found;
  }
  const std::string text = good.dump();
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, text.size() / 2, text.size() - 1})
    EXPECT_FALSE(message(text.substr(0, size)).empty());
  EXPECT_EQ(read_calibration(folder / "absent.json").error().code, ErrorCode::missing_input);
}

}  // namespace
}  // namespace trivet
