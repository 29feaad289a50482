/// The router as its clients meet it: one library out of several, and what it says when some of
/// them do not answer.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "apps/program.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/service.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test::Answer;
using test::ask;
using test::comes;
using test::read_bytes;
using test::Service;

std::string response(int status, const std::string& body) {
  return fmt::format("HTTP/1.1 {} X\r\nContent-Length: {}\r\n\r\n{}", status, body.size(), body);
}

/// A shard that is ready, holds one model, and answers recognitions as the test wants.
class FakeShard {
 public:
  /// Gives all bytes of an answer; none: it never answers. A connection ends after an answer.
  using Recognize = std::function<std::optional<std::string>()>;
  explicit FakeShard(Recognize recognize, std::string model = "fake")
      : recognize_(std::move(recognize)), model_(std::move(model)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof where;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&where), size), 0);
    EXPECT_EQ(::listen(listener_, 16), 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&where), &size);
    port_ = ntohs(where.sin_port);
    thread_ = std::thread([this] { accept(); });
  }
  FakeShard(const FakeShard&) = delete;
  FakeShard& operator=(const FakeShard&) = delete;
  ~FakeShard() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    for (std::thread& client : clients_) client.join();
    ::close(listener_);
  }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  int num_asked() const { return num_asked_; }
  int num_gone() const { return num_gone_; }  ///< clients that left without an answer

 private:
  void accept() {
    for (int client = 0; (client = ::accept(listener_, nullptr, nullptr)) >= 0;)
      clients_.emplace_back([this, client] { serve(client); });
  }

  void serve(int client) {
    const timeval patience{30, 0};
    ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::string head;
    char part[65536];
    while (head.find("\r\n\r\n") == std::string::npos) {
      const ssize_t n = ::recv(client, part, sizeof part, 0);
      if (n <= 0) break;
      head.append(part, static_cast<std::size_t>(n));
    }
    std::optional<std::string> answer;
    if (head.starts_with("GET /v2/health/ready")) {
      answer = response(200, R"({"ready":true})");
    } else if (head.starts_with("GET /v1/models")) {
      answer =
          response(200, Json{{"unit", "m"}, {"models", Json::array({{{"name", model_}}})}}.dump());
    } else if (head.starts_with("POST")) {
      ++num_asked_;
      answer = recognize_();
    }
    if (answer) {
      ::send(client, answer->data(), answer->size(), MSG_NOSIGNAL);
      ::shutdown(client, SHUT_WR);
    }
    ssize_t n = 0;
    while ((n = ::recv(client, part, sizeof part, 0)) > 0) {
    }
    if (!answer && n == 0 && head.starts_with("POST")) ++num_gone_;
    ::close(client);
  }

  Recognize recognize_;
  std::string model_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<int> num_asked_{0}, num_gone_{0};
  std::vector<std::thread> clients_;  // of the accepting thread, until it ends
  std::thread thread_;
};

/// Whether two detections are of one model in one place, to 5 mm.
bool is_of_one_object(const Json& a, const Json& b) {
  double squares = 0;
  for (int row = 0; row < 3; ++row) {
    const double apart =
        a["T_scene_model"][row][3].get<double>() - b["T_scene_model"][row][3].get<double>();
    squares += apart * apart;
  }
  return a["model"] == b["model"] && squares < 0.005 * 0.005;
}

