#include "apps/serve/http_server.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cctype>
#include <map>
#include <thread>

namespace trivet::apps {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kPauseWhenFull{50}, kMaxDiscardTime{2000};

std::string lower(beast::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

/// Counts while it lives.
class Share {
 public:
  Share(std::size_t& sum, std::size_t n) : sum_(sum), n_(n) { sum_ += n_; }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;
  ~Share() { sum_ -= n_; }

 private:
  std::size_t& sum_;
  std::size_t n_;
};

HttpResponse refusal(unsigned status, const std::string& reason) {
  std::string text;
  for (const char c : reason) text += c == '"' || c == '\\' ? '\'' : c;
  return {status, fmt::format("{{\"error\":\"{}\"}}\n", text)};
}

/// What a failed read deserves; none: the connection just ends.
std::optional<HttpResponse> refusal_of(const error_code& error, const HttpLimits& limits) {
  if (error == http::error::body_limit) {
    return refusal(413, fmt::format("expected a body of at most {} bytes", limits.max_body_bytes));
  }
  if (error == http::error::header_limit) {
    return refusal(431,
                   fmt::format("expected headers of at most {} bytes", limits.max_header_bytes));
  }
  if (error == beast::error::timeout) return refusal(408, "the request took too long to arrive");
  if (error == http::error::end_of_stream || error == http::error::partial_message ||
      error.category() != http::make_error_code(http::error::bad_value).category()) {
    return std::nullopt;
  }
  return refusal(400, fmt::format("not an HTTP request: {}", error.message()));
}

}  // namespace

struct HttpServer::State {
  State(const HttpLimits& http_limits, HttpHandler http_handler)
      : limits(http_limits), handler(std::move(http_handler)) {}

  ~State() { stop(); }

  void stop() {
    context.stop();
    if (thread.joinable()) thread.join();
  }

  asio::awaitable<void> accept() {
    asio::steady_timer pause(context);
    while (acceptor.is_open()) {
      if (num_connections >= limits.max_connections) {  // the system queues a few more
        pause.expires_after(kPauseWhenFull);
        error_code ignored;
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
        continue;
      }
      error_code error;
      tcp::socket socket =
          co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (error == asio::error::operation_aborted) co_return;
      if (error) {  // no file descriptors left
        pause.expires_after(kPauseWhenFull);
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
        continue;
      }
      const tcp::endpoint from = socket.remote_endpoint(error);
      ++num_connections;
      const bool is_welcome = ++per_address[from.address()] <= limits.max_connections_per_address;
      asio::co_spawn(context,
                     is_welcome ? serve(beast::tcp_stream(std::move(socket)))
                                : send_away(beast::tcp_stream(std::move(socket))),
                     [this, address = from.address()](const std::exception_ptr&) {
                       --num_connections;
                       const auto entry = per_address.find(address);
                       if (--entry->second == 0) per_address.erase(entry);
                     });
    }
  }

  asio::awaitable<void> send_away(beast::tcp_stream stream) {
    co_await write(stream, busy("too many connections from this address"), 11, false);
  }

  static HttpResponse busy(const std::string& reason) {
    HttpResponse response = refusal(503, reason);
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }

  /// Before the body is read.
  std::optional<HttpResponse> admit(std::string_view target, std::size_t body_bytes) const {
    if (num_arriving + body_bytes > limits.max_arriving_bytes)
      return busy("as many bytes arrive as may");
    return handler.admit(target, body_bytes);
  }

