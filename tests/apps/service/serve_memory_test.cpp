/// Scans are admitted according to the memory that they will need.
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

using test::Answer;
using test::ask;

class ServeMemory : public test::ServeFixture {};

TEST_F(ServeMemory, AdmitsScansByTheMemoryTheyNeed) {
  const std::string image = test::read_bytes(depth_);
  // A file of some kilobytes with 16 million pixels.
  const std::string large =
      test::gzip_file(test::depth_png(4000, 4000, std::vector<std::uint16_t>(16'000'000, 8000)), 1);
  ASSERT_LT(large.size(), 500'000U);
  const test::Outcome outcome = serve({"--memory", "64", "--parallel", "4"}, [&](int port) {
    for (const char* const path : {"/v1/recognize?format=png&", "/v1/points?format=png&"}) {
      const Answer refused = ask(port, "POST", path + parameters_, large);
      EXPECT_EQ(refused.status, 413) << refused.body;
      EXPECT_NE(refused.body.find("--memory"), std::string::npos) << refused.body;
    }
    // Images that fit in memory only one at a time are all answered, one after the other.
    std::vector<Answer> answers(4);
    std::vector<std::thread> clients;
    for (Answer& answer : answers)
      clients.emplace_back([&] { answer = ask(port, "POST", query_, image); });
    for (std::thread& client : clients) client.join();
    for (const Answer& answer : answers) EXPECT_EQ(answer.status, 200) << answer.body;
    const std::string metrics = ask(port, "GET", "/metrics").body;
    EXPECT_NE(metrics.find("trivet_rejected_total{reason=\"too_large\"} 2"), std::string::npos);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet
