#include "apps/service/route/router.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "apps/service/http/call.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/route/ask_shards.hpp"
#include "apps/service/route/join_answers.hpp"
#include "apps/service/route/route_metrics.hpp"
#include "apps/service/route/share_request.hpp"

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kLookInterval{500};  // at shards
constexpr std::size_t kMaxAnswerBytes = 32 << 20;
constexpr std::size_t kMaxIdle = 32;
/// Of a deadline, so that an answer of what is there by then is in time. Shards have twice that.
constexpr milliseconds kLongestMargin{100};
constexpr int kMarginShare = 20;

}  // namespace

struct Router::State {
  State(const RouterOptions& router_options, const BearerTokens& bearer_tokens,
        RequestLog& request_log)
      : options(router_options),
        tokens(bearer_tokens),
        log(request_log),
        replies(metrics, request_log, RequestWords::route) {}

  asio::awaitable<void> watch(Shard& shard) {
    ShardLook look(context, client, tokens, shard);
    asio::steady_timer pause(context);
    std::string told = "\n";  // unlike any reason
    for (;;) {
      if (co_await look.again()) update_conflict();
      if (std::exchange(told, shard.reason) != shard.reason) {
        log.write(shard.is_ready ? "info" : "warning",
                  shard.is_ready ? "shard ready" : "shard not ready",
                  {{"shard", shard.address.name}, {"reason", shard.reason}});
      }
      pause.expires_after(kLookInterval);
      error_code ignored;
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    }
  }

  void update_conflict() {
    std::optional<std::string> now = conflict_of(shards);
    if (now && now != conflict) log.write("error", "shards in conflict", {{"reason", *now}});
    conflict = std::move(now);
  }

  /// What is answered at once.
  struct Route {
    std::string_view method, path, name;  ///< no method: any
    HttpResponse (State::*answer)() const;
  };

  void handle(const CallPtr& call) {
    static const std::vector<Route> kRoutes{
        {"GET", "/v1/models", "models", &State::models},
        {"", "/v2/health/live", "live", &State::liveness},
        {"", "/v2/health/ready", "ready", &State::readiness},
        {"GET", "/metrics", "metrics", &State::measurements},
    };
    const std::string& target = call->request.target;
    const std::string path = target.substr(0, target.find('?'));
    if (path == "/v1/recognize") return take(call);
    const auto route = std::ranges::find(kRoutes, path, &Route::path);
    if (route == kRoutes.end()) return replies.send(*call, error_response(404, "no such path"));
    call->route = route->name;
    const bool has_method = route->method.empty() || route->method == call->request.method;
    replies.send(*call, has_method ? (this->*route->answer)()
                                   : method_response(route->method, call->request));
  }

  void take(const CallPtr& call) {
    call->route = "recognize";
    call->is_logged = true;
    if (call->request.method != "POST")
      return replies.send(*call, method_response("POST", call->request));
    if (is_full(call->num_bytes)) return replies.send(*call, refusal_response(Refusal::full));
    asio::co_spawn(context, recognize(call), asio::detached);
  }

  bool is_full(std::size_t body_bytes) const {
    return num_inflight >= options.max_inflight ||
           num_bytes + body_bytes > options.max_inflight_bytes;
  }

  HttpResponse liveness() const { return json_response(200, {{"live", true}}); }
  HttpResponse measurements() const { return metrics.tell({num_inflight, num_bytes}, shards); }

  HttpResponse readiness() const {
    Json told = Json::array();
    bool is_ready = !conflict && !is_closing;
    for (const Shard& shard : shards) {
      is_ready = is_ready && shard.is_ready;
      Json one{{"shard", shard.address.name}, {"ready", shard.is_ready}};
      if (!shard.is_ready) one["reason"] = shard.reason;
      told.push_back(std::move(one));
    }
    Json json{{"ready", is_ready}};
    if (conflict) json["error"] = *conflict;
    json["shards"] = std::move(told);
    return json_response(is_ready ? 200 : 503, json);
  }

  /// As the shards told last.
  HttpResponse models() const {
    Json all = Json::array();
    std::string unit;
    std::vector<Missing> missing;
    for (const Shard& shard : shards) {
      if (!shard.catalog) {
        missing.push_back({shard.address.name, shard.reason});
        continue;
      }
      unit = shard.catalog->unit;
      for (const nlohmann::json& model : shard.catalog->models) {
        Json one = model;
        one["shard"] = shard.address.name;
        all.push_back(std::move(one));
      }
    }
    return json_response(200, {{"partial", !missing.empty()},
                               {"missing", missing_json(missing)},
                               {"unit", unit},
                               {"models", std::move(all)}});
  }