/// A library of four parts, its halves, and a scan, made once for all tests here.
class Route : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    run({"scan", "--parts", "4", "-o", "scans", "--scenes", "2", "--instances", "8", "--sensor",
         "laser"});
    run({"train", "scans/manifest.json", "-o", "l.h5"});
    run({"library", "split", "l.h5", "-n", "2", "-o", "."});
    const Json camera =
        Json::parse(read_bytes(*folder_ / "scans/manifest.json"))["scenes"][0]["camera"];
    std::string numbers;
    for (const char* const key : {"fx", "fy", "cx", "cy", "depth_scale"})
      numbers += (numbers.empty() ? "" : ",") + camera[key].dump();
    query_ = "/v1/recognize?format=png&camera=" + numbers;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static test::Outcome run(const std::vector<std::string>& arguments) {
    const test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder_->path(), .environment = {}, .watch = {}});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome;
  }
  static std::string scan(int k) {
    return read_bytes(folder_->path() / fmt::format("scans/test/000001/depth/{:06}.png", k));
  }

  static std::unique_ptr<Service> serve(const std::string& library, int port = 0) {
    return std::make_unique<Service>(
        std::vector<std::string>{"serve", library, "--exit-timeout-ms", "600000"}, folder_->path(),
        port);
  }
  /// A router, once all its shards have been looked at and `is_ready` is what it says.
  static std::unique_ptr<Service> route(const std::vector<std::string>& shards,
                                        bool is_ready = true) {
    // Time for a machine that does other things.
    std::vector<std::string> arguments{"route", "--deadline-ms", "600000", "--exit-timeout-ms",
                                       "600000"};
    arguments.insert(arguments.end(), shards.begin(), shards.end());
    auto router = std::make_unique<Service>(arguments, folder_->path());
    EXPECT_TRUE(comes([&] {
      const Answer answer = ask(router->port(), "GET", "/v2/health/ready");
      return answer.status == (is_ready ? 200 : 503) &&
             answer.body.find("not looked at yet") == std::string::npos;
    })) << ask(router->port(), "GET", "/v2/health/ready").body;
    return router;
  }
  static Json missing(const Answer& answer) { return answer.json()["missing"]; }

  static inline std::unique_ptr<test::TempDir> folder_;
  static inline std::string query_;
};

Json without_scores(Json detections) {
  for (Json& detection : detections) detection.erase("score");
  return detections;
}

TEST_F(Route, AnswersAsTheWholeLibrary) {
  const auto whole = serve("l.h5"), first = serve("l-1.h5"), second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  const std::string trace = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
  // A second round searches what no sure detection explains, and a shard knows its own only: there
  // the same objects are found, in poses that differ a little.
  for (const bool is_one_round : {true, false}) {
    for (int k = 0; k < 2; ++k) {
      const std::string query = query_ + (is_one_round ? "&rounds=1&method=ppf&min-score=0.5" : "");
      const Answer expected = ask(whole->port(), "POST", query, scan(k));
      const Answer answer = ask(router->port(), "POST", query, scan(k),
                                "X-Request-Id: call-7\r\ntraceparent: " + trace + "\r\n");
      ASSERT_EQ(answer.status, 200) << answer.body;
      EXPECT_EQ(answer.json()["request_id"], "call-7");
      EXPECT_NE(answer.head.find(trace), std::string::npos) << answer.head;
      EXPECT_EQ(answer.json()["partial"], false) << answer.body;
      EXPECT_EQ(answer.json()["libraries"].size(), 2U);
      const Json scene = answer.json()["scenes"][0];
      EXPECT_FALSE(scene.contains("claims"));
      const Json detections = expected.json()["scenes"][0]["detections"];
      ASSERT_EQ(scene["detections"].size(), detections.size());
      EXPECT_GE(detections.size(), 4U);
      if (is_one_round) {
        EXPECT_EQ(without_scores(scene["detections"]).dump(1), without_scores(detections).dump(1));
        // Doubtful answers lower the others of their model; a shard has some that the models of
        // other shards would explain.
        for (std::size_t d = 0; d < detections.size(); ++d)
          EXPECT_NEAR(scene["detections"][d]["score"], detections[d]["score"], 1e-3);
      }
      for (const Json& detection : detections) {
        EXPECT_TRUE(std::ranges::any_of(scene["detections"], [&](const Json& other) {
          return is_of_one_object(detection, other);
        })) << detection.dump(1);
      }
    }
  }
  EXPECT_EQ(ask(router->port(), "GET", "/v1/models").json()["models"].size(), 4U);
  EXPECT_EQ(ask(router->port(), "GET", "/v2/health/live").status, 200);
  const std::string metrics = ask(router->port(), "GET", "/metrics").body;
  for (const std::string& line :
       {fmt::format("trivet_shard_requests_total{{shard=\"{}\",outcome=\"broken\"}} 0",
                    first->address()),
        std::string("trivet_requests_total{route=\"recognize\",code=\"504\"} 0"),
        std::string("process_open_fds "),
        std::string("trivet_requests_total{route=\"recognize\",code=\"200\"} 4"),
        fmt::format("trivet_shard_requests_total{{shard=\"{}\",outcome=\"answered\"}} 4",
                    first->address()),
        fmt::format("trivet_shard_ready{{shard=\"{}\"}} 1", second->address()),
        std::string("trivet_inflight 0")}) {
    EXPECT_NE(metrics.find(line), std::string::npos) << line << " in\n" << metrics;
  }
}

