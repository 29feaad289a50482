#include "apps/service/http/http_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <map>
#include <optional>

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Request = http::request<http::span_body<const std::byte>>;

Request request_of(const HttpCall& call, bool keep_alive) {
  Request request;
  request.version(11);
  request.method_string(call.method);
  request.target(call.target);
  request.set(http::field::host, call.host);
  for (const auto& [name, value] : call.headers) request.set(name, value);
  request.keep_alive(keep_alive);
  request.body() = {call.body.data(), call.body.size()};
  request.prepare_payload();
  return request;
}

/// Whether nobody has closed a connection that waits, nor written to it.
bool is_quiet(tcp::socket& socket) {
  char byte = 0;
  error_code error;
  socket.non_blocking(true, error);
  socket.receive(asio::buffer(&byte, 1), tcp::socket::message_peek, error);
  return error == asio::error::would_block;
}

HttpFailure failure_of(const error_code& error, HttpFault otherwise, const std::stop_token& stop) {
  if (stop.stop_requested()) return {HttpFault::stopped, "stopped"};
  if (error == beast::error::timeout) return {HttpFault::too_late, "no answer by the deadline"};
  return {otherwise, error.message()};
}

}  // namespace

void add_token(HttpCall& call, const std::string& token) {
  if (!token.empty()) call.headers.emplace_back("Authorization", "Bearer " + token);
}

struct HttpClient::State {
  /// What a connection gave.
  struct Exchange {
    HttpOutcome outcome;
    bool is_silent = false;  ///< it ended before a byte of an answer
  };

  std::optional<beast::tcp_stream> take_idle(const tcp::endpoint& to) {
    std::vector<beast::tcp_stream>& kept = idle[to];
    while (!kept.empty()) {
      beast::tcp_stream stream = std::move(kept.back());
      kept.pop_back();
      if (is_quiet(stream.socket())) return stream;
    }
    return std::nullopt;
  }

  /// Send a request and read the answer. The stream lives on if its connection can be used again.
  asio::awaitable<Exchange> exchange(std::optional<beast::tcp_stream>& stream, const HttpCall& call,
                                     Clock::time_point deadline, const std::stop_token& stop) {
    const std::stop_callback on_stop(stop, [&] { stream->close(); });
    Request request = request_of(call, limits.max_idle > 0);
    error_code error;
    stream->expires_at(deadline);
    co_await http::async_write(*stream, request, asio::redirect_error(asio::use_awaitable, error));
    // A refusal may come before the whole body was taken, so an error of writing is no answer.
    http::response_parser<http::string_body> response;
    response.body_limit(limits.max_answer_bytes);
    beast::flat_buffer buffer;
    co_await http::async_read(*stream, buffer, response,
                              asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      HttpFailure failure = failure_of(error, HttpFault::broken, stop);
      const bool is_silent = failure.fault == HttpFault::broken && !response.got_some();
      co_return Exchange{std::move(failure), is_silent};
    }
    http::response<http::string_body> message = response.release();
    const std::string type(message[http::field::content_type]);
    const std::string retry_after(message[http::field::retry_after]);
    HttpResponse answer{message.result_int(), std::move(message.body()), type, {}};
    if (!retry_after.empty()) answer.headers.emplace_back("Retry-After", retry_after);
    stream->expires_never();
    if (!message.keep_alive() || buffer.size() > 0) stream.reset();
    co_return Exchange{std::move(answer)};
  }

  asio::io_context& context;
  HttpClientLimits limits;
  std::map<tcp::endpoint, std::vector<beast::tcp_stream>> idle{};
};

HttpClient::HttpClient(asio::io_context& context, const HttpClientLimits& limits)
    : state_(std::make_unique<State>(context, limits)) {}
HttpClient::~HttpClient() = default;

asio::awaitable<HttpOutcome> HttpClient::ask(tcp::endpoint to, const HttpCall& call,
                                             Clock::time_point deadline, std::stop_token stop) {
  if (stop.stop_requested()) co_return HttpFailure{HttpFault::stopped, "stopped"};
  std::optional<beast::tcp_stream> stream = state_->take_idle(to);
  std::optional<State::Exchange> exchange;
  if (stream) exchange = co_await state_->exchange(stream, call, deadline, stop);
  if (!exchange || exchange->is_silent) {
    stream.emplace(state_->context);
    const std::stop_callback on_stop(stop, [&] { stream->close(); });
    error_code error;
    stream->expires_at(std::min(deadline, Clock::now() + state_->limits.connect_timeout));
    co_await stream->async_connect(to, asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      HttpFailure failure = failure_of(error, HttpFault::unreachable, stop);
      if (failure.fault == HttpFault::too_late && Clock::now() < deadline)
        failure = {HttpFault::unreachable, "no connection in time"};
      co_return failure;
    }
    stream->socket().set_option(tcp::no_delay(true), error);
    exchange = co_await state_->exchange(stream, call, deadline, stop);
  }
  const bool is_answered = std::holds_alternative<HttpResponse>(exchange->outcome);
  std::vector<beast::tcp_stream>& kept = state_->idle[to];
  if (is_answered && stream && kept.size() < state_->limits.max_idle)
    kept.push_back(std::move(*stream));
  co_return std::move(exchange->outcome);
}

}  // namespace trivet::apps::service
