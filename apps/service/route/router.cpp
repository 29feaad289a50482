#include "apps/service/route/router.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
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
#include <optional>
#include <thread>
#include <utility>

#include "apps/service/http/call.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/multipart.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/route/merge_answers.hpp"
#include "apps/service/route/route_metrics.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

namespace asio = boost::asio;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kLookInterval{500};   // at shards
constexpr milliseconds kClientInterval{50};  // at whether the client is still there
constexpr std::size_t kMaxAnswerBytes = 32 << 20;
constexpr std::size_t kMaxIdle = 32;
/// Of a deadline, so that an answer of what is there by then is in time. Shards have twice that.
constexpr milliseconds kLongestMargin{100};
constexpr int kMarginShare = 20;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Why an answer lacks what a shard holds.
struct Missing {
  std::string shard, reason;
  bool is_late = false;
};

Json missing_json(const std::vector<Missing>& missing) {
  Json json = Json::array();
  for (const Missing& one : missing) json.push_back({{"shard", one.shard}, {"reason", one.reason}});
  return json;
}

/// What is asked of a shard, and what became of it.
struct ShardCall {
  const Shard* shard = nullptr;
  HttpCall call;
  HttpOutcome outcome = HttpFailure{HttpFault::stopped, "not asked"};
  std::optional<ShardAnswer> answer{};  ///< what an outcome with 200 says
};

/// Shards that are asked at once.
struct FanOut {
  std::vector<ShardCall> calls;
  std::size_t num_open = 0;
  asio::steady_timer changed;
  std::stop_source stop{};
  bool is_refused = false;  ///< by a shard that is full: the whole answer can be had later
};

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

/// What a refusal says.
std::string reason_of(const HttpResponse& refusal) {
  const Json body = Json::parse(refusal.body, nullptr, false);
  const bool is_told = body.is_object() && body.contains("error") && body["error"].is_string();
  return fmt::format("{}{}", refusal.status,
                     is_told ? ": " + body["error"].get<std::string>() : "");
}

HttpResponse nothing_found(const std::vector<Missing>& missing) {
  const bool is_late =
      !missing.empty() && std::ranges::all_of(missing, [](const Missing& m) { return m.is_late; });
  HttpResponse response = json_response(
      is_late ? 504 : 503, {{"error", "no shard answered"}, {"missing", missing_json(missing)}});
  if (!is_late) response.headers.emplace_back("Retry-After", "1");
  return response;
}

/// A form may hold options of its own, which the router does not look for; but these it must know.
Result<void> check_form(const HttpRequest& request) {
  const std::string type = request.header("content-type");
  if (!is_form(type)) return {};
  const Result<std::vector<FormPart>> parts = split_form(type, request.body);
  if (!parts) return parts.error();
  for (const FormPart& part : *parts) {
    if (part.name != "options") continue;
    const Result<void> good =
        with_json(std::as_bytes(std::span(part.content)), "options", [](const JsonNode& root) {
          for (const char* const name : {"models", "claims"}) {
            if (root.has(name))
              root.at(name).refuse("expected none behind a router but in the target: ?models=a,b");
          }
        });
    if (!good) return good;
  }
  return {};
}

}  // namespace

struct Router::State {
  State(const RouterOptions& router_options, RequestLog& request_log)
      : options(router_options),
        log(request_log),
        replies(metrics, request_log, RequestWords::route) {}

  asio::awaitable<void> watch(Shard& shard) {
    ShardLook look(context, client, shard);
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
    FanOut fan_out{{}, 0, asio::steady_timer(context)};
    const Result<std::vector<Target>> targets = targets_of(*target);
    if (!targets) co_return error_response(targets.error());
    for (std::size_t k = 0; k < shards.size(); ++k) {
      const Shard& shard = shards[k];
      if ((*targets)[k].path.empty()) continue;
      if (!shard.is_reachable) {  // it would only be waited for
        missing.push_back({shard.address.name, shard.reason});
        continue;
      }
      const auto left = std::chrono::duration_cast<milliseconds>(*deadline - now - 2 * margin);
      fan_out.calls.push_back({&shard, call_of(call, (*targets)[k], shard, left)});
    }
    co_await ask_all(fan_out, *deadline - margin, request.is_gone);
    if (fan_out.is_refused) co_return refusal_response(Refusal::full);
    if (fan_out.stop.stop_requested()) co_return refusal_response(Refusal::gone);
    co_return merge(fan_out.calls, std::move(missing), call.id);
  }

