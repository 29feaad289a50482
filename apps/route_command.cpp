#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "apps/commands.hpp"
#include "apps/http/http_server.hpp"
#include "apps/http/request_log.hpp"
#include "apps/route/router.hpp"

namespace trivet::apps {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{100};

struct RouteArguments {
  std::vector<std::string> shards;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;
  std::size_t max_inflight_mb = 512, max_body_mb = 64;
  RouterOptions router;
  HttpLimits http;
  std::uint32_t deadline_ms = 10'000, drain_grace_ms = 2000, exit_timeout_ms = 30'000;
};

Result<std::vector<ShardAddress>> parse_shards(const std::vector<std::string>& texts) {
  std::vector<ShardAddress> shards;
  std::set<std::string> known;
  for (const std::string& text : texts) {
    Result<ShardAddress> shard = parse_shard(text);
    if (!shard) return shard.error();
    if (!known.insert(text).second)
      return Error{ErrorCode::usage,
                   fmt::format("expected each SHARD once, found '{}' twice", text)};
    shards.push_back(std::move(*shard));
  }
  return shards;
}

Result<void> route(const RouteArguments& arguments, const Context& context) {
  const Result<std::vector<ShardAddress>> shards = parse_shards(arguments.shards);
  if (!shards) return shards.error();
  RouterOptions options = arguments.router;
  options.default_deadline = milliseconds(arguments.deadline_ms);
  options.max_inflight_bytes = arguments.max_inflight_mb << 20;
  HttpLimits limits = arguments.http;
  limits.max_body_bytes = arguments.max_body_mb << 20;
  limits.max_arriving_bytes = options.max_inflight_bytes;

  RequestLog log(STDERR_FILENO);     // outlives all that may write
  std::optional<HttpServer> server;  // outlives all that may still answer
  Router router(*shards, options, log);
  Result<HttpServer> started =
      HttpServer::start(arguments.address, arguments.port, limits,
                        {[&](HttpRequest request, HttpAnswer answer) {
                           router.handle(std::move(request), std::move(answer));
                         },
                         [&](std::string_view target, std::size_t body_bytes) {
                           return router.admit(target, body_bytes);
                         }});
  if (!started) return started.error();
  server = std::move(*started);
  context.console.line(fmt::format("routing to {} shards on http://{}:{}", shards->size(),
                                   arguments.address, server->port()));

  while (!context.stop.stop_requested()) std::this_thread::sleep_for(kPollInterval);
  log.write("info", "ending");
  router.set_closing();
  std::this_thread::sleep_for(milliseconds(arguments.drain_grace_ms));
  server->stop_accepting();
  const bool all = server->wait_until_idle(std::chrono::steady_clock::now() +
                                           milliseconds(arguments.exit_timeout_ms));
  server->stop();
  log.write(all ? "info" : "warning",
            all ? "every request was answered" : "some requests were not answered");
  return {};
}

}  // namespace

void add_route(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<RouteArguments>();
  CLI::App* command = app.add_subcommand(
      "route",
      "Answer for services that each hold a part of a library\n\n"
      "POST /v1/recognize asks all shards at once, and answers as one library would; what a shard\n"
      "does not answer by the deadline is told under \"missing\". GET /v1/models, "
      "/v2/health/live,\n"
      "/v2/health/ready (when every shard is), /metrics. `trivet library split` makes the parts.");
  command
      ->add_option("SHARD", arguments->shards,
                   "host:port of each `trivet serve`, by address or name")
      ->required();
  command->add_option("--address", arguments->address, "To listen on")->capture_default_str();
  command->add_option("--port", arguments->port, "To listen on; 0: any free one")
      ->capture_default_str();
  command
      ->add_option("--max-inflight", arguments->router.max_inflight,
                   "Recognitions at a time; more get 503")
      ->check(CLI::Range(1U, 100'000U))
      ->capture_default_str();
  command
      ->add_option("--max-inflight-mb", arguments->max_inflight_mb,
                   "Memory of their bodies; more get 503")
      ->check(CLI::Range(1U, 1'000'000U))
      ->capture_default_str();
  command->add_option("--max-body-mb", arguments->max_body_mb, "Larger bodies get 413")
      ->check(CLI::Range(1U, 100'000U))
      ->capture_default_str();
  command
      ->add_option("--max-connections", arguments->http.max_connections,
                   "Open at a time; more wait")
      ->capture_default_str();
  command
      ->add_option("--deadline-ms", arguments->deadline_ms,
                   "For an answer, where a request has no X-Deadline-Ms; shards have a little less")
      ->check(CLI::Range(1U, 3'600'000U))
      ->capture_default_str();
  command
      ->add_option("--drain-grace-ms", arguments->drain_grace_ms,
                   "Between not being ready and taking no more")
      ->capture_default_str();
  command
      ->add_option("--exit-timeout-ms", arguments->exit_timeout_ms,
                   "For what came in, after SIGTERM")
      ->capture_default_str();
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return route(*arguments, context); };
  });
}

}  // namespace trivet::apps
