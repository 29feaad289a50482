#include "apps/service/http/http_server.hpp"

#include <fmt/chrono.h>
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
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cerrno>
#include <ctime>
#include <future>
#include <map>
#include <new>
#include <thread>
#include <type_traits>

#include "apps/service/http/content_coding.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/query.hpp"
#include "storage/common/wait_for_memory.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::milliseconds kPauseWhenFull{50}, kMaxDiscardTime{2000}, kPatience{1000};
constexpr std::size_t kMinPackedBytes = 16 << 10;    ///< packing takes longer than sending
constexpr std::uint64_t kStreamedBytes = 256 << 10;  ///< part of a stream that is in memory

std::string lower(beast::string_view text) {
  return formats::lower_case({text.data(), text.size()});
}

/// Adds to a sum for the duration of its life.
template <class Sum>
class Share {
 public:
  Share(Sum& sum, std::size_t n) : sum_(sum), n_(n) { sum_ += n_; }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;
  ~Share() { sum_ -= n_; }

 private:
  Sum& sum_;
  std::size_t n_;
};

HttpResponse refusal(unsigned status, const std::string& reason) {
  return error_response(status, reason);
}

HttpResponse too_large(const HttpLimits& limits) {
  return refusal(413, fmt::format("expected a body of at most {} bytes", limits.max_body_bytes));
}

/// The response to a failed read; none: the connection just ends.
std::optional<HttpResponse> refusal_of(const error_code& error, const HttpLimits& limits) {
  if (error == http::error::body_limit) return too_large(limits);
  if (error == http::error::header_limit) {
    return refusal(431,
                   fmt::format("expected headers of at most {} bytes", limits.max_header_bytes));
  }
  if (error == http::error::end_of_stream || error == http::error::partial_message ||
      error.category() != http::make_error_code(http::error::bad_value).category()) {
    return std::nullopt;
  }
  return refusal(400, fmt::format("not an HTTP request: {}", error.message()));
}

constexpr const char* kCodings = "gzip, deflate";

std::optional<ContentCoding> coding_of(const http::request<http::string_body>& head) {
  const beast::string_view name = head[http::field::content_encoding];
  return content_coding({name.data(), name.size()});
}

/// The refusal of a well-formed request; none: read on.
std::optional<HttpResponse> refusal_of(const http::request<http::string_body>& head) {
  // RFC 9112, 3.2: servers that route by the host must not receive two.
  const std::size_t num_hosts = head.count(http::field::host);
  if (num_hosts > 1 || (num_hosts == 0 && head.version() >= 11))
    return refusal(400, "expected one Host header");
  // RFC 9112, 6.1: other codings would hide where the body ends.
  const std::size_t num_codings = head.count(http::field::transfer_encoding);
  if (num_codings > 1 ||
      (num_codings == 1 &&
       (head.version() < 11 || !beast::iequals(head[http::field::transfer_encoding], "chunked")))) {
    return refusal(400, "expected no Transfer-Encoding but chunked, and that of HTTP/1.1");
  }
  if (head.count(http::field::content_encoding) > 1 || !coding_of(head)) {
    HttpResponse response = refusal(
        415, fmt::format("expected a body with no Content-Encoding but one of {}, found '{}'",
                         kCodings, std::string(head[http::field::content_encoding])));
    response.headers.emplace_back("Accept-Encoding", kCodings);
    return response;
  }
  return std::nullopt;
}

/// The request without its body and without the connection's fields.
HttpRequest request_head(const http::request<http::string_body>& message) {
  HttpRequest head;
  // HEAD is answered as GET, without the body.
  head.method = message.method() == http::verb::head ? "GET" : std::string(message.method_string());
  head.target = std::string(message.target());
  for (const auto& field : message.base())
    head.headers.emplace_back(lower(field.name_string()), std::string(field.value()));
  return head;
}

bool is_text(std::string_view content_type) {
  return content_type.starts_with("application/json") || content_type.starts_with("text/");
}

/// An HTTP date: RFC 9110, 5.6.7.
std::string date_of(std::time_t time) {
  return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT", fmt::gmtime(time));
}

