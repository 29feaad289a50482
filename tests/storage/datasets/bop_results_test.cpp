#include "storage/datasets/bop_results.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

const std::string kHeader = "scene_id,im_id,obj_id,score,R,t,time\n";
const std::string kTurn = "0 -1 0 1 0 0 0 0 1";

class BopResults : public testing::Test {
 protected:
  void expect_refused(const std::string& text, std::size_t line, const std::string& why) const {
    const auto file = folder_.write("bad.csv", text);
    const auto results = read_bop_results(file);
    ASSERT_FALSE(results) << text;
    EXPECT_EQ(results.error().code, ErrorCode::bad_data);
    const std::string& message = results.error().message;
    EXPECT_EQ(message.find(file.string() + ", line " + std::to_string(line) + ": "), 0U) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
  }
  test::TempDir folder_;
};

TEST_F(BopResults, HaveTheFormOfTheBenchmark) {
  BopResult result{1, 3, 12, 0.5, {}, {10, -20.25, 812.5}, 0.125};
  result.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  BopResult untimed = result;
  untimed.image_id = 4;
  untimed.seconds = -1;
  const std::vector<BopResult> results{result, untimed};
  ASSERT_TRUE(write_bop_results(folder_ / "a.csv", results));
  EXPECT_EQ(test::read_bytes(folder_ / "a.csv"), kHeader + "1,3,12,0.5," + kTurn +
                                                     ",10 -20.25 812.5,0.125\n1,4,12,0.5," + kTurn +
                                                     ",10 -20.25 812.5,-1\n");
  ASSERT_TRUE(write_bop_results(folder_ / "none.csv", {}));
  EXPECT_EQ(test::read_bytes(folder_ / "none.csv"), kHeader);
  EXPECT_TRUE(read_bop_results(folder_ / "none.csv")->empty());
}

TEST_F(BopResults, ReadBackTheSameBits) {
  test::Random random;
  std::vector<BopResult> written;
  for (int i = 0; i < 200; ++i) {
    BopResult result;
    result.scene_id = i;
    result.image_id = 999'999'999 - i;
    result.object_id = i % 7;
    result.score = static_cast<double>(random.uniform(-1, 1)) / 3;
    result.R = random.motion().linear().cast<double>() * (1 + 1e-9);
    result.t_mm = random.direction().cast<double>() * 1e3 / 3;
    result.seconds = static_cast<double>(random.uniform(0, 100)) / 3;
    written.push_back(result);
  }
  written[0].score = std::numeric_limits<double>::denorm_min();
  written[1].t_mm.x() = 1e9;
  ASSERT_TRUE(write_bop_results(folder_ / "a.csv", written));
  const auto read = read_bop_results(folder_ / "a.csv");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const BopResult &a = written[i], &b = (*read)[i];
    EXPECT_EQ(std::tie(a.scene_id, a.image_id, a.object_id, a.score, a.seconds),
              std::tie(b.scene_id, b.image_id, b.object_id, b.score, b.seconds));
    EXPECT_EQ(a.R, b.R);
    EXPECT_EQ(a.t_mm, b.t_mm);
  }
}

TEST_F(BopResults, AreReadAsOtherProgramsWriteThem) {
  const auto results = read_bop_results(
      folder_.write("a.csv",
                    "scene_id,im_id,obj_id,score,R,t,time\r\n1,2,3,1e-3, 0  -1.005 0 1 0 0 0 0 1 "
                    ",+1.0 2e1 3,0.50000\r\n1,2,4,1,1 0 0 0 1 0 0 0 1,0 0 0,0.5009"));
  ASSERT_TRUE(results) << results.error().message;
  ASSERT_EQ(results->size(), 2U);
  EXPECT_EQ((*results)[0].score, 0.001);
  EXPECT_EQ((*results)[0].R(0, 1), -1.005);
  EXPECT_EQ((*results)[0].t_mm, Eigen::Vector3d(1, 20, 3));
  EXPECT_EQ((*results)[1].object_id, 4);
}

