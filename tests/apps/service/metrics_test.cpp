#include "apps/service/serve/requests/metrics.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <string>
#include <thread>
#include <vector>

namespace trivet::apps::service {
namespace {

TEST(Metrics, CountsOnManyThreadsAtOnce) {
  constexpr int kNumThreads = 4, kNumRequests = 2000;
  Metrics metrics;
  std::vector<std::thread> threads;
  for (int t = 0; t < kNumThreads; ++t) {
    threads.emplace_back([&metrics, t] {
      for (int i = 0; i < kNumRequests; ++i) {
        metrics.count_request(i % 2 == 0 ? "recognize" : "points", 200);
        metrics.observe_stage("vote", 0.125 * t);  // sums of these are exact
        if (i % 100 == 0) metrics.response({});
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::string text = "\n" + metrics.response({}).body;
  for (const char* const line :
       {"trivet_requests_total{route=\"points\",code=\"200\"} 4000\n",
        "trivet_requests_total{route=\"recognize\",code=\"200\"} 4000\n",
        "trivet_stage_duration_seconds_bucket{stage=\"vote\",le=\"0.1\"} 2000\n",
        "trivet_stage_duration_seconds_bucket{stage=\"vote\",le=\"0.2\"} 4000\n",
        "trivet_stage_duration_seconds_bucket{stage=\"vote\",le=\"+Inf\"} 8000\n",
        "trivet_stage_duration_seconds_count{stage=\"vote\"} 8000\n",
        "trivet_stage_duration_seconds_sum{stage=\"vote\"} 1500\n"}) {
    EXPECT_NE(text.find("\n" + std::string(line)), std::string::npos) << line << " in" << text;
  }
}

TEST(Metrics, ReportsTheCurrentState) {
  Metrics metrics;
  Metrics::Gauges gauges;
  gauges.library_bytes = 12'345'678'901;
  gauges.generation = 3;
  gauges.dropped_lines = 7;
  const HttpResponse response = metrics.response(gauges);
  EXPECT_EQ(response.content_type, "text/plain; version=0.0.4");
  for (const char* const line :
       {"\n# TYPE trivet_library_bytes gauge\ntrivet_library_bytes 12345678901\n",
        "\ntrivet_library_generation 3\n",
        "\n# TYPE trivet_log_dropped_total counter\ntrivet_log_dropped_total 7\n"}) {
    EXPECT_NE(response.body.find(line), std::string::npos) << line << " in\n" << response.body;
  }
}

TEST(Metrics, DescribesItsProcess) {
  const Metrics metrics;
  const auto value = [&](const std::string& name) {
    const std::string text = metrics.response({}).body;
    const std::size_t at = text.find("\n" + name + " ");
    EXPECT_NE(at, std::string::npos) << name << " in\n" << text;
    return at == std::string::npos ? 0 : std::stod(text.substr(at + name.size() + 2));
  };
  const double spent = value("process_cpu_seconds_total"), open = value("process_open_fds");
  EXPECT_GT(open, 2);
  EXPECT_GE(value("process_max_fds"), open);
  const int file = ::open("/dev/null", O_RDONLY);
  EXPECT_EQ(value("process_open_fds"), open + 1);
  ::close(file);
  // Touched memory is resident, and touching it takes time.
  constexpr std::size_t kBytes = 64 << 20;
  const double resident = value("process_resident_memory_bytes");
  std::vector<char> memory(kBytes);
  volatile char* const touched = memory.data();
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < kBytes; i += 64) touched[i] = static_cast<char>(round);
  }
  EXPECT_GT(value("process_resident_memory_bytes"), resident + 0.9 * kBytes);
  EXPECT_GT(value("process_virtual_memory_bytes"), value("process_resident_memory_bytes"));
  EXPECT_GT(value("process_cpu_seconds_total"), spent);
  const double now = static_cast<double>(std::time(nullptr));
  EXPECT_LE(value("process_start_time_seconds"), now + 1);
  EXPECT_GT(value("process_start_time_seconds"), now - 3600);
}

}  // namespace
}  // namespace trivet::apps::service
