/// A service with a job that never ends and never checks for a stop.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "apps/service/daemon.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using test::Answer;
using test::ask;
using test::Connection;
using test::read_bytes;

class ServeStuck : public test::ServeFixture {};

TEST_F(ServeStuck, AnswersAtTheDeadlineAndEndsInTime) {
  if (std::string(TRIVET_STUCK_INFLATE).empty()) GTEST_SKIP() << "not with sanitizers";
  environment_ = {std::string("LD_PRELOAD=") + TRIVET_STUCK_INFLATE, "STUCK_FROM=stuck"};
  const std::string image = read_bytes(depth_);
  steady_clock::time_point stopped;
  const test::Outcome outcome =
      serve({"--exit-timeout-ms", "500", "--parallel", "1"}, [&](int port) {
        EXPECT_EQ(ask(port, "POST", query_, image).status, 200);
        std::ofstream(folder_ / "stuck") << "";
        const auto begun = steady_clock::now();
        const Answer late = ask(port, "POST", query_, image, "X-Deadline-Ms: 300\r\n");
        const auto seconds = std::chrono::duration<double>(steady_clock::now() - begun).count();
        EXPECT_EQ(late.status, 504) << late.body;
        EXPECT_GE(seconds, 0.3);
        EXPECT_LT(seconds, 5) << "the work goes on for ever";
        // A request that waits for the worker is also answered in time.
        const Answer next = ask(port, "POST", query_, image, "X-Deadline-Ms: 300\r\n");
        EXPECT_TRUE(next.status == 504 || next.status == 503) << "or at once: " << next.body;
        EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
        const Answer metrics = ask(port, "GET", "/metrics");
        EXPECT_NE(metrics.body.find("\ntrivet_inflight 1\n"), std::string::npos) << metrics.body;
        // A pending request is answered when the service receives the signal to end.
        const Connection last(port);
        last.send("POST " + query_ + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                  std::to_string(image.size()) + "\r\n\r\n" + image);
        std::this_thread::sleep_for(milliseconds(20));
        stopped = steady_clock::now();
        request_end();
        EXPECT_NE(last.receive().find(" 503 "), std::string::npos);
      });
  const auto seconds = std::chrono::duration<double>(steady_clock::now() - stopped).count();
  EXPECT_EQ(outcome.exit_code, apps::service::Daemon::kExitUnfinished) << outcome.error;
  EXPECT_LT(seconds, 15) << "0.05 + 0.5 on a machine that has nothing else to do";
  EXPECT_NE(outcome.error.find("some work did not end"), std::string::npos) << outcome.error;
}

}  // namespace
}  // namespace trivet