TEST_F(BopResults, AreRefusedByLine) {
  const std::string good = kHeader + "1,2,3,1," + kTurn + ",0 0 0,0.5\n";
  ASSERT_TRUE(read_bop_results(folder_.write("good.csv", good)));
  expect_refused("1,2,3,1," + kTurn + ",0 0 0,0.5\n", 1, "expected the header");
  expect_refused(good + "1,2,3,1," + kTurn + ",0 0 0\n", 3, "seven fields");
  expect_refused(good + "1,2,3,1," + kTurn + ",0 0 0,0.5,7\n", 3, "seven fields");
  expect_refused(good + "\n\n-1,2,3,1," + kTurn + ",0 0 0,0.5\n", 5, "scene_id");
  expect_refused(good + "1,2.5,3,1," + kTurn + ",0 0 0,0.5\n", 3, "im_id");
  expect_refused(good + "1,2,99999999999,1," + kTurn + ",0 0 0,0.5\n", 3, "obj_id");
  expect_refused(good + "1,2,3,nan," + kTurn + ",0 0 0,0.5\n", 3, "score");
  expect_refused(good + "1,2,3,1,0 -1 0 1 0 0 0 0,0 0 0,0.5\n", 3, "9 numbers");
  expect_refused(good + "1,2,3,1," + kTurn + " 1,0 0 0,0.5\n", 3, "9 numbers");
  expect_refused(good + "1,2,3,1,0 -1 0 1 0 0 0 0 -1,0 0 0,0.5\n", 3, "a rotation");
  expect_refused(good + "1,2,3,1,0 0 0 0 0 0 0 0 0,0 0 0,0.5\n", 3, "a rotation");
  expect_refused(good + "1,2,3,1," + kTurn + ",0 0 inf,0.5\n", 3, "3 numbers");
  expect_refused(good + "1,2,3,1," + kTurn + ",0 0 0,-2\n", 3, "seconds or -1");
  expect_refused(good + "1,2,4,1," + kTurn + ",0 0 0,0.502\n", 3, "as in the lines above");
  EXPECT_EQ(read_bop_results(folder_ / "none.csv").error().code, ErrorCode::missing_input);
  EXPECT_FALSE(read_bop_results(folder_.write("empty.csv", "")));
}

TEST_F(BopResults, SurviveAnyByteAnywhere) {
  const std::string good = kHeader + "1,2,3,1," + kTurn + ",0 0 0,0.5\n";
  for (std::size_t i = 0; i <= good.size(); ++i) {
    (void)read_bop_results(folder_.write("a.csv", good.substr(0, i)));
    for (const char byte : {'\0', ',', ' ', '\n', '-', '9', 'e', '\xFF'}) {
      std::string bad = good;
      bad.insert(i, 1, byte);
      const auto results = read_bop_results(folder_.write("a.csv", bad));
      for (const BopResult& result : results ? *results : std::vector<BopResult>())
        EXPECT_TRUE(result.R.allFinite() && result.t_mm.allFinite());
    }
  }
}

TEST(BopResultName, NamesTheDataSetAndItsSplit) {
  for (const char* name : {"trivet_lmo-test.csv", "a-b_ycbv-test-real.csv", "trivet_lmo-test_2.csv",
                           "out/trivet_lmo-test_5ed0-a_b.csv", "trivet_lmo-test.json.gz"}) {
    EXPECT_TRUE(is_bop_result_name(name)) << name;
  }
  for (const char* name :
       {"results.csv", "lmo-test.csv", "trivet_lmo.csv", "trivet_lmo_test.csv", "_lmo-test.csv",
        "trivet_-test.csv", "trivet_lmo-.csv", "trivet-lmo-test"})
    EXPECT_FALSE(is_bop_result_name(name)) << name;
}

}  // namespace
}  // namespace trivet
