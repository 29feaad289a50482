#include "apps/service/serve/workshop/run_child.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace trivet::apps::service {
namespace {

Result<void> shell(const std::string& script, const ChildLimits& limits = {},
                   const std::stop_token& stop = {}) {
  return run_child({"/bin/sh", "-c", script}, limits, stop);
}

TEST(RunChild, ReportsTheLastOutputOfTheProgram) {
  EXPECT_TRUE(shell("echo ignored >&2; exit 0"));
  EXPECT_EQ(shell("echo one >&2; echo two >&2; exit 3").error().message, "two");
  EXPECT_EQ(shell("exit 3").error().message, "training it failed with exit code 3");
  EXPECT_NE(shell("kill -SEGV $$").error().message.find("signal 11"), std::string::npos);
  EXPECT_FALSE(run_child({"/nowhere/program"}, {}, {}));
}

TEST(RunChild, KeepsTheEndOfMuchThatIsSaid) {
  const Result<void> done = shell("yes words | head -n 200000 >&2; echo the end >&2; exit 1");
  EXPECT_EQ(done.error().message, "the end");
}

TEST(RunChild, EndsWhatTakesTooLong) {
  ChildLimits limits;
  limits.time = std::chrono::seconds(1);
  EXPECT_EQ(shell("exec sleep 60", limits).error().message, "took longer than 1 s");
}

TEST(RunChild, EndsWhenItIsStopped) {
  std::stop_source stop;
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop.request_stop();
  });
  EXPECT_EQ(shell("exec sleep 60", {}, stop.get_token()).error().code, ErrorCode::resumable);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RunChild, BoundsMemory) {
  ChildLimits limits;
  limits.memory_bytes = std::size_t{1} << 30;
  EXPECT_EQ(shell("ulimit -v >&2; exit 1", limits).error().message, "1048576");
}
#endif

}  // namespace
}  // namespace trivet::apps::service