  asio::awaitable<void> recognize(CallPtr call) {
    ++num_inflight;
    num_bytes += call->num_bytes;
    HttpResponse response;
    try {
      response = co_await answer_of(*call);
    } catch (const std::exception& error) {
      response = error_response(500, fmt::format("internal: {}", error.what()));
    }
    --num_inflight;
    num_bytes -= call->num_bytes;
    metrics.observe_request(call->seconds());
    replies.send(*call, std::move(response));
  }

  asio::awaitable<HttpResponse> answer_of(const Call& call) {
    const HttpRequest& request = call.request;
    const Result<Target> target = parse_target(request.target);
    if (!target) co_return error_response(target.error());
    const Result<Clock::time_point> deadline = deadline_of(request, options.default_deadline);
    if (!deadline) co_return error_response(deadline.error());
    if (const Result<void> good = check_form(request); !good)
      co_return error_response(good.error());
    if (target->parameter("claims"))
      co_return error_response(400, "claims: asked of shards only, expected no such parameter");
    if (conflict) co_return error_response(503, *conflict);
    const auto now = Clock::now();
    const auto margin = std::min<Clock::duration>(kLongestMargin, (*deadline - now) / kMarginShare);

    std::vector<Missing> missing;
    FanOut fan_out(context, client, metrics);
    const Result<std::vector<Target>> targets = targets_of(*target, shards);
    if (!targets) co_return error_response(targets.error());
    for (std::size_t k = 0; k < shards.size(); ++k) {
      const Shard& shard = shards[k];
      if ((*targets)[k].path.empty()) continue;
      if (!shard.is_reachable) {  // it would only be waited for
        missing.push_back({shard.address.name, shard.reason});
        continue;
      }
      const auto left = std::chrono::duration_cast<milliseconds>(*deadline - now - 2 * margin);
      fan_out.calls.push_back({&shard, call_of(call, (*targets)[k], shard, tokens.first(), left)});
    }
    co_await fan_out.ask_all(*deadline - margin, request.is_gone);
    if (fan_out.is_refused()) co_return refusal_response(Refusal::full);
    if (fan_out.is_stopped()) co_return refusal_response(Refusal::gone);
    co_return join_answers(fan_out.calls, std::move(missing), call.id);
  }

  const RouterOptions options;
  const BearerTokens& tokens;
  RequestLog& log;
  asio::io_context context{1};
  HttpClient client{context, {.max_answer_bytes = kMaxAnswerBytes, .max_idle = kMaxIdle}};
  std::vector<Shard> shards;  // of fixed number
  std::optional<std::string> conflict;
  RouteMetrics metrics;
  const Replies replies;
  std::atomic<bool> is_closing{false};
  std::atomic<std::size_t> num_inflight{0}, num_bytes{0};
  std::thread thread;
};

Router::Router(const std::vector<ShardAddress>& shards, const RouterOptions& options,
               const BearerTokens& tokens, RequestLog& log)
    : state_(std::make_unique<State>(options, tokens, log)) {
  for (const ShardAddress& address : shards) {
    state_->shards.push_back({address});
    state_->metrics.expect_shard(address.name);
  }
  for (Shard& shard : state_->shards)
    asio::co_spawn(state_->context, state_->watch(shard), asio::detached);
  state_->thread = std::thread([&context = state_->context] { context.run(); });
}

Router::~Router() {
  state_->context.stop();
  state_->thread.join();
}

void Router::handle(HttpRequest request, HttpAnswer answer) {
  const auto call = std::make_shared<Call>(std::move(request), std::move(answer));
  asio::post(state_->context, [state = state_.get(), call] { state->handle(call); });
}

std::optional<HttpResponse> Router::admit(std::string_view target, std::size_t body_bytes) {
  if (!target.starts_with("/v1/recognize") || !state_->is_full(body_bytes)) return std::nullopt;
  state_->metrics.count_request("recognize", 503);
  return refusal_response(Refusal::full);
}

bool Router::is_free(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  return path == "/v2/health/live" || path == "/v2/health/ready";
}

void Router::count_refused(AccessFault fault) { state_->metrics.count_refused(fault); }

void Router::set_closing() { state_->is_closing = true; }

}  // namespace trivet::apps::service
