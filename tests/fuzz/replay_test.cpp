// Replays the fuzzer's seeds and findings: each input keeps the guarantees of its target.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/targets.hpp"

namespace trivet::fuzz {
namespace {

class Replay : public testing::TestWithParam<Target> {};

TEST_P(Replay, KeepsItsPromisesOnEverySeed) {
  const std::vector<std::string> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  for (std::size_t s = 0; s < seeds.size(); ++s)
    EXPECT_NO_THROW(GetParam().run(seeds[s])) << "seed " << s;
}

TEST_P(Replay, KeepsItsPromisesOnEveryPastFinding) {
  const std::filesystem::path folder =
      std::filesystem::path(TRIVET_TEST_REGRESSIONS) / GetParam().name;
  if (!std::filesystem::exists(folder)) return;  // no findings beyond the seeds yet
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string input(std::istreambuf_iterator<char>(stream), {});
    EXPECT_NO_THROW(GetParam().run(input)) << entry.path();
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Replay, testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace trivet::fuzz
