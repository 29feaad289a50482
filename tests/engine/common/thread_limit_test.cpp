#include "engine/common/thread_limit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

/// The number of threads that share a loop. The items wait, so that every available thread gets
/// one.
std::size_t threads_of_a_loop() {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  for_each_index(64, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  return threads.size();
}

TEST(ThreadLimit, BoundsTheThreadsOfALoopWhileItLives) {
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(threads_of_a_loop(), 1U);
    const ThreadLimit wider(2);
    EXPECT_EQ(threads_of_a_loop(), 1U) << "the narrowest limit holds";
  }
  const ThreadLimit limit(2);
  EXPECT_EQ(threads_of_a_loop(), std::min<std::size_t>(2, std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace trivet::engine
