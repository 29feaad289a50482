#include "engine/common/pipeline.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <vector>

namespace trivet::engine {
namespace {

TEST(RunPipeline, UsesInOrderWhatIsPreparedAtOnce) {
  std::vector<std::size_t> expected(500), used;
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  std::atomic<int> using_now{0};
  run_pipeline(
      expected.size(), [](std::size_t i) { return 3 * i; },
      [&](std::size_t i, std::size_t prepared) {
        EXPECT_EQ(using_now++, 0) << "one at a time";
        EXPECT_EQ(prepared, 3 * i);
        used.push_back(i);
        --using_now;
        return true;
      });
  EXPECT_EQ(used, expected);
  run_pipeline(
      0, [](std::size_t i) { return i; }, [](std::size_t, std::size_t) { return false; });
}

TEST(RunPipeline, UsesNothingAfterWhatEndsIt) {
  std::atomic<std::size_t> num_prepared{0};
  std::size_t num_used = 0;
  run_pipeline(
      100'000,
      [&](std::size_t i) {
        ++num_prepared;
        return i;
      },
      [&](std::size_t i, std::size_t) {
        ++num_used;
        return i < 9;
      });
  EXPECT_EQ(num_used, 10U);
  EXPECT_LT(num_prepared, 1000U) << "few before their turn";
}

}  // namespace
}  // namespace trivet::engine