  /// What to ask each shard; with an empty path: nothing. Models that are asked for by name are
  /// asked of the shard that holds them. Errors: usage (no shard does).
  Result<std::vector<Target>> targets_of(const Target& asked) const {
    std::vector<Target> out(shards.size(), asked);
    for (Target& target : out) target.parameters.emplace_back("claims", "true");
    const std::optional<std::string> models = asked.parameter("models");
    if (!models) return out;
    std::vector<std::string> shares(shards.size());
    for (const std::string& name : CLI::detail::split(*models, ',')) {
      bool is_known = false;
      for (std::size_t k = 0; k < shards.size(); ++k) {
        const bool holds = shards[k].catalog && shards[k].catalog->names.contains(name);
        if (!holds && shards[k].catalog) continue;
        is_known = true;  // or may be held by a shard that has not told yet
        shares[k] += (shares[k].empty() ? "" : ",") + name;
      }
      if (!is_known) {
        return Error{ErrorCode::usage,
                     fmt::format("expected a model named '{}', found none; GET /v1/models tells "
                                 "the names",
                                 name)};
      }
    }
    for (std::size_t k = 0; k < shards.size(); ++k) {
      if (shares[k].empty()) out[k].path.clear();
      for (auto& [name, value] : out[k].parameters) {
        if (name == "models") value = shares[k];
      }
    }
    return out;
  }

  static HttpCall call_of(const Call& call, const Target& target, const Shard& shard,
                          std::chrono::milliseconds left) {
    HttpCall out{"POST", shard.address.name, write_target(target)};
    out.headers = {{"X-Request-Id", call.id},
                   {"X-Deadline-Ms", std::to_string(std::max<long>(1, left.count()))}};
    for (const auto& [name, value] :
         {std::pair("Content-Type", call.request.header("content-type")),
          std::pair("traceparent", call.trace)}) {
      if (!value.empty()) out.headers.emplace_back(name, value);
    }
    out.body = std::as_bytes(std::span(call.request.body));
    return out;
  }

  /// Returns when each call has its outcome: by the deadline, or soon after the client has gone.
  asio::awaitable<void> ask_all(FanOut& fan_out, Clock::time_point deadline,
                                const std::function<bool()>& is_gone) {
    fan_out.num_open = fan_out.calls.size();
    for (ShardCall& call : fan_out.calls)
      asio::co_spawn(context, ask_one(fan_out, call, deadline), asio::detached);
    while (fan_out.num_open > 0) {
      fan_out.changed.expires_after(kClientInterval);
      error_code ignored;
      co_await fan_out.changed.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
      if (fan_out.num_open > 0 && is_gone && is_gone()) fan_out.stop.request_stop();
    }
  }

  asio::awaitable<void> ask_one(FanOut& fan_out, ShardCall& call, Clock::time_point deadline) {
    const auto begun = Clock::now();
    call.outcome =
        co_await client.ask(*call.shard->endpoint, call.call, deadline, fan_out.stop.get_token());
    const HttpResponse* const response = std::get_if<HttpResponse>(&call.outcome);
    if (response && is_overloaded(*response)) {
      fan_out.is_refused = true;  // what the others would find is not whole
      fan_out.stop.request_stop();
    }
    if (response && response->status == 200) {
      Result<ShardAnswer> answer = parse_answer(call.shard->address.name, response->body);
      if (answer) {
        call.answer = std::move(*answer);
      } else {
        call.outcome = HttpFailure{HttpFault::broken, answer.error().message};
      }
    }
    metrics.observe_shard(call.shard->address.name, std::string(label_of(call.outcome)),
                          seconds_since(begun));
    if (--fan_out.num_open == 0) fan_out.changed.cancel();
  }

  static HttpResponse merge(std::vector<ShardCall>& calls, std::vector<Missing> missing,
                            const std::string& id) {
    std::vector<ShardAnswer> answers;
    std::size_t num_bad_requests = 0;
    for (ShardCall& call : calls) {
      const std::string& name = call.shard->address.name;
      if (const HttpFailure* const failure = std::get_if<HttpFailure>(&call.outcome)) {
        missing.push_back({name, failure->reason, failure->fault == HttpFault::too_late});
      } else if (!call.answer) {
        const HttpResponse& refusal = std::get<HttpResponse>(call.outcome);
        num_bad_requests += refusal.status / 100 == 4 ? 1 : 0;
        missing.push_back({name, reason_of(refusal), refusal.status == 504});
      } else if (!answers.empty() && !is_of_same_scenes(answers.front(), *call.answer)) {
        missing.push_back(
            {name, fmt::format("its scenes have not the sizes of those of {}", answers[0].shard)});
      } else {
        answers.push_back(std::move(*call.answer));
      }
    }
    if (!calls.empty() && num_bad_requests == missing.size() && answers.empty())
      return std::get<HttpResponse>(calls.front().outcome);
    if (answers.empty()) return nothing_found(missing);
    Json json{
        {"request_id", id}, {"partial", !missing.empty()}, {"missing", missing_json(missing)}};
    json.update(merge_answers(answers));
    return json_response(200, json);
  }

  const RouterOptions options;
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
               RequestLog& log)
    : state_(std::make_unique<State>(options, log)) {
  for (const ShardAddress& address : shards) state_->shards.push_back({address});
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

void Router::set_closing() { state_->is_closing = true; }

}  // namespace trivet::apps::service
