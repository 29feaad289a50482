/// The documented HAProxy configuration in front of two replicas: the client's view when one of
/// them ends or dies.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <regex>
#include <thread>

#include "apps/program.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/service.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::Answer;
using test::ask;
using test::Service;

class HaProxy : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(TRIVET_HAPROXY).empty()) GTEST_SKIP() << "no haproxy";
    const auto run = [&](const std::vector<std::string>& arguments) {
      const test::Outcome outcome =
          test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
      ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    };
    run({"scan", "--parts", "2", "-o", "scans", "--scenes", "1", "--instances", "3", "--sensor",
         "laser"});
    run({"train", "scans/manifest.json", "--methods", "ppf", "-o", "l.h5"});
    const nlohmann::json camera = nlohmann::json::parse(
        test::read_bytes(folder_ / "scans/manifest.json"))["scenes"][0]["camera"];
    std::string numbers;
    for (const char* const key : {"fx", "fy", "cx", "cy", "depth_scale"})
      numbers += (numbers.empty() ? "" : ",") + camera[key].dump();
    query_ = "/v1/recognize?method=ppf&format=png&camera=" + numbers;
    scan_ = test::read_bytes(folder_ / "scans/test/000001/depth/000000.png");
    a_ = serve(0);
    b_ = serve(0);

    // The documented file with free ports, and timeouts for a busy machine.
    port_ = test::free_port();
    std::string text = test::read_bytes(TRIVET_SOURCES "/docs/deploy/haproxy.cfg");
    const auto replace = [&](const std::string& what, const std::string& by) {
      const std::size_t at = text.find(what);
      ASSERT_NE(at, std::string::npos) << what;
      text.replace(at, what.size(), by);
    };
    replace("127.0.0.1:8080", fmt::format("127.0.0.1:{}", port_));
    replace("127.0.0.1:8081", a_->address());
    replace("127.0.0.1:8082", b_->address());
    replace("timeout server 15s", "timeout server 300s");
    folder_.write("haproxy.cfg", text);
    proxy_ = std::make_unique<test::Background>(
        TRIVET_HAPROXY, std::vector<std::string>{"-db", "-f", "haproxy.cfg"}, folder_.path(),
        [&](const std::string&) { return test::Connection(port_).is_open(); });
    ASSERT_TRUE(test::comes([&] { return ask(port_, "GET", "/v2/health/ready").status == 200; }));
  }

  std::unique_ptr<Service> serve(int port) {
    return std::make_unique<Service>(
        std::vector<std::string>{"serve", "l.h5", "--parallel", "1", "--deadline-ms", "300000",
                                 "--drain-grace-ms", "2000", "--exit-timeout-ms", "300000"},
        folder_.path(), port);
  }
  Answer recognize() { return ask(port_, "POST", query_, scan_); }

  /// The number of recognitions that a replica has waiting and running.
  static int num_accepted(int port) {
    const std::string metrics = ask(port, "GET", "/metrics").body;
    int sum = 0;
    for (const char* const name : {"queue_depth", "inflight"}) {
      std::smatch found;
      if (std::regex_search(metrics, found, std::regex(fmt::format("\ntrivet_{} ([0-9]+)", name))))
        sum += std::stoi(found[1]);
    }
    return sum;
  }

  /// The responses to concurrent requests, after `meanwhile` has been called.
  std::vector<Answer> recognize_at_once(std::size_t n, const std::function<void()>& meanwhile) {
    std::vector<Answer> answers(n);
    std::vector<std::thread> clients;
    for (Answer& answer : answers) clients.emplace_back([&] { answer = recognize(); });
    meanwhile();
    for (std::thread& client : clients) client.join();
    return answers;
  }

  const test::TempDir folder_;
  std::string query_, scan_;
  int port_ = 0;
  std::unique_ptr<Service> a_, b_;
  std::unique_ptr<test::Background> proxy_;
};

TEST_F(HaProxy, LosesNothingWhenAReplicaEnds) {
  std::atomic<bool> stop{false};
  std::atomic<int> num_answered{0}, num_failed{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 4; ++i) {
    clients.emplace_back([&] {
      while (!stop) ++(recognize().status == 200 ? num_answered : num_failed);
    });
  }
  EXPECT_TRUE(test::comes([&] { return num_accepted(a_->port()) > 0 && num_answered > 0; }));
  const test::Outcome ended = a_->process().end();
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_NE(ended.error.find("every request was answered"), std::string::npos) << ended.error;
  const int then = num_answered;
  EXPECT_TRUE(test::comes([&] { return num_answered > then + 4; })) << "the other one answers";
  stop = true;
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(num_failed, 0) << "of " << num_answered + num_failed;
}

TEST_F(HaProxy, LosesOnlyWhatADyingReplicaWorkedOn) {
  int num_lost = 0;
  const std::vector<Answer> answers = recognize_at_once(8, [&] {
    EXPECT_TRUE(test::comes([&] {
      return num_accepted(a_->port()) + num_accepted(b_->port()) >= 6 &&
             num_accepted(a_->port()) > 1;
    }));
    a_->process().signal(SIGSTOP);  // so that its queue does not change
    num_lost = 8 - num_accepted(b_->port());
    a_->process().signal(SIGKILL);
    a_->process().wait();
  });
  int num_failed = 0;
  for (const Answer& answer : answers) num_failed += answer.status == 200 ? 0 : 1;
  EXPECT_GT(num_failed, 0);
  EXPECT_LE(num_failed, num_lost);
  // The requests are concurrent: those that cannot reach the dead replica go to the other.
  for (const Answer& answer : recognize_at_once(4, [] {})) EXPECT_EQ(answer.status, 200);

  a_ = serve(a_->port());
  EXPECT_TRUE(test::comes([&] {
    EXPECT_EQ(recognize().status, 200);
    return std::regex_search(ask(a_->port(), "GET", "/metrics").body,
                             std::regex("route=\"recognize\",code=\"200\"} [1-9]"));
  })) << "asked again once it is ready";
}

