#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <memory>
#include <optional>
#include <thread>

#include "apps/commands/commands.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/http/request_log.hpp"
#include "apps/service/serve/examples.hpp"
#include "apps/service/serve/library_slot.hpp"
#include "apps/service/serve/memory_trim.hpp"
#include "apps/service/serve/metrics.hpp"
#include "apps/service/serve/notify_systemd.hpp"
#include "apps/service/serve/serve_settings.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "engine/recognition_service.hpp"

namespace trivet::apps {
namespace {

using namespace service;

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{50};

std::atomic<bool> reload_asked{false};

/// Until told to stop.
void wait_for_signals(const Context& context, LibrarySlot& slot, RequestLog& log,
                      const RecognitionService& service, MemoryTrim& memory) {
  const auto watchdog = watchdog_interval();
  auto told = ServiceClock::now();
  while (!context.stop.stop_requested()) {
    std::this_thread::sleep_for(kPollInterval);
    const ServiceState state = service.state();
    memory.look(state.num_running + state.num_waiting > 0);
    // Twice as often as it must be.
    if (watchdog && ServiceClock::now() - told >= *watchdog / 2 && !state.is_stuck) {
      notify_systemd("WATCHDOG=1");
      told = ServiceClock::now();
    }
    if (!reload_asked.exchange(false)) continue;
    notify_systemd("RELOADING=1");
    slot.reload([&log](const Result<void>& done) {
      notify_systemd("READY=1");
      if (done) {
        log.write("info", "library read anew");
      } else {
        log.write("error", "library not read anew", {{"error", done.error().message}});
      }
    });
  }
}

Result<void> serve(const ServeSettings& settings, const Context& context) {
  std::signal(SIGHUP, [](int) { reload_asked = true; });
  MemoryTrim memory;
  Result<std::vector<Example>> examples = settings.examples.empty()
                                              ? Result<std::vector<Example>>(std::vector<Example>())
                                              : list_examples(settings.examples);
  if (!examples) return examples.error();
  const ListenSettings& listen = settings.listen;
  RequestLog log(listen.log_descriptor());  // outlives all that may write
  Result<std::shared_ptr<const LibraryGeneration>> first = load_generation(settings.files(), 1);
  if (!first) return first.error();

  std::optional<HttpServer> server;  // outlives all that may still answer
  Metrics metrics;
  RecognitionService service(settings.service(), *first);
  first = std::shared_ptr<const LibraryGeneration>();
  std::optional<LibrarySlot> slot(std::in_place, settings.files(), service, metrics);
  ServiceRoutes routes(service, metrics, log,
                       {milliseconds(listen.deadline_ms), settings.service().max_waiting_bytes},
                       std::move(*examples),
                       [&](LibrarySlot::Done done) { slot->reload(std::move(done)); });
  std::atomic<const HttpServer*> listening{nullptr};
  routes.set_num_connections([&] {
    const HttpServer* const open = listening;
    return open ? open->num_connections() : 0;
  });
  Result<HttpServer> started =
      HttpServer::start(listen.address, listen.port, listen.http(settings.max_waiting_mb),
                        {[&](HttpRequest request, HttpAnswer answer) {
                           routes.handle(std::move(request), std::move(answer));
                         },
                         [&](std::string_view target, std::size_t body_bytes) {
                           return routes.admit(target, body_bytes);
                         }});
  if (!started) return started.error();
  server = std::move(*started);
  listening = &*server;
  routes.set_ready(true);
  context.console.line(
      fmt::format("serving {} on http://{}:{}", settings.library, listen.address, server->port()));
  notify_systemd("READY=1");
  wait_for_signals(context, *slot, log, service, memory);

  notify_systemd("STOPPING=1");
  // Balancers see it first; then nothing new; then all that came in is answered.
  log.write("info", "ending");
  routes.set_ready(false);
  std::this_thread::sleep_for(milliseconds(listen.drain_grace_ms));
  server->stop_accepting();
  const auto deadline = ServiceClock::now() + milliseconds(listen.exit_timeout_ms);
  const bool all = service.drain(deadline);
  server->wait_until_idle(deadline + std::chrono::seconds(1));
  server->stop();
  slot.reset();  // a library that is being read is answered for, too
  log.write(all ? "info" : "warning",
            all ? "every request was answered" : "some requests were not answered");
  return {};
}

Result<void> run(const SettingArguments& arguments, const Context& context) {
  ServeSettings settings;
  if (const Result<void> good = read_settings(settings, arguments); !good) return good.error();
  if (!arguments.check_config) return serve(settings, context);
  context.console.line("the configuration is good");
  return {};
}

}  // namespace

void add_serve(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<SettingArguments>();
  CLI::App* command = app.add_subcommand(
      "serve",
      "Recognize over HTTP, with a page to try it\n\n"
      "POST /v1/recognize?format=ply takes a scan as its body and the options of `trivet "
      "recognize`\n"
      "as parameters; / is the page. SIGHUP or POST /v1/library/reload read the library anew;\n"
      "SIGTERM answers what came in, then ends.");
  ServeSettings defaults;
  add_settings(*command, settings_of(defaults), *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return run(*arguments, context); };
  });
}

}  // namespace trivet::apps
