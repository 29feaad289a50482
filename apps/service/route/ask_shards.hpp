/// Asks several shards at once.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "apps/service/http/http_client.hpp"
#include "apps/service/route/merge_answers.hpp"
#include "apps/service/route/route_metrics.hpp"
#include "apps/service/route/shard.hpp"

namespace trivet::apps::service {

/// What is asked of a shard, and what became of it.
struct ShardCall {
  const Shard* shard = nullptr;
  HttpCall call;
  HttpOutcome outcome = HttpFailure{HttpFault::stopped, "not asked"};
  std::optional<ShardAnswer> answer{};  ///< what an outcome with 200 says
};

/// Calls of shards for one request. Used on the thread of its context.
class FanOut {
 public:
  /// All outlive it.
  FanOut(boost::asio::io_context& context, HttpClient& client, RouteMetrics& metrics)
      : context_(context), client_(client), metrics_(metrics), changed_(context) {}

  std::vector<ShardCall> calls;

  /// Returns when each call has its outcome: by the deadline, or soon after the client has gone.
  boost::asio::awaitable<void> ask_all(std::chrono::steady_clock::time_point deadline,
                                       const std::function<bool()>& is_gone);
  /// By a shard that is full: the whole answer can be had later.
  bool is_refused() const { return is_refused_; }
  /// Before all had an outcome: a shard refused, or the client has gone.
  bool is_stopped() const { return stop_.stop_requested(); }

 private:
  boost::asio::awaitable<void> ask_one(ShardCall& call,
                                       std::chrono::steady_clock::time_point deadline);

  boost::asio::io_context& context_;
  HttpClient& client_;
  RouteMetrics& metrics_;
  boost::asio::steady_timer changed_;
  std::stop_source stop_;
  std::size_t num_open_ = 0;
  bool is_refused_ = false;
};

}  // namespace trivet::apps::service
