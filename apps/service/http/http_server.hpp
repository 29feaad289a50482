/// HTTP/1.1 within bounds: slow, large, broken and too many clients cost their own connection only.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct HttpLimits {
  std::size_t max_header_bytes = 8192;
  std::size_t max_body_bytes = 64 << 20;
  std::size_t max_arriving_bytes = 512 << 20;  ///< of bodies on their way, all together
  std::size_t max_connections = 1024;
  std::size_t max_connections_per_address = 512;
  std::chrono::milliseconds request_timeout{10'000};  ///< to send a whole request
  std::chrono::milliseconds idle_timeout{60'000};     ///< between requests
  std::chrono::milliseconds write_timeout{30'000};  ///< to take a whole response, or 256 KiB of one
};

struct HttpRequest {
  std::string method, target;  ///< the target with its query
  std::string named_host;      ///< where the target named one; empty: the header Host alone does
  std::string local_address;   ///< that the client has connected to
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case
  /// Whether the client has closed or reset its connection. From any thread, while the request is
  /// answered.
  std::function<bool()> is_gone;

  /// Empty where there is none.
  std::string header(std::string_view name) const;
};

/// A body that is too large for memory.
struct HttpStream {
  std::uint64_t num_bytes = 0;
  /// Gives the next bytes, as many as asked for; false: it cannot, and the connection ends. Called
  /// by one thread at a time, and not on the network's.
  std::function<bool(std::span<char> next)> read;
};

struct HttpResponse {
  unsigned status = 200;
  std::string body, content_type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers{};
  std::optional<HttpStream> stream{};  ///< in place of the body
};

/// Called once, from any thread.
using HttpAnswer = std::function<void(HttpResponse)>;

/// All are called on the network's thread.
struct HttpHandler {
  /// Answers at once or later.
  std::function<void(HttpRequest, HttpAnswer)> handle;
  /// Refuses a request by its target and the size of its body before that is read; none: go on.
  std::function<std::optional<HttpResponse>(std::string_view target, std::size_t body_bytes)> admit;
  /// Refuses a request by its head, before `admit` is asked; none: go on. May be empty.
  std::function<std::optional<HttpResponse>(const HttpRequest& head)> check{};
};

/// Whether a service could listen there, were nobody else there. Errors: usage (not an IP address, or
/// not of this machine; a port that is not for this user).
Result<void> check_address(const std::string& address, std::uint16_t port);

/// Listens and serves on a thread of its own until it is destroyed.
class HttpServer {
 public:
  /// port  0: any free one
  /// Errors: usage (address), cannot_create (the port is taken).
  static Result<HttpServer> start(const std::string& address, std::uint16_t port,
                                  const HttpLimits& limits, HttpHandler handler);
  HttpServer(HttpServer&&) noexcept;
  HttpServer& operator=(HttpServer&&) noexcept;
  ~HttpServer();

  std::uint16_t port() const;
  std::size_t num_connections() const;
  /// Accept no more connections; those that are open get `Connection: close` with their next
  /// answer.
  void stop_accepting();
  /// Wait until every request that came in was answered, up to `deadline`. Returns whether it was.
  bool wait_until_idle(std::chrono::steady_clock::time_point deadline) const;
  /// Call the handler no more. Answers may still come, up to the end of the server's life.
  void stop();

 private:
  struct State;
  explicit HttpServer(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace trivet::apps::service