/// A deadline for all operations that wait on a socket. The socket stays open for a response: the
/// expiry of the stream itself would close it.
class Deadline {
 public:
  Deadline(tcp::socket& socket, std::chrono::milliseconds after)
      : timer_(socket.get_executor(), after) {
    timer_.async_wait([&socket, state = state_](const error_code& error) {
      if (error || !state->is_awaited) return;  // the socket may be closed
      state->has_passed = true;
      error_code ignored;
      socket.cancel(ignored);
    });
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  ~Deadline() { state_->is_awaited = false; }

  bool has_passed() const { return state_->has_passed; }

 private:
  struct State {
    bool is_awaited = true, has_passed = false;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
  asio::steady_timer timer_;
};

}  // namespace

struct HttpServer::State : std::enable_shared_from_this<State> {
  State(const HttpLimits& http_limits, HttpHandler http_handler)
      : limits(http_limits), handler(std::move(http_handler)) {}

  ~State() { stop(); }

  void stop() {
    context.stop();
    if (thread.joinable()) thread.join();
  }

  asio::awaitable<void> accept() {
    while (acceptor.is_open()) {
      try {
        co_await accept_one();
      } catch (const std::bad_alloc&) {  // lose this client, not those that follow
      }
    }
  }

  asio::awaitable<void> accept_one() {
    asio::steady_timer pause(context, kPauseWhenFull);
    error_code error;
    if (num_connections >= limits.max_connections) {  // the system queues a few more
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      co_return;
    }
    tcp::socket socket =
        co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (error && error != asio::error::operation_aborted) {  // no file descriptors left
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    } else if (!error) {
      start_session(std::move(socket));
    }
  }

  void start_session(tcp::socket socket) {
    error_code ignored;
    const tcp::endpoint from = socket.remote_endpoint(ignored);
    ++num_connections;
    const bool is_welcome = ++per_address[from.address()] <= limits.max_connections_per_address;
    const bool is_last = is_closing;  // from the system's queue: its request is on its way
    if (is_last) ++num_busy;
    asio::co_spawn(context,
                   is_welcome ? serve(beast::tcp_stream(std::move(socket)))
                              : send_away(beast::tcp_stream(std::move(socket))),
                   [this, is_last, address = from.address()](const std::exception_ptr&) {
                     if (is_last) --num_busy;
                     --num_connections;
                     const auto entry = per_address.find(address);
                     if (--entry->second == 0) per_address.erase(entry);
                   });
  }

  /// Stops listening. Clients in the system's queue are already connected.
  void close_door() {
    is_closing = true;
    error_code error;
    acceptor.non_blocking(true, error);
    while (!error && num_connections < limits.max_connections) {
      tcp::socket socket(context);
      acceptor.accept(socket, error);
      if (!error) start_session(std::move(socket));
    }
    acceptor.close(error);
  }

  asio::awaitable<void> send_away(beast::tcp_stream stream) {
    co_await write(stream, busy("too many connections from this address"), 11, false, false);
  }

  static HttpResponse busy(const std::string& reason) {
    HttpResponse response = refusal(503, reason);
    response.headers.emplace_back("Retry-After", "1");
    return response;
  }

  /// Called before the body is read.
  std::optional<HttpResponse> admit(std::string_view target, std::size_t body_bytes) const {
    if (num_arriving + body_bytes > limits.max_arriving_bytes)
      return busy("as many bytes arrive as may");
    return handler.admit(target, body_bytes);
  }

  std::optional<HttpResponse> check(const beast::tcp_stream& stream,
                                    const http::request<http::string_body>& message,
                                    const std::string& named_host) const {
    if (!handler.check) return std::nullopt;
    HttpRequest head = request_head(message);
    head.named_host = named_host;
    error_code ignored;
    head.local_address = stream.socket().local_endpoint(ignored).address().to_string();
    return handler.check(head);
  }