TEST_F(Route, AsksModelsOfTheShardThatHoldsThem) {
  const auto first = serve("l-1.h5");
  FakeShard second([] { return response(200, "{}"); });
  const auto router = route({first->address(), second.address()});
  const std::string name =
      ask(first->port(), "GET", "/v1/models").json()["models"][0]["name"].get<std::string>();
  const Answer one = ask(router->port(), "POST", query_ + "&models=" + name, scan(0));
  EXPECT_EQ(one.status, 200) << one.body;
  EXPECT_EQ(one.json()["partial"], false) << one.body;
  const Json all = one.json();
  for (const Json& detection : all["scenes"][0]["detections"]) EXPECT_EQ(detection["model"], name);
  EXPECT_EQ(second.num_asked(), 0);
  const Answer none = ask(router->port(), "POST", query_ + "&models=spoon", scan(0));
  EXPECT_EQ(none.status, 400);
  EXPECT_NE(none.body.find("spoon"), std::string::npos) << none.body;
}

TEST_F(Route, TellsTheRejectedPosesOfAllShards) {
  const auto first = serve("l-1.h5"), second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  const std::string query = query_ + "&method=ppf&rejected=2";
  std::size_t num_rejected = 0;
  for (const int port : {first->port(), second->port()})
    num_rejected += ask(port, "POST", query, scan(0)).json()["scenes"][0]["rejected"].size();
  EXPECT_GT(num_rejected, 0U);
  const Json scene = ask(router->port(), "POST", query, scan(0)).json()["scenes"][0];
  EXPECT_EQ(scene["rejected"].size(), num_rejected);
  for (const Json& pose : scene["rejected"]) {
    if (pose["explained_by"].is_null()) continue;
    const auto by = pose["explained_by"].get<std::size_t>();
    ASSERT_LT(by, scene["detections"].size());
    EXPECT_EQ(scene["detections"][by]["model"].is_string(), true);
  }
}

TEST_F(Route, TakesFormsButNoModelsInThem) {
  const auto first = serve("l-1.h5"), second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  const std::string options = query_.substr(query_.find("camera="));
  const auto form = [&](const std::string& json_options) {
    std::string body;
    for (int k = 0; k < 2; ++k) {
      body += fmt::format(
                  "--cut\r\nContent-Disposition: form-data; name=\"scene\"; "
                  "filename=\"{}.png\"\r\n\r\n",
                  k) +
              scan(k) + "\r\n";
    }
    body += "--cut\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n" + json_options +
            "\r\n--cut--\r\n";
    return ask(router->port(), "POST", "/v1/recognize?method=ppf&" + options, body,
               "Content-Type: multipart/form-data; boundary=cut\r\n");
  };
  const Answer two = form("{}");
  ASSERT_EQ(two.status, 200) << two.body;
  ASSERT_EQ(two.json()["scenes"].size(), 2U);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(two.json()["scenes"][k]["detections"],
              ask(router->port(), "POST", query_ + "&method=ppf", scan(k))
                  .json()["scenes"][0]["detections"]);
  }
  const Answer refused = form(R"({"models":["a"]})");
  EXPECT_EQ(refused.status, 400);
  EXPECT_NE(refused.body.find("models"), std::string::npos) << refused.body;
}

