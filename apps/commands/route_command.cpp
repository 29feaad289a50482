#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>

#include "apps/commands/commands.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http/request_log.hpp"
#include "apps/service/route/route_settings.hpp"
#include "apps/service/route/router.hpp"

namespace trivet::apps {
namespace {

using namespace service;

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{100};

Result<void> route(const RouteSettings& settings, const Context& context) {
  const ListenSettings& listen = settings.listen;
  RequestLog log(listen.log_descriptor());  // outlives all that may write
  std::optional<HttpServer> server;         // outlives all that may still answer
  Router router(settings.shards, settings.router(), log);
  Result<HttpServer> started =
      HttpServer::start(listen.address, listen.port, listen.http(settings.max_inflight_mb),
                        {[&](HttpRequest request, HttpAnswer answer) {
                           router.handle(std::move(request), std::move(answer));
                         },
                         [&](std::string_view target, std::size_t body_bytes) {
                           return router.admit(target, body_bytes);
                         }});
  if (!started) return started.error();
  server = std::move(*started);
  context.console.line(fmt::format("routing to {} shards on http://{}:{}", settings.shards.size(),
                                   listen.address, server->port()));

  while (!context.stop.stop_requested()) std::this_thread::sleep_for(kPollInterval);
  log.write("info", "ending");
  router.set_closing();
  std::this_thread::sleep_for(milliseconds(listen.drain_grace_ms));
  server->stop_accepting();
  const bool all = server->wait_until_idle(std::chrono::steady_clock::now() +
                                           milliseconds(listen.exit_timeout_ms));
  server->stop();
  log.write(all ? "info" : "warning",
            all ? "every request was answered" : "some requests were not answered");
  return {};
}

Result<void> run(const SettingArguments& arguments, const Context& context) {
  RouteSettings settings;
  if (const Result<void> good = read_settings(settings, arguments); !good) return good.error();
  if (!arguments.check_config) return route(settings, context);
  context.console.line("the configuration is good");
  return {};
}

}  // namespace

void add_route(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<SettingArguments>();
  CLI::App* command = app.add_subcommand(
      "route",
      "Answer for services that each hold a part of a library\n\n"
      "POST /v1/recognize asks all shards at once, and answers as one library would; what a shard\n"
      "does not answer by the deadline is told under \"missing\". GET /v1/models, "
      "/v2/health/live,\n"
      "/v2/health/ready (when every shard is), /metrics. `trivet library split` makes the parts.");
  RouteSettings defaults;
  add_settings(*command, settings_of(defaults), *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return run(*arguments, context); };
  });
}

}  // namespace trivet::apps