  /// Serves one connection, request after request.
  asio::awaitable<void> serve(beast::tcp_stream stream) {
    beast::flat_buffer buffer(limits.max_header_bytes + 65'536);
    error_code error;
    stream.socket().set_option(tcp::no_delay(true), error);
    for (;;) {
      http::request_parser<http::string_body> parser;
      parser.header_limit(static_cast<std::uint32_t>(limits.max_header_bytes));
      parser.body_limit(limits.max_body_bytes);
      // Idle until the first byte; then the deadline holds for the whole request.
      if (buffer.size() == 0) {
        stream.expires_after(is_closing ? kPatience : limits.idle_timeout);
        const std::size_t n = co_await stream.async_read_some(
            buffer.prepare(4096), asio::redirect_error(asio::use_awaitable, error));
        if (error) break;
        buffer.commit(n);
      }
      const Share busy(num_busy, 1);
      const std::optional<HttpResponse> refused = co_await read(stream, buffer, parser, error);
      if (refused) {
        co_await write(stream, *refused, 11, false, false);
        co_await discard(stream);
      }
      if (error || refused) break;
      const unsigned version = parser.get().version();
      const bool keep_alive = parser.get().keep_alive() && !is_closing;
      const bool is_head = parser.get().method() == http::verb::head;
      const std::string accepted(parser.get()[http::field::accept_encoding]);
      stream.expires_never();
      HttpResponse response = co_await answer(stream, parser.release());
      co_await pack_body(response, accepted);
      const bool keep = keep_alive && !is_closing;
      const bool written = response.stream
                               ? co_await write_stream(stream, response, version, keep, is_head)
                               : co_await write(stream, response, version, keep, is_head);
      if (!written || !keep_alive || is_closing) break;
    }
    stream.socket().shutdown(tcp::socket::shutdown_send, error);
  }

  /// Reads a whole request. Returns the response to send in its place. With `error` and without a
  /// response there is no client left.
  asio::awaitable<std::optional<HttpResponse>> read(beast::tcp_stream& stream,
                                                    beast::flat_buffer& buffer,
                                                    http::request_parser<http::string_body>& parser,
                                                    error_code& error) {
    const auto token = [&error] { return asio::redirect_error(asio::use_awaitable, error); };
    const Deadline deadline(stream.socket(), limits.request_timeout);
    stream.expires_after(limits.request_timeout + kPatience);  // deadline may pass between reads
    co_await http::async_read_header(stream, buffer, parser, token());
    if (!error) {
      if (std::optional<HttpResponse> refused = refusal_of(parser.get())) co_return refused;
      const auto named = parser.get().target();
      const Result<HostedTarget> hosted = origin_form({named.data(), named.size()});
      if (!hosted) co_return refusal(400, hosted.error().message);
      const std::string& target = hosted->target;
      parser.get().target(target);
      if (std::optional<HttpResponse> refused = check(stream, parser.get(), hosted->host))
        co_return refused;
      const std::size_t body_bytes =
          parser.content_length().value_or(parser.chunked() ? limits.max_body_bytes : 0);
      const Share share(num_arriving, body_bytes);
      if (std::optional<HttpResponse> refused = admit(target, body_bytes)) co_return refused;
      if (beast::iequals(parser.get()[http::field::expect], "100-continue")) {
        http::response<http::empty_body> go_on(http::status::continue_, parser.get().version());
        co_await http::async_write(stream, go_on, token());
      }
      if (!error) co_await http::async_read(stream, buffer, parser, token());
      if (!error && !deadline.has_passed()) co_return co_await unpack_body(parser.get());
    }
    if (deadline.has_passed()) {
      co_return refusal(408, fmt::format("expected the whole request within {} ms",
                                         limits.request_timeout.count()));
    }
    co_return refusal_of(error, limits);
  }

  /// Replaces a body by its decompressed content. Returns the response to send in case of an error.
  asio::awaitable<std::optional<HttpResponse>> unpack_body(
      http::request<http::string_body>& message) {
    const ContentCoding coding = *coding_of(message);
    message.erase(http::field::content_encoding);
    if (coding == ContentCoding::identity) co_return std::nullopt;
    // One at a time, so that decompression bombs on all connections together use the memory of one.
    Result<std::string> unpacked = co_await aside([this, coding, packed = &message.body()] {
      return unpack(coding, *packed, limits.max_body_bytes);
    });
    if (!unpacked) {
      const bool is_ours = unpacked.error().code == ErrorCode::internal;
      co_return refusal(is_ours ? 500 : 400, unpacked.error().message);
    }
    if (unpacked->size() > limits.max_body_bytes) co_return too_large(limits);
    message.body() = std::move(*unpacked);
    co_return std::nullopt;
  }

  /// Compresses long texts for clients that accept it.
  asio::awaitable<void> pack_body(HttpResponse& response, const std::string& accepted) {
    if (response.body.size() < kMinPackedBytes || !is_text(response.content_type)) co_return;
    response.headers.emplace_back("Vary", "Accept-Encoding");
    const ContentCoding coding = accepted_coding(accepted);
    if (coding == ContentCoding::identity) co_return;
    std::optional<std::string> packed =
        co_await aside([coding, body = &response.body] { return pack(coding, *body); });
    if (!packed) co_return;
    response.body = std::move(*packed);
    response.headers.emplace_back("Content-Encoding", coding_name(coding));
  }

  /// Runs slow work outside the network thread, one item after the other.
  template <class Work>
  asio::awaitable<std::invoke_result_t<Work>> aside(Work work) {
    using Done = std::invoke_result_t<Work>;
    auto initiate = [this](auto completion, Work todo) {
      auto shared = std::make_shared<decltype(completion)>(std::move(completion));
      asio::post(coder, [this, shared, todo] {
        auto done = std::make_shared<Done>(todo());
        asio::post(context, [shared, done] { (*shared)(std::move(*done)); });
      });
    };
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>, void(Done)>(
        initiate, asio::use_awaitable, std::move(work));
  }

  /// Passes a request to the handler and waits for its response.
  asio::awaitable<HttpResponse> answer(beast::tcp_stream& stream,
                                       http::request<http::string_body> message) {
    HttpRequest request = request_head(message);
    request.body = std::move(message.body());
    request.is_gone = [descriptor = stream.socket().native_handle()] {
      char byte = 0;
      const ssize_t n = ::recv(descriptor, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
      return n == 0 || (n < 0 && errno == ECONNRESET);
    };
    auto initiate = [this](auto completion, HttpRequest asked) {
      // A handler may be copied; a completion may not.
      auto shared = std::make_shared<decltype(completion)>(std::move(completion));
      // The callback may outlive the server: the completion needs the context until it is released.
      const HttpAnswer answer = [self = shared_from_this(), this, shared](HttpResponse response) {
        asio::post(context, [shared, response = std::move(response)]() mutable {
          (*shared)(std::move(response));
        });
      };
      // An exception here would end the process. No response was sent then.
      try {
        handler.handle(std::move(asked), answer);
      } catch (const std::bad_alloc&) {
        answer(busy(kOutOfMemory));
      } catch (const std::exception& fault) {
        answer(refusal(500, fmt::format("internal: {}", fault.what())));
      }
    };
    co_return co_await asio::async_initiate<const asio::use_awaitable_t<>, void(HttpResponse)>(
        initiate, asio::use_awaitable, std::move(request));
  }

  template <class Body>
  static http::response<Body> head_of(const HttpResponse& response, unsigned version,
                                      bool keep_alive) {
    http::response<Body> message;
    message.version(version);
    message.result(response.status);
    message.set(http::field::date, date_of(std::time(nullptr)));
    message.set(http::field::content_type, response.content_type);
    for (const auto& [name, value] : response.headers) message.set(name, value);
    message.keep_alive(keep_alive);
    return message;
  }

  /// Reads the next bytes of the stream once the client has received the previous ones
  /// (backpressure).
  asio::awaitable<bool> write_stream(beast::tcp_stream& stream, const HttpResponse& response,
                                     unsigned version, bool keep_alive, bool is_head) {
    auto message = head_of<http::empty_body>(response, version, keep_alive);
    message.content_length(response.stream->num_bytes);
    stream.expires_after(limits.write_timeout);
    error_code error;
    http::response_serializer<http::empty_body> serializer(message);
    co_await http::async_write_header(stream, serializer,
                                      asio::redirect_error(asio::use_awaitable, error));
    std::uint64_t left = is_head ? 0 : response.stream->num_bytes;
    std::string part;
    while (!error && left > 0) {
      part.resize(std::min(left, kStreamedBytes));
      stream.expires_never();
      const bool is_read =
          co_await aside([&read = response.stream->read, &part] { return read(part); });
      if (!is_read) co_return false;
      stream.expires_after(limits.write_timeout);
      co_await asio::async_write(stream, asio::buffer(part),
                                 asio::redirect_error(asio::use_awaitable, error));
      left -= part.size();
    }
    co_return !error;
  }

  asio::awaitable<bool> write(beast::tcp_stream& stream, const HttpResponse& response,
                              unsigned version, bool keep_alive, bool is_head) {
    auto message = head_of<http::string_body>(response, version, keep_alive);
    message.body() = response.body;
    message.prepare_payload();
    stream.expires_after(limits.write_timeout);
    error_code error;
    http::response_serializer<http::string_body> serializer(message);
    if (is_head) {
      co_await http::async_write_header(stream, serializer,
                                        asio::redirect_error(asio::use_awaitable, error));
    } else {
      co_await http::async_write(stream, serializer,
                                 asio::redirect_error(asio::use_awaitable, error));
    }
    co_return !error;
  }

  /// Reads and discards the rest of a refused request: most clients read the response only after
  /// they have sent everything.
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
  std::size_t num_arriving = 0;  // bytes of bodies; used by the network thread only, as the next
  std::map<asio::ip::address, std::size_t> per_address;
  std::atomic<bool> is_closing{false};
  std::uint16_t port = 0;
  std::thread thread;
  asio::thread_pool coder{1};  // last member: its work uses the context
};

std::string HttpRequest::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return value;
  }
  return "";
}

Result<void> check_address(const std::string& address, std::uint16_t port) {
  error_code error;
  const asio::ip::address parsed = asio::ip::make_address(address, error);
  if (error) {
    return Error{ErrorCode::usage,
                 fmt::format("address: expected an IP address as 127.0.0.1, found '{}'", address)};
  }
  asio::io_context context;
  tcp::socket socket(context);
  socket.open(tcp::endpoint(parsed, port).protocol(), error);
  if (!error) socket.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) socket.bind({parsed, port}, error);
  if (!error || error == asio::error::address_in_use) return {};
  return Error{ErrorCode::usage,
               fmt::format("address: {}:{}: expected one that can be listened on here, found: {}",
                           address, port, error.message())};
}

