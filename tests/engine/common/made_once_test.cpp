#include "engine/common/made_once.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <new>
#include <stdexcept>

#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

TEST(MadeOnce, IsMadeOnceHoweverManyAsk) {
  MadeOnce<int> value;
  std::atomic<int> num_made{0};
  tbb::parallel_for(0, 1000, [&](int) {
    EXPECT_EQ(value.get([&] {
      std::atomic<int> sum{0};
      for_each_index(100, [&](std::size_t i) { sum += static_cast<int>(i); });
      ++num_made;
      return sum.load();
    }),
              4950);
  });
  EXPECT_EQ(num_made, 1);
}

TEST(MadeOnce, IsMadeAgainWhereMakingThrew) {
  for (int round = 0; round < 200; ++round) {
    MadeOnce<int> value;
    std::atomic<int> num_tried{0}, num_thrown{0};
    tbb::parallel_for(0, 64, [&](int) {
      try {
        EXPECT_EQ(value.get([&] {
          for_each_index(64, [](std::size_t) {});
          if (num_tried++ < 3) throw std::bad_alloc();
          return 7;
        }),
                  7);
      } catch (const std::bad_alloc&) {
        ++num_thrown;
      }
    });
    EXPECT_EQ(num_thrown, 3) << "those who only waited make it again";
    EXPECT_EQ(num_tried, 4);
    EXPECT_EQ(value.get([]() -> int { throw std::logic_error("it is there"); }), 7);
  }
}

}  // namespace
}  // namespace trivet::engine