TEST_F(HaProxy, PassesOnRefusalsAndRequestIds) {
  const Answer given = ask(port_, "GET", "/v1/models", "", "X-Request-Id: call-7\r\n");
  EXPECT_NE(given.head.find("call-7"), std::string::npos) << given.head;
  EXPECT_EQ(ask(port_, "POST", query_ + "&min-score=7", scan_).status, 400);
  EXPECT_EQ(ask(port_, "POST", query_, scan_, "X-Deadline-Ms: 1\r\n").status, 504);
}

TEST_F(HaProxy, PassesOnWhatClientsNeedAndNothingElse) {
  for (const char* const target :
       {"/v1/models", "/v1/openapi.json", "/v1/score-parts", "/v1/words", "/v1/examples",
        "/v1/live", "/v1/parts", "/v1/session", "/v2", "/v2/health/live", "/v2/health/ready",
        "/v2/models/l", "/v2/models/l/ready", "/v2/models/l/versions/1/config",
        "/v2/models/stats"}) {
    EXPECT_EQ(ask(port_, "GET", target).status, 200) << target;
  }
  const auto models = ask(port_, "GET", "/v1/models").json()["models"];
  EXPECT_EQ(ask(port_, "GET", models[0]["mesh"]).status, 200);
  EXPECT_EQ(ask(port_, "GET", models[0]["thumbnail"]).status, 200);
  EXPECT_EQ(ask(port_, "POST", "/v2/repository/index").status, 200);
  EXPECT_EQ(ask(port_, "POST", "/v1/robot-poses", "[]").status, 400) << "the service refuses it";
  EXPECT_EQ(ask(port_, "POST", query_, scan_).status, 200);
  EXPECT_EQ(ask(port_, "POST", "http://localhost" + query_, scan_).status, 200);
  const std::string page = "Origin: http://localhost\r\nX-Trivet: page\r\n";
  EXPECT_EQ(ask(port_, "POST", query_, scan_, page).status, 200) << "its own page";
  EXPECT_EQ(ask(port_, "POST", query_, scan_, "Origin: http://evil.example\r\n").status, 403);

  // A path in another spelling is either off the list or refused by the service.
  const auto count = [&] {
    int sum = 0;
    for (const int replica : {a_->port(), b_->port()}) {
      const std::string metrics = ask(replica, "GET", "/metrics").body;
      const std::regex line(
          "\ntrivet_requests_total\\{route=\"(reload|bring_part|drop_part|"
          "publish_part|remove_model|rename_model)\",code=\"[0-9]+\"\\} ([0-9]+)");
      for (std::sregex_iterator at(metrics.begin(), metrics.end(), line), end; at != end; ++at)
        sum += std::stoi((*at)[2]);
    }
    return sum;
  };
  for (const auto& [method, target] : std::vector<std::pair<std::string, std::string>>{
           {"POST", "/v1/library/reload"},
           {"POST", "/v1/library/reloa%64"},
           {"POST", "/v1/library/%72eload"},
           {"POST", "/v1/library%2freload"},
           {"POST", "//v1/library/reload"},
           {"POST", "/v1//library/reload"},
           {"POST", "/v1/./library/reload"},
           {"POST", "/v1/models/../library/reload"},
           {"POST", "/v1/models/%2e%2e/library/reload"},
           {"POST", "/v1/recognize/../library/reload"},
           {"POST", "/v1/recognize%2f..%2flibrary%2freload"},
           {"POST", "/v2/models/../../v1/library/reload/infer"},
           {"POST", "/v2/models/%2e%2e/infer"},
           {"POST", "/v1/library/reload?/v1/recognize"},
           {"POST", "/v1/library/reload/"},
           {"POST", "http://localhost/v1/library/reload"},
           {"POST", "HTTP://localhost//v1/library/reloa%64"},
           {"post", "/v1/library/reload"},
           {"Post", "/v1/recognize"},
           {"GET", "/metrics"},
           {"GET", "/metric%73"},
           {"GET", "//metrics"},
           {"GET", "/v1/models/../../metrics"},
           {"GET", "/v1/models/%2e%2e/mesh.ply"},
           {"GET", "/v1/session/archive"},
           {"GET", "/v1/session/scans/a"},
           {"GET", "/v1/parts/a/mesh.ply"},
           {"PUT", "/v1/parts/a?file=a.ply&unit=m"},
           {"PUT", "/v1/part%73/a?file=a.ply&unit=m"},
           {"DELETE", "/v1/parts/a"},
           {"PUT", "/v1/models/a"},
           {"PATCH", "/v1/models/a?name=b"},
           {"DELETE", "/v1/models/" + models[0]["name"].get<std::string>()},
           {"DELETE", "/v1/models/a/mesh.ply"},
           {"Delete", "/v1/models/a"},
           {"PUT", "/v1/session/scans/a"},
           {"OPTIONS", "/v1/recognize"},
           {"TRACE", "/v1/models"}}) {
    const int status = ask(port_, method, target).status;
    EXPECT_TRUE(status == 404 || status == 400 || status == 403)
        << method << " " << target << ": " << status;
  }
  EXPECT_EQ(count(), 0) << "of what operators may do";
  EXPECT_EQ(ask(port_, "GET", "/v1/models").json()["models"].size(), models.size());
}

}  // namespace
}  // namespace trivet