TEST_F(Route, PassesOnWhatAllShardsRefuse) {
  const auto first = serve("l-1.h5"), second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  const auto refuses = [&](int status, const std::string& reason, const std::string& target,
                           const std::string& headers = "") {
    const Answer answer = ask(router->port(), "POST", target, scan(0), headers);
    EXPECT_EQ(answer.status, status) << answer.body;
    EXPECT_NE(answer.body.find(reason), std::string::npos) << answer.body;
  };
  refuses(400, "0 to 1", query_ + "&min-score=7");
  refuses(400, "format", "/v1/recognize");
  refuses(400, "body.ply", "/v1/recognize?format=ply");
  refuses(400, "claims", query_ + "&claims=true");
  refuses(400, "hexadecimal", query_ + "&models=%zz");
  refuses(400, "X-Deadline-Ms", query_, "X-Deadline-Ms: soon\r\n");
  refuses(504, "deadline", query_, "X-Deadline-Ms: 2\r\n");
  refuses(404, "no such path", "/v1/library/reload");
  EXPECT_EQ(ask(router->port(), "GET", query_).status, 405);
  EXPECT_EQ(ask(router->port(), "POST", query_, scan(0)).status, 200);
}

TEST_F(Route, SaysWhatADeadShardDoesNotAnswer) {
  const auto first = serve("l-1.h5");
  auto second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  const int port = second->port();
  second->process().signal(SIGKILL);
  second->process().wait();
  // Until the router has noticed, the connection breaks; later it does not ask.
  for (const char* const reason : {"", "refused"}) {
    EXPECT_TRUE(comes([&] {
      return ask(router->port(), "GET", "/v2/health/ready").body.find(reason) != std::string::npos;
    }));
    const Answer answer = ask(router->port(), "POST", query_, scan(0));
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.json()["partial"], true);
    ASSERT_EQ(missing(answer).size(), 1U) << answer.body;
    EXPECT_EQ(missing(answer)[0]["shard"], second->address());
    EXPECT_NE(missing(answer)[0]["reason"], "");
  }
  EXPECT_EQ(ask(router->port(), "GET", "/v2/health/ready").status, 503);
  EXPECT_EQ(ask(router->port(), "GET", "/v2/health/live").status, 200);
  second = serve("l-2.h5", port);
  EXPECT_TRUE(comes([&] { return ask(router->port(), "GET", "/v2/health/ready").status == 200; }));
  EXPECT_EQ(ask(router->port(), "POST", query_, scan(0)).json()["partial"], false);

  first->process().end();
  second->process().end();
  const Answer none = ask(router->port(), "POST", query_, scan(0));
  EXPECT_EQ(none.status, 503);
  EXPECT_EQ(missing(none).size(), 2U) << none.body;
  EXPECT_NE(none.head.find("Retry-After"), std::string::npos);
}

TEST_F(Route, AnswersByTheDeadlineWithoutASlowShard) {
  const auto first = serve("l-1.h5");
  FakeShard slow([] { return std::nullopt; });
  const auto router = route({first->address(), slow.address()});
  // Without rounds nothing is searched, which takes no time.
  const Answer answer =
      ask(router->port(), "POST", query_ + "&rounds=0", scan(0), "X-Deadline-Ms: 5000\r\n");
  EXPECT_EQ(answer.status, 200) << answer.body;
  ASSERT_EQ(missing(answer).size(), 1U) << answer.body;
  EXPECT_EQ(missing(answer)[0]["shard"], slow.address());
  EXPECT_NE(missing(answer)[0]["reason"].get<std::string>().find("deadline"), std::string::npos);
  EXPECT_TRUE(comes([&] { return slow.num_gone() == 1; })) << "it need not work on";
  const auto alone = route({slow.address()});
  EXPECT_EQ(ask(alone->port(), "POST", query_, scan(0), "X-Deadline-Ms: 300\r\n").status, 504);
}

