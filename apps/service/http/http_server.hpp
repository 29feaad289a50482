/// An HTTP/1.1 server with bounded resources. Slow, broken, large or too many clients cost only
/// their connection.
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
  std::size_t max_arriving_bytes = 512 << 20;  ///< bodies that are being received, in total
  std::size_t max_connections = 1024;
  std::size_t max_connections_per_address = 512;
  std::chrono::milliseconds request_timeout{10'000};  ///< time to send a whole request
  std::chrono::milliseconds idle_timeout{60'000};     ///< time between requests
  std::chrono::milliseconds write_timeout{30'000};    ///< to receive a response, or 256 KiB of it
};

struct HttpRequest {
  std::string method, target;  ///< target: with its query
  std::string named_host;      ///< host named by the target; empty: the Host header applies
  std::string local_address;   ///< address that the client has connected to
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case
  /// Whether the client has closed or reset its connection. May be called from any thread while the
  /// request is being answered.
  std::function<bool()> is_gone;

  /// The value of a header; empty: not present.
  std::string header(std::string_view name) const;
};

/// A body that is too large for memory.
struct HttpStream {
  std::uint64_t num_bytes = 0;
  /// Fills `next` with the next bytes of the body; false: it cannot, and the connection ends.
  /// Called by one thread at a time, never by the network thread.
  std::function<bool(std::span<char> next)> read;
};

struct HttpResponse {
  unsigned status = 200;
  std::string body, content_type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers{};
  std::optional<HttpStream> stream{};  ///< replaces the body
};

/// Sends the response. Call it once, from any thread.
using HttpAnswer = std::function<void(HttpResponse)>;

/// Callbacks of the server. All are called on the network thread.
struct HttpHandler {
  /// Answers a request, at once or later.
  std::function<void(HttpRequest, HttpAnswer)> handle;
  /// Refuses a request by its target and the size of its body, before the body is read; none: go
  /// on.
  std::function<std::optional<HttpResponse>(std::string_view target, std::size_t body_bytes)> admit;
  /// Refuses a request by its head, before `admit` is called; none: go on. May be empty.
  std::function<std::optional<HttpResponse>(const HttpRequest& head)> check{};
};

/// Whether a service could listen at the address if no other one did.
/// Errors: usage (not an IP address, not an address of this machine, or a port that this user may
/// not open).
Result<void> check_address(const std::string& address, std::uint16_t port);

/// Listens and serves on a separate thread until it is destroyed.
class HttpServer {
 public:
  /// port  0: any free one
  /// Errors: usage (address), cannot_create (the port is in use).
  static Result<HttpServer> start(const std::string& address, std::uint16_t port,
                                  const HttpLimits& limits, HttpHandler handler);
  HttpServer(HttpServer&&) noexcept;
  HttpServer& operator=(HttpServer&&) noexcept;
  ~HttpServer();

  std::uint16_t port() const;
  std::size_t num_connections() const;
  /// Accepts no more connections. Open ones get `Connection: close` with their next response.
  void stop_accepting();
  /// Waits until every received request was answered, up to `deadline`. Returns whether all were.
  bool wait_until_idle(std::chrono::steady_clock::time_point deadline) const;
  /// Stops calling the handler. Responses may still be sent, up to the end of the server's life.
  void stop();

 private:
  struct State;
  explicit HttpServer(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace trivet::apps::service