Result<HttpServer> HttpServer::start(const std::string& address, std::uint16_t port,
                                     const HttpLimits& limits, HttpHandler handler) {
  TRIVET_TRY(check_address(address, port));
  auto state = std::make_shared<State>(limits, std::move(handler));
  asio::post(state->coder, [] { wait_for_memory_on_this_thread(); });
  error_code error;
  const tcp::endpoint endpoint(asio::ip::make_address(address), port);
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
    wait_for_memory_on_this_thread();
    // Keeps the context running while no connection is open.
    const auto work = asio::make_work_guard(context);
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) {  // on one connection; the others continue
      }
    }
  });
  return HttpServer(std::move(state));
}

HttpServer::HttpServer(std::shared_ptr<State> state) : state_(std::move(state)) {}
HttpServer::HttpServer(HttpServer&&) noexcept = default;
HttpServer& HttpServer::operator=(HttpServer&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}
HttpServer::~HttpServer() {
  if (state_) state_->stop();
}

std::uint16_t HttpServer::port() const { return state_->port; }
std::size_t HttpServer::num_connections() const { return state_->num_connections; }

void HttpServer::stop_accepting() {
  std::promise<void> closed;
  asio::post(state_->context, [&] {
    state_->close_door();
    closed.set_value();
  });
  closed.get_future().wait();
}

void HttpServer::stop() { state_->stop(); }

bool HttpServer::wait_until_idle(std::chrono::steady_clock::time_point deadline) const {
  while (state_->num_busy > 0) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace trivet::apps::service
