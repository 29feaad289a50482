#include "apps/service/http/http_server.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <memory>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "apps/service/gzip.hpp"
#include "apps/service/http_client.hpp"

namespace trivet::apps::service {
namespace {

using std::chrono::seconds, std::chrono::steady_clock;

/// Responds with the target of the request, a blank, and its body.
Result<HttpServer> start_echo(const HttpLimits& limits = {}) {
  const auto echo = [](const HttpRequest& request, const HttpAnswer& answer) {
    answer({200, request.target + " " + request.body});
  };
  return HttpServer::start("127.0.0.1", 0, limits,
                           {echo, [](auto, auto) { return std::optional<HttpResponse>(); }});
}

/// Header fields of a POST with an encoded body.
std::string coded(const std::string& coding) { return "Content-Encoding: " + coding + "\r\n"; }

std::string in_chunks(const std::string& body, std::size_t size) {
  std::string out;
  for (std::size_t at = 0; at < body.size(); at += size) {
    const std::string chunk = body.substr(at, size);
    out += fmt::format("{:x}\r\n{}\r\n", chunk.size(), chunk);
  }
  return out + "0\r\n\r\n";
}

TEST(HttpServer, AnswersWhoWasConnectedByTheSystemBeforeTheDoorClosed) {
  // A handler that blocks the network thread: no connection is accepted meanwhile, and the clients
  // wait in the system's queue, connected from their side.
  std::promise<void> begun, go_on;
  const auto handle = [&, is_first = true](HttpRequest, const HttpAnswer& answer) mutable {
    if (is_first) {
      begun.set_value();
      go_on.get_future().wait();
    }
    is_first = false;
    answer({200, "done"});
  };
  Result<HttpServer> server = HttpServer::start(
      "127.0.0.1", 0, {}, {handle, [](auto, auto) { return std::optional<HttpResponse>(); }});
  ASSERT_TRUE(server) << server.error().message;
  const std::string request = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";
  std::vector<std::unique_ptr<test::Connection>> clients;
  for (int i = 0; i < 5; ++i) {
    clients.push_back(std::make_unique<test::Connection>(server->port()));
    ASSERT_TRUE(clients.back()->is_open());
    clients.back()->send(request);
    if (i == 0) begun.get_future().wait();
  }
  std::thread closing([&] { server->stop_accepting(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the request to close has arrived
  go_on.set_value();
  closing.join();
  EXPECT_TRUE(server->wait_until_idle(steady_clock::now() + seconds(30)));
  server->stop();
  for (const auto& client : clients) {
    const test::Answer answer = test::parse_answer(client->receive());
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, "done");
  }
  EXPECT_FALSE(test::Connection(server->port()).is_open());
}

TEST(HttpServer, DetectsClosedConnections) {
  std::promise<HttpRequest> asked[3];
  std::vector<HttpAnswer> answers;  // of the network thread until a request is reported
  const auto handle = [&](HttpRequest request, HttpAnswer answer) {
    answers.push_back(std::move(answer));
    asked[answers.size() - 1].set_value(std::move(request));
  };
  Result<HttpServer> server = HttpServer::start(
      "127.0.0.1", 0, {}, {handle, [](auto, auto) { return std::optional<HttpResponse>(); }});
  ASSERT_TRUE(server) << server.error().message;
  std::unique_ptr<test::Connection> clients[3];
  HttpRequest requests[3];
  for (int i = 0; i < 3; ++i) {
    clients[i] = std::make_unique<test::Connection>(server->port());
    clients[i]->send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
    requests[i] = asked[i].get_future().get();
    EXPECT_FALSE(requests[i].is_gone());
  }
  clients[0]->send("GET");  // of the next request
  clients[1].reset();
  clients[2]->abort();
  EXPECT_FALSE(requests[0].is_gone());
  EXPECT_TRUE(requests[1].is_gone()) << "closed";
  EXPECT_TRUE(requests[2].is_gone()) << "reset";
  for (const HttpAnswer& answer : answers) answer({200, "done"});
}

TEST(HttpServer, AcceptsTargetsThatNameTheHost) {
  const Result<HttpServer> server = start_echo();
  ASSERT_TRUE(server) << server.error().message;
  for (const auto& [given, target] : std::vector<std::pair<std::string, std::string>>{
           {"/v1/a?b=c", "/v1/a?b=c"},
           {"http://localhost/v1/a?b=c", "/v1/a?b=c"},
           {"HTTP://other.example:8080/v1/a", "/v1/a"},
           {"https://[::1]:8080/v1/a", "/v1/a"},
           {"http://localhost", "/"},
           {"http://localhost?b=http://x/", "/?b=http://x/"},
           {"/http://localhost/a", "/http://localhost/a"}}) {
    const test::Answer answer = test::ask(server->port(), "GET", given);
    EXPECT_EQ(answer.status, 200) << given;
    EXPECT_EQ(answer.body, target + " ");
  }
  for (const char* const wrong : {"http://", "http:///v1/a", "http://?a=b"}) {
    const test::Answer answer = test::ask(server->port(), "GET", wrong);
    EXPECT_EQ(answer.status, 400) << wrong;
    EXPECT_NE(answer.body.find("host"), std::string::npos) << answer.body;
  }
}

TEST(HttpServer, DatesItsAnswers) {
  const Result<HttpServer> server = start_echo();
  ASSERT_TRUE(server) << server.error().message;
  // RFC 9110, 5.6.7: IMF-fixdate.
  const std::regex form(
      "\r\nDate: (Mon|Tue|Wed|Thu|Fri|Sat|Sun), [0-3][0-9] "
      "(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec) 20[0-9]{2} "
      "[0-2][0-9]:[0-5][0-9]:[0-6][0-9] GMT(\r\n|$)");
  for (const char* const target : {"/", "http://"}) {
    const std::string head = test::ask(server->port(), "GET", target).head;
    EXPECT_TRUE(std::regex_search(head, form)) << head;
  }
}

TEST(HttpServer, UnpacksBodies) {
  const Result<HttpServer> server = start_echo();
  ASSERT_TRUE(server) << server.error().message;
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += fmt::format("{} ", i * i);
  const std::string gzip = test::pack(test::Packing::gzip, text);
  const std::string halves = test::pack(test::Packing::gzip, text.substr(0, 9000)) +
                             test::pack(test::Packing::gzip, text.substr(9000));
  for (const auto& [coding, body] : std::vector<std::pair<std::string, std::string>>{
           {"gzip", gzip},
           {"x-gzip", gzip},
           {"GZip", halves},
           {"deflate", test::pack(test::Packing::zlib, text)},
           {"identity", text}}) {
    const test::Answer answer_to_body = test::ask(server->port(), "POST", "/", body, coded(coding));
    EXPECT_EQ(answer_to_body.status, 200) << coding << ": " << answer_to_body.body.substr(0, 200);
    EXPECT_TRUE(answer_to_body.body == "/ " + text) << coding;
    const test::Connection connection(server->port());
    connection.send("POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n" + coded(coding) +
                    "Transfer-Encoding: chunked\r\n\r\n" + in_chunks(body, 1000));
    EXPECT_TRUE(test::parse_answer(connection.receive()).body == "/ " + text)
        << coding << " in chunks";
  }
  EXPECT_EQ(
      test::ask(server->port(), "POST", "/", test::pack(test::Packing::gzip, ""), coded("gzip"))
          .body,
      "/ ");
}

TEST(HttpServer, RefusesBodiesThatDoNotUnpack) {
  const Result<HttpServer> server = start_echo({.max_body_bytes = 1 << 20});
  ASSERT_TRUE(server) << server.error().message;
  const std::string gzip = test::pack(test::Packing::gzip, std::string(5000, 'a') + "b");
  std::string wrong_sum = gzip;
  wrong_sum[gzip.size() - 8] ^= 1;
  const std::string bomb = test::pack(test::Packing::gzip, std::string(64 << 20, '\0'));
  struct Case {
    std::string coding, body, reason;
    int status = 400;
  };
  for (const Case& one :
       std::vector<Case>{{"gzip", "ply", "header"},
                         {"gzip", "", "its end"},
                         {"gzip", gzip.substr(0, gzip.size() - 1), "its end"},
                         {"gzip", gzip.substr(0, 5), "its end"},
                         {"gzip", wrong_sum, "check"},
                         {"gzip", gzip + "more", "behind"},
                         {"gzip", test::pack(test::Packing::zlib, "ply"), "header"},
                         {"deflate", gzip, "header"},
                         {"deflate", "ply", "header"},
                         {"gzip", bomb, "1048576", 413},
                         {"gzip", std::string(2 << 20, 'a'), "1048576", 413},
                         {"br", "ply", "gzip, deflate", 415},
                         {"gzip, gzip", gzip, "gzip, deflate", 415},
                         {"identity, gzip", gzip, "gzip, deflate", 415}}) {
    const test::Answer answer = test::ask(server->port(), "POST", "/", one.body, coded(one.coding));
    EXPECT_EQ(answer.status, one.status) << one.coding << ": " << answer.body.substr(0, 200);
    EXPECT_NE(answer.body.find(one.reason), std::string::npos) << one.reason << answer.body;
  }
  // The largest allowed body: the limit applies to the decoded size.
  const std::string most(1 << 20, 'x');
  EXPECT_EQ(
      test::ask(server->port(), "POST", "/", test::pack(test::Packing::gzip, most), coded("gzip"))
          .status,
      200);
  EXPECT_EQ(test::ask(server->port(), "POST", "/", test::pack(test::Packing::gzip, most + "x"),
                      coded("gzip"))
                .status,
            413);
}

TEST(HttpServer, PacksLongTextsForThoseWhoAsk) {
  const std::string text(100'000, 'a');
  const auto answer_all = [&](const HttpRequest& request, const HttpAnswer& answer) {
    if (request.target == "/bytes") return answer({200, text, "application/octet-stream", {}});
    answer({200, request.target == "/short" ? "a" : text});
  };
  const Result<HttpServer> server = HttpServer::start(
      "127.0.0.1", 0, {}, {answer_all, [](auto, auto) { return std::optional<HttpResponse>(); }});
  ASSERT_TRUE(server) << server.error().message;
  const auto coding_of = [&](const std::string& target, const std::string& accepted) {
    const test::Answer answer =
        test::ask(server->port(), "GET", target, "", "Accept-Encoding: " + accepted + "\r\n");
    EXPECT_EQ(answer.status, 200);
    std::smatch found;
    if (!std::regex_search(answer.head, found, std::regex("\r\nContent-Encoding: ([a-z]+)"))) {
      EXPECT_TRUE(answer.body == text || target == "/short") << answer.head;
      return std::string("none");
    }
    EXPECT_NE(answer.head.find("\r\nVary: Accept-Encoding"), std::string::npos) << answer.head;
    EXPECT_LT(answer.body.size(), text.size() / 10);
    EXPECT_TRUE(test::unpack(answer.body) == text) << accepted;
    return found[1].str();
  };
  EXPECT_EQ(coding_of("/", "gzip"), "gzip");
  EXPECT_EQ(coding_of("/", "gzip, deflate, br"), "gzip");
  EXPECT_EQ(coding_of("/", "br, GZIP;q=0.5, deflate;q=0.8"), "deflate");
  EXPECT_EQ(coding_of("/", "*"), "gzip");
  EXPECT_EQ(coding_of("/", "gzip;q=0, deflate"), "deflate");
  EXPECT_EQ(coding_of("/", "gzip; q=0.000"), "none");
  EXPECT_EQ(coding_of("/", "gzip;q=0.3, identity;q=0.8"), "none");
  EXPECT_EQ(coding_of("/", "identity"), "none");
  EXPECT_EQ(coding_of("/", "br;q=1"), "none");
  EXPECT_EQ(coding_of("/", "gzip;q=nonsense"), "none");
  EXPECT_EQ(coding_of("/bytes", "gzip"), "none");
  EXPECT_EQ(coding_of("/short", "gzip"), "none");
  const test::Connection connection(server->port());
  connection.send(
      "HEAD / HTTP/1.1\r\nHost: a\r\nAccept-Encoding: gzip\r\nConnection: close\r\n\r\n");
  const std::string head = connection.receive();
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << "no body behind " << head.substr(0, 300);
}

}  // namespace
}  // namespace trivet::apps::service
