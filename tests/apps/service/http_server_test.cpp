#include "apps/service/http/http_server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/service/http_client.hpp"

namespace trivet::apps::service {
namespace {

using std::chrono::seconds, std::chrono::steady_clock;

TEST(HttpServer, AnswersWhoWasConnectedByTheSystemBeforeTheDoorClosed) {
  // A handler that holds the network's thread: nobody is accepted meanwhile, and the clients wait
  // in the system's queue, connected as they see it.
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
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the request to close is there
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

TEST(HttpServer, TellsWhoHasGone) {
  std::promise<HttpRequest> asked[3];
  std::vector<HttpAnswer> answers;  // of the network's thread until a request is told
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

}  // namespace
}  // namespace trivet::apps::service