TEST_F(Route, RefusesAtOnceWhatAShardHasNoRoomFor) {
  FakeShard slow([] { return std::nullopt; });
  FakeShard full([] { return "HTTP/1.1 503 X\r\nRetry-After: 1\r\nContent-Length: 0\r\n\r\n"; },
                 "other");
  const auto router = route({slow.address(), full.address()});
  const Answer answer = ask(router->port(), "POST", query_, scan(0));
  EXPECT_EQ(answer.status, 503) << answer.body;
  EXPECT_NE(answer.head.find("Retry-After"), std::string::npos);
  EXPECT_TRUE(comes([&] { return slow.num_gone() == 1; })) << "nobody would take its part alone";
}

TEST_F(Route, TakesNoRubbishForAnAnswer) {
  const auto first = serve("l-1.h5");
  const std::string query = query_ + "&method=ppf&rounds=1";
  const Answer good = ask(first->port(), "POST", query + "&claims=true", scan(0));
  ASSERT_EQ(good.status, 200) << good.body;
  const auto changed = [&](const std::string& pointer, const Json& value) {
    Json body = good.json();
    body[Json::json_pointer(pointer)] = value;
    return response(200, body.dump());
  };
  std::string rubbish;
  FakeShard second([&] { return rubbish; });
  const auto router = route({first->address(), second.address()});
  const Json detections =
      ask(first->port(), "POST", query, scan(0)).json()["scenes"][0]["detections"];
  for (const auto& [answer, reason] : std::vector<std::pair<std::string, std::string>>{
           {"\x01\x02 not http\r\n\r\n", ""},
           {"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\n{", ""},
           {"", ""},
           {response(200, "{}"), "library"},
           {response(200, std::string(100'000, '[')), "32 levels"},
           {response(200, ask(first->port(), "POST", query, scan(0)).body), "claims"},
           {response(500, R"({"error":"it broke"})"), "it broke"},
           {response(418, "tea"), "418"},
           {changed("/scenes/0/claims/images", Json{{1, 1}}), "from 0 to 0"},
           {changed("/scenes/0/claims/poses/0/runs", Json{0, 4e9}), "whole number"},
           {changed("/scenes/0/claims/poses/0/detection", 1000), "detection"},
           {changed("/scenes/0/claims/poses", Json::array()), "detection 0"},
           {changed("/scenes/0/detections/0/score", "high"), "score"},
           {changed("/scenes", Json::array()), "sizes"}}) {
    rubbish = answer;
    const Answer merged = ask(router->port(), "POST", query, scan(0));
    EXPECT_EQ(merged.status, 200) << merged.body;
    ASSERT_EQ(missing(merged).size(), 1U) << merged.body;
    const std::string told = missing(merged)[0]["reason"];
    EXPECT_FALSE(told.empty());
    EXPECT_NE(told.find(reason), std::string::npos) << told;
    EXPECT_EQ(merged.json()["scenes"][0]["detections"], detections);
  }
}

TEST_F(Route, IsNotReadyWhenTwoShardsHoldOneModel) {
  const auto first = serve("l-1.h5"), whole = serve("l.h5");
  const auto router = route({first->address(), whole->address()}, false);
  EXPECT_TRUE(comes([&] {
    return ask(router->port(), "GET", "/v2/health/ready").body.find("in one shard") !=
           std::string::npos;
  })) << ask(router->port(), "GET", "/v2/health/ready").body;
  const Answer answer = ask(router->port(), "POST", query_, scan(0));
  EXPECT_EQ(answer.status, 503);
  EXPECT_NE(answer.body.find(whole->address()), std::string::npos) << answer.body;
}

TEST_F(Route, LeavesShardsWhenItsClientHasGone) {
  FakeShard slow([] { return std::nullopt; });
  const auto router = route({slow.address()});
  {
    const test::Connection client(router->port());
    const std::string body = scan(0);
    client.send("POST " + query_ + " HTTP/1.1\r\nHost: localhost\r\nX-Deadline-Ms: 600000\r\n" +
                "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    EXPECT_TRUE(comes([&] { return slow.num_asked() == 1; }));
  }
  EXPECT_TRUE(comes([&] { return slow.num_gone() == 1; }));
  EXPECT_TRUE(comes([&] {
    const std::string metrics = ask(router->port(), "GET", "/metrics").body;
    return metrics.find("outcome=\"gone\"} 1") != std::string::npos &&
           metrics.find("trivet_inflight 0") != std::string::npos;
  }));
}

TEST_F(Route, AnswersWhatItHasTakenBeforeItEnds) {
  const auto first = serve("l-1.h5"), second = serve("l-2.h5");
  const auto router = route({first->address(), second->address()});
  std::vector<Answer> answers(6);
  std::vector<std::thread> clients;
  for (Answer& answer : answers)
    clients.emplace_back([&] { answer = ask(router->port(), "POST", query_, scan(0)); });
  EXPECT_TRUE(comes([&] {
    return ask(router->port(), "GET", "/metrics").body.find("trivet_inflight 6") !=
           std::string::npos;
  }));
  const test::Outcome outcome = router->process().end();
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const Answer& answer : answers) {
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.json()["partial"], false);
  }
}

TEST_F(Route, IsConfiguredByAFileAndByFlags) {
  const auto check = [&](const std::string& toml, std::vector<std::string> flags) {
    std::ofstream(*folder_ / "route.toml") << toml;
    flags.insert(flags.begin(), {"route", "--config", "route.toml", "--check-config"});
    return test::run_trivet(flags, {.folder = folder_->path(), .environment = {}, .watch = {}});
  };
  const test::Outcome good = check("shards = ['a:1', 'b:2']\nmax-inflight = 8\n", {});
  EXPECT_EQ(good.exit_code, 0) << good.error;
  const test::Outcome bad =
      check("shards = ['a:1', 'b']\nmax-inflights = 8\nmax-body-mb = 600\ndeadline-ms = [3]\n",
            {"--log", "loud"});
  EXPECT_EQ(bad.exit_code, 2);
  for (const char* const fault :
       {"route.toml:1: shards: expected host:port", "found 'max-inflights'",
        "max-body-mb: expected at most max-inflight-mb", "route.toml:4: deadline-ms: expected",
        "--log: expected info or none"}) {
    EXPECT_NE(bad.error.find(fault), std::string::npos) << fault << " in\n" << bad.error;
  }
  // Those of the command line stand in for all of the file.
  EXPECT_EQ(check("shards = ['b']\n", {"c:3", "d:4"}).exit_code, 0);
  EXPECT_EQ(check("shards = []\n", {}).exit_code, 2) << "no shard";
}

TEST_F(Route, SaysAtOnceWhatItCannotRoute) {
  const auto fails = [&](const std::vector<std::string>& arguments, const std::string& reason) {
    const test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder_->path(), .environment = {}, .watch = {}});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
    EXPECT_NE(outcome.error.find(reason), std::string::npos) << outcome.error;
  };
  fails({"route"}, "shards: expected host:port of each");
  fails({"route", "here"}, "host:port");
  fails({"route", "here:0"}, "host:port");
  fails({"route", "here:port"}, "host:port");
  fails({"route", "a:1", "a:1"}, "twice");
  fails({"route", "a:1", "--max-inflight", "0"}, "max-inflight");
  fails({"library", "split", "l.h5", "-n", "5", "-o", "."}, "1 to 4 parts");
}

}  // namespace
}  // namespace trivet
