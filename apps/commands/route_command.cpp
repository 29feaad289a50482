#include <fmt/format.h>

#include "apps/commands/daemon_command.hpp"
#include "apps/service/daemon.hpp"
#include "apps/service/route/route_settings.hpp"
#include "apps/service/route/router.hpp"
#include "storage/counted.hpp"

namespace trivet::apps {
namespace {

using namespace service;

constexpr std::chrono::milliseconds kShardInterval{100};

Result<void> route(const RouteSettings& settings, const Context& context) {
  Daemon daemon(settings.listen, settings.max_inflight_mb);
  Daemon::take_hangups();
  Router router(settings.shards, settings.router(), daemon.tokens(), daemon.log());
  if (const Result<void> started = daemon.start(router); !started) return started.error();
  context.console.line(
      fmt::format("routing to {} on {}", counted(settings.shards.size(), "shard"), daemon.url()));
  Daemon::wait(context.stop, kShardInterval, [&] {
    if (Daemon::was_hung_up()) (void)daemon.read_tokens();  // which tells what is wrong
  });
  daemon.drain([&] { router.set_closing(); });
  daemon.tell_end();
  return {};
}

}  // namespace

void add_route(CLI::App& app, Context& context) {
  add_daemon<RouteSettings>(
      app, context, "route",
      "Answer for services that each hold a part of a library\n\n"
      "POST /v1/recognize asks all shards at once, and answers as one library would; what a shard\n"
      "does not answer by the deadline is told under \"missing\". GET /v1/models, "
      "/v2/health/live,\n"
      "/v2/health/ready (when every shard is), /metrics. `trivet library split` makes the parts.",
      {route});
}

}  // namespace trivet::apps
