/// A service in which one allocation fails: each in turn, in any thread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "apps/service/common/request_log.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/serve/library/library_slot.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/common/wait_for_memory.hpp"
#include "support/allocations.hpp"

namespace trivet {
namespace {

using namespace apps::service;

class FailingAllocation : public test::ServeFixture {};

/// Tests every n-th allocation, unless TRIVET_ALL_ALLOCATIONS requests all from a number on; those
/// are some thousands, and take minutes.
TEST_F(FailingAllocation, FailsAJobAtMost) {
  test::spare_allocations();  // allocations of the client do not count
  const char* const tries_all = std::getenv("TRIVET_ALL_ALLOCATIONS");
  const std::int64_t first_n = tries_all ? std::max(1L, std::atol(tries_all)) : 1;
  RequestLog log(-1);
  Metrics metrics;
  const LibraryFiles files{(folder_ / "l.h5").string(), {}};
  auto first = load_generation(files, 1);
  ASSERT_TRUE(first) << first.error().message;
  RecognitionService service({.num_parallel = 2, .on_thread_start = wait_for_memory_on_this_thread},
                             *first);
  ServiceRoutes routes(service, metrics, log,
                       {std::chrono::milliseconds(60'000), 512 << 20, std::size_t{4} << 30U}, {});
  Result<HttpServer> server = HttpServer::start(
      "127.0.0.1", 0, {},
      {[&](HttpRequest request, HttpAnswer answer) {
         routes.handle(std::move(request), std::move(answer));
       },
       [&](std::string_view target, std::size_t n) { return routes.admit(target, n); }});
  ASSERT_TRUE(server) << server.error().message;
  const std::string scan = test::read_bytes(depth_);
  const auto ask = [&] { return test::ask(server->port(), "POST", query_, scan); };
  const auto detections = [](const test::Answer& answer) {
    nlohmann::json json = nlohmann::json::parse(answer.body);
    return json["scenes"][0]["detections"];
  };
  const test::Answer good = ask();
  ASSERT_EQ(good.status, 200) << good.body;
  ASSERT_GT(detections(good).size(), 0U) << "a job that comes to its last stage";

  int num_tried = 0, num_failed = 0;
  for (std::int64_t n = first_n;; n += tries_all ? 1 : std::max<std::int64_t>(1, n / 2)) {
    // As after a start: cached data is made again.
    auto next = load_generation(files, static_cast<std::uint64_t>(n));
    ASSERT_TRUE(next) << next.error().message;
    service.publish(*next);
    test::fail_allocation(n);
    const test::Answer answer = ask();
    const bool has_failed = test::has_failed_allocation();
    test::fail_allocation(0);
    if (!has_failed) break;
    ++num_tried;
    if (answer.status == 200) {
      EXPECT_EQ(detections(answer), detections(good)) << "allocation " << n;
      continue;
    }
    ++num_failed;
    EXPECT_EQ(answer.status, 503) << "allocation " << n << ": " << answer.body;
    EXPECT_NE(answer.body.find("memory"), std::string::npos) << n << ": " << answer.body;
    const test::Answer after = ask();
    ASSERT_EQ(after.status, 200) << "after allocation " << n << ": " << after.body;
    ASSERT_EQ(detections(after), detections(good)) << "after allocation " << n;
  }
  EXPECT_GT(num_failed, 3) << num_tried;
  RecordProperty("tried", num_tried);
  RecordProperty("failed", num_failed);
  EXPECT_TRUE(service.drain(ServiceClock::now() + std::chrono::seconds(60)));
}

}  // namespace
}  // namespace trivet