  /// One connection, request after request.
  asio::awaitable<void> serve(beast::tcp_stream stream) {
    beast::flat_buffer buffer(limits.max_header_bytes + 65'536);
    error_code error;
    stream.socket().set_option(tcp::no_delay(true), error);
    for (;;) {
      http::request_parser<http::string_body> parser;
      parser.header_limit(static_cast<std::uint32_t>(limits.max_header_bytes));
      parser.body_limit(limits.max_body_bytes);
      // Idle until the first byte, then a deadline for the whole of the request.
      if (buffer.size() == 0) {
        stream.expires_after(limits.idle_timeout);
        const std::size_t n = co_await stream.async_read_some(
            buffer.prepare(4096), asio::redirect_error(asio::use_awaitable, error));
        if (error) break;
        buffer.commit(n);
      }
      stream.expires_after(limits.request_timeout);
      co_await http::async_read_header(stream, buffer, parser,
                                       asio::redirect_error(asio::use_awaitable, error));
      std::optional<HttpResponse> refused;
      if (error) {
        refused = refusal_of(error, limits);
      } else {
        const std::size_t body_bytes =
            parser.content_length().value_or(parser.chunked() ? limits.max_body_bytes : 0);
        const Share share(num_arriving, body_bytes);
        const auto target = parser.get().target();
        refused = admit({target.data(), target.size()}, body_bytes);
        if (!refused) {
          co_await read_body(stream, buffer, parser, error);
          if (error) refused = refusal_of(error, limits);
        }
      }
      if (refused) {
        co_await write(stream, *refused, 11, false);
        co_await discard(stream);
      }
      if (error || refused) break;
      const unsigned version = parser.get().version();
      const bool keep_alive = parser.get().keep_alive() && !is_closing;
      stream.expires_never();
      ++num_busy;
      const HttpResponse response = co_await answer(stream, parser.release());
      const bool written = co_await write(stream, response, version, keep_alive && !is_closing);
      --num_busy;
      if (!written || !keep_alive || is_closing) break;
    }
    stream.socket().shutdown(tcp::socket::shutdown_send, error);
  }

  asio::awaitable<void> read_body(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                  http::request_parser<http::string_body>& parser,
                                  error_code& error) {
    if (beast::iequals(parser.get()[http::field::expect], "100-continue")) {
      http::response<http::empty_body> go_on(http::status::continue_, parser.get().version());
      co_await http::async_write(stream, go_on, asio::redirect_error(asio::use_awaitable, error));
    }
    if (!error) {
      co_await http::async_read(stream, buffer, parser,
                                asio::redirect_error(asio::use_awaitable, error));
    }
  }

  /// Hand a request to the handler and wait for its answer.
  asio::awaitable<HttpResponse> answer(beast::tcp_stream& stream,
                                       http::request<http::string_body> message) {
    HttpRequest request{std::string(message.method_string()),
                        std::string(message.target()),
                        std::move(message.body()),
                        {},
                        {}};
    for (const auto& field : message.base())
      request.headers.emplace_back(lower(field.name_string()), std::string(field.value()));
    request.is_gone = [descriptor = stream.socket().native_handle()] {
      char byte = 0;
      return ::recv(descriptor, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
    };
    auto initiate = [this](auto completion, HttpRequest asked) {
      // A handler may be copied; a completion may not.
      auto shared = std::make_shared<decltype(completion)>(std::move(completion));
      handler.handle(std::move(asked), [this, shared](HttpResponse response) {
        asio::post(context, [shared, response = std::move(response)]() mutable {
          (*shared)(std::move(response));
        });
      });
    };
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>, void(HttpResponse)>(
        initiate, asio::use_awaitable, std::move(request));
  }

  asio::awaitable<bool> write(beast::tcp_stream& stream, const HttpResponse& response,
                              unsigned version, bool keep_alive) {
    http::response<http::string_body> message(http::int_to_status(response.status), version);
    message.set(http::field::content_type, response.content_type);
    for (const auto& [name, value] : response.headers) message.set(name, value);
    message.keep_alive(keep_alive);
    message.body() = response.body;
    message.prepare_payload();
    stream.expires_after(limits.write_timeout);
    error_code error;
    co_await http::async_write(stream, message, asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  /// Read what a refused client still sends, and throw it away: most clients read the answer when
  /// they have sent all.
  asio::awaitable<void> discard(beast::tcp_stream& stream) {
    error_code error;
    stream.socket().shutdown(tcp::socket::shutdown_send, error);
    stream.expires_after(kMaxDiscardTime);
    std::string rest(65'536, '\0');
    for (std::size_t sum = 0; sum < limits.max_body_bytes && !error;) {
      sum += co_await stream.async_read_some(asio::buffer(rest),
                                             asio::redirect_error(asio::use_awaitable, error));
    }
  }

  HttpLimits limits;
  HttpHandler handler;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  std::atomic<std::size_t> num_connections{0}, num_busy{0};
  std::size_t num_arriving = 0;  // bytes of bodies; of the network's thread, as the next
  std::map<asio::ip::address, std::size_t> per_address;
  std::atomic<bool> is_closing{false};
  std::uint16_t port = 0;
  std::thread thread;
};

std::string HttpRequest::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return value;
  }
  return "";
}

Result<HttpServer> HttpServer::start(const std::string& address, std::uint16_t port,
                                     const HttpLimits& limits, HttpHandler handler) {
  auto state = std::make_unique<State>(limits, std::move(handler));
  error_code error;
  const asio::ip::address where = asio::ip::make_address(address, error);
  if (error) {
    return Error{
        ErrorCode::usage,
        fmt::format("--address: expected an IP address as 127.0.0.1, found '{}'", address)};
  }
  const tcp::endpoint endpoint(where, port);
  state->acceptor.open(endpoint.protocol(), error);
  if (!error) state->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) state->acceptor.bind(endpoint, error);
  if (!error) state->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}:{}: cannot listen: {}; choose another --port", address, port,
                             error.message())};
  }
  state->port = state->acceptor.local_endpoint().port();
  asio::co_spawn(state->context, state->accept(), asio::detached);
  state->thread = std::thread([&context = state->context] {
    // Keeps running while no connection is open.
    const auto work = asio::make_work_guard(context);
    context.run();
  });
  return HttpServer(std::move(state));
}

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
HttpServer::HttpServer(HttpServer&&) noexcept = default;
HttpServer& HttpServer::operator=(HttpServer&&) noexcept = default;
HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const { return state_->port; }
std::size_t HttpServer::num_connections() const { return state_->num_connections; }

void HttpServer::stop_accepting() {
  state_->is_closing = true;
  asio::post(state_->context, [state = state_.get()] {
    error_code ignored;
    state->acceptor.close(ignored);
  });
}

void HttpServer::stop() { state_->stop(); }

bool HttpServer::wait_until_idle(std::chrono::steady_clock::time_point deadline) const {
  while (state_->num_busy > 0) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace trivet::apps
