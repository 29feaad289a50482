/// HTTP/1.1 to other services within bounds: deadlines, answers of limited size, connections that
/// are kept.
#pragma once

// clang-format off
#include <utility>  // first: awaitable.hpp of Boost 1.74 forgets it
#include <boost/asio/awaitable.hpp>
// clang-format on
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

struct HttpClientLimits {
  std::size_t max_answer_bytes = 256 << 20;
  std::chrono::milliseconds connect_timeout{2000};
  std::size_t max_idle = 0;  ///< connections to an endpoint kept for later; 0: each has its own
};

/// What a client asks.
struct HttpCall {
  std::string method = "GET", host, target;
  std::vector<std::pair<std::string, std::string>> headers{};
  std::span<const std::byte> body{};
};

/// Show a bearer token; empty: none.
void add_token(HttpCall& call, const std::string& token);

enum class HttpFault {
  unreachable,  ///< no connection
  too_late,     ///< no whole answer by the deadline
  broken,       ///< the connection broke, or what came is no answer within the limits
  stopped,      ///< on request
};
struct HttpFailure {
  HttpFault fault;
  std::string reason;
};
/// An answer has its status, body, content type and Retry-After.
using HttpOutcome = std::variant<HttpResponse, HttpFailure>;

/// Used on the thread of its context.
class HttpClient {
 public:
  HttpClient(boost::asio::io_context& context, const HttpClientLimits& limits);
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;
  ~HttpClient();

  /// Ask once; a kept connection that turns out to be closed is replaced by a new one, so only what
  /// may be done twice should be asked over kept ones. `call` and what it refers to must live until
  /// the answer. A stop on the context's thread ends it at once.
  boost::asio::awaitable<HttpOutcome> ask(boost::asio::ip::tcp::endpoint to, const HttpCall& call,
                                          std::chrono::steady_clock::time_point deadline,
                                          std::stop_token stop = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet::apps::service
