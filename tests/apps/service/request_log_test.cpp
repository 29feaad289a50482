#include "apps/service/common/request_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <climits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <thread>

namespace trivet::apps::service {
namespace {

TEST(RequestLog, HoldsUpNobodyWhileItsReaderSleeps) {
  constexpr int kNumLines = 20'000;  // exceeds the capacity of the pipe and the log
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  std::optional<RequestLog> log(pipe[1]);
  for (int i = 0; i < kNumLines; ++i)
    log->write("info", "request", {{"line", i}});  // does not block
  log->write("error", std::string(PIPE_BUF, 'x'));
  const std::uint64_t num_dropped = log->num_dropped();
  EXPECT_GT(num_dropped, 1U);

  std::string written;
  std::thread reader([&] {
    std::array<char, 65536> part{};
    for (ssize_t n = 0; (n = ::read(pipe[0], part.data(), part.size())) > 0;)
      written.append(part.data(), static_cast<std::size_t>(n));
  });
  log.reset();  // writes the remaining lines
  ::close(pipe[1]);
  reader.join();
  ::close(pipe[0]);
  std::istringstream lines(written);
  std::uint64_t num_lines = 0;
  int last = -1;
  for (std::string line; std::getline(lines, line); ++num_lines) {
    const nlohmann::json json = nlohmann::json::parse(line);
    EXPECT_EQ(json["level"], "info");
    EXPECT_GT(json["line"].get<int>(), last) << "in order";
    last = json["line"];
  }
  EXPECT_EQ(num_lines + num_dropped, kNumLines + 1U) << "each is written or counted";
}

TEST(RequestLog, EndsInTimeWhileItsReaderSleeps) {
  constexpr int kNumLines = 20'000;
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  std::optional<RequestLog> log(pipe[1]);
  for (int i = 0; i < kNumLines; ++i) log->write("info", "request", {{"line", i}});
  const auto begun = std::chrono::steady_clock::now();
  log.reset();
  const auto elapsed = std::chrono::steady_clock::now() - begun;
  EXPECT_GE(elapsed, std::chrono::milliseconds(900)) << "the reader may wake up yet";
  EXPECT_LT(elapsed, std::chrono::seconds(5)) << "of a machine that does other things, too";
  ::close(pipe[0]);
  ::close(pipe[1]);
}

TEST(RequestLog, OutlivesItsReader) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  ::close(pipe[0]);  // the next writer is ended by SIGPIPE
  std::optional<RequestLog> log(pipe[1]);
  log->write("info", "request");
  for (int i = 0; i < 200 && log->num_dropped() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(log->num_dropped(), 1U);
  log.reset();
  ::close(pipe[1]);
}

}  // namespace
}  // namespace trivet::apps::service
