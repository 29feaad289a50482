#include "apps/service/route/ask_shards.hpp"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;
using boost::system::error_code;

constexpr std::chrono::milliseconds kClientInterval{50};  // at whether the client is still there

std::string_view label_of(const HttpOutcome& outcome) {
  if (const HttpResponse* const answer = std::get_if<HttpResponse>(&outcome)) {
    if (answer->status == 504) return "deadline";
    return answer->status == 200 ? "answered" : "refused";
  }
  switch (std::get<HttpFailure>(outcome).fault) {
    case HttpFault::unreachable:
      return "unreachable";
    case HttpFault::too_late:
      return "deadline";
    case HttpFault::broken:
      return "broken";
    case HttpFault::stopped:
      return "gone";
  }
  return "";
}

/// Whether a shard has as much to do as it may, and says when to come again.
bool is_overloaded(const HttpResponse& response) {
  return response.status == 503 && std::ranges::any_of(response.headers, [](const auto& header) {
           return header.first == "Retry-After";
         });
}

}  // namespace

asio::awaitable<void> FanOut::ask_all(Clock::time_point deadline,
                                      const std::function<bool()>& is_gone) {
  num_open_ = calls.size();
  for (ShardCall& call : calls) asio::co_spawn(context_, ask_one(call, deadline), asio::detached);
  while (num_open_ > 0) {
    changed_.expires_after(kClientInterval);
    error_code ignored;
    co_await changed_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    if (num_open_ > 0 && is_gone && is_gone()) stop_.request_stop();
  }
}

asio::awaitable<void> FanOut::ask_one(ShardCall& call, Clock::time_point deadline) {
  const auto begun = Clock::now();
  call.outcome =
      co_await client_.ask(*call.shard->endpoint, call.call, deadline, stop_.get_token());
  const HttpResponse* const response = std::get_if<HttpResponse>(&call.outcome);
  if (response && is_overloaded(*response)) {
    is_refused_ = true;  // what the others would find is not whole
    stop_.request_stop();
  }
  if (response && response->status == 200) {
    Result<ShardAnswer> answer = parse_answer(call.shard->address.name, response->body);
    if (answer) {
      call.answer = std::move(*answer);
    } else {
      call.outcome = HttpFailure{HttpFault::broken, answer.error().message};
    }
  }
  metrics_.observe_shard(call.shard->address.name, std::string(label_of(call.outcome)),
                         std::chrono::duration<double>(Clock::now() - begun).count());
  if (--num_open_ == 0) changed_.cancel();
}

}  // namespace trivet::apps::service
