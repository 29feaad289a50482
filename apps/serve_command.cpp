#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "apps/commands.hpp"
#include "apps/serve/http_server.hpp"
#include "apps/serve/library_slot.hpp"
#include "apps/serve/metrics.hpp"
#include "apps/serve/service_routes.hpp"
#include "engine/recognition_service.hpp"

namespace trivet::apps {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{100};

struct ServeArguments {
  std::string library, address = "127.0.0.1";
  std::uint16_t port = 8080;
  ServiceOptions service;
  std::size_t max_waiting_mb = 512, max_body_mb = 64;
  HttpLimits http;
  std::uint32_t deadline_ms = 10'000, drain_grace_ms = 2000, exit_timeout_ms = 30'000;
};

std::atomic<bool> reload_asked{false};

Result<void> serve(const ServeArguments& arguments, const Context& context) {
  ServiceOptions options = arguments.service;
  options.max_waiting_bytes = arguments.max_waiting_mb << 20;
  if (const Result<void> valid = validate(options); !valid) return valid;
  Result<std::shared_ptr<const LibraryGeneration>> first = load_generation(arguments.library, 1);
  if (!first) return first.error();

  std::optional<HttpServer> server;  // outlives all that may still answer
  Metrics metrics;
  RecognitionService service(options, *first);
  first = std::shared_ptr<const LibraryGeneration>();
  LibrarySlot slot(arguments.library, service, metrics);
  ServiceRoutes routes(service, metrics, {milliseconds(arguments.deadline_ms)},
                       [&](LibrarySlot::Done done) { slot.reload(std::move(done)); });
  std::atomic<const HttpServer*> listening{nullptr};
  routes.set_num_connections([&] {
    const HttpServer* const open = listening;
    return open ? open->num_connections() : 0;
  });
  HttpLimits limits = arguments.http;
  limits.max_body_bytes = arguments.max_body_mb << 20;
  Result<HttpServer> started = HttpServer::start(
      arguments.address, arguments.port, limits, [&](HttpRequest request, HttpAnswer answer) {
        routes.handle(std::move(request), std::move(answer));
      });
  if (!started) return started.error();
  server = std::move(*started);
  listening = &*server;
  std::signal(SIGHUP, [](int) { reload_asked = true; });
  routes.set_ready(true);
  context.console.line(fmt::format("serving {} on http://{}:{}", arguments.library,
                                   arguments.address, server->port()));

  while (!context.stop.stop_requested()) {
    std::this_thread::sleep_for(kPollInterval);
    if (reload_asked.exchange(false)) {
      slot.reload([&](const Result<void>& done) {
        context.console.line(done ? "library read anew" : "error: " + done.error().message);
      });
    }
  }
  // Balancers see it first; then nothing new; then all that came in is answered.
  routes.set_ready(false);
  std::this_thread::sleep_for(milliseconds(arguments.drain_grace_ms));
  server->stop_accepting();
  const auto deadline = ServiceClock::now() + milliseconds(arguments.exit_timeout_ms);
  const bool all = service.drain(deadline);
  server->wait_until_idle(deadline + std::chrono::seconds(1));
  server->stop();
  context.console.line(all ? "every request was answered" : "some requests were not answered");
  return {};
}

}  // namespace

void add_serve(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand(
      "serve",
      "Recognise over HTTP\n\n"
      "POST /v1/recognize?format=ply takes a scan as its body and the options of `trivet "
      "recognize`\n"
      "as parameters; GET /v1/models, /v2/health/live, /v2/health/ready, /metrics. SIGHUP or\n"
      "POST /v1/library/reload read the library anew; SIGTERM answers what came in, then ends.");
  command->add_option("LIBRARY", arguments->library, "Library file, made by `trivet train`")
      ->required();
  command->add_option("--address", arguments->address, "To listen on")->capture_default_str();
  command->add_option("--port", arguments->port, "To listen on; 0: any free one")
      ->capture_default_str();
  command
      ->add_option("--parallel", arguments->service.num_parallel,
                   "Scenes at a time, each with its share of the cores: 1 for the shortest answer, "
                   "0, one a core, for the most answers")
      ->capture_default_str();
  command
      ->add_option("--max-waiting", arguments->service.max_waiting,
                   "Requests that may wait; more get 503")
      ->capture_default_str();
  command
      ->add_option("--max-waiting-mb", arguments->max_waiting_mb,
                   "Memory of requests that wait and run; more get 503")
      ->capture_default_str();
  command->add_option("--max-body-mb", arguments->max_body_mb, "Larger bodies get 413")
      ->capture_default_str();
  command
      ->add_option("--max-connections", arguments->http.max_connections,
                   "Open at a time; more wait")
      ->capture_default_str();
  command
      ->add_option("--deadline-ms", arguments->deadline_ms,
                   "For an answer, where a request has no X-Deadline-Ms; then 504")
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
    context.run = [arguments, &context] { return serve(*arguments, context); };
  });
}

}  // namespace trivet::apps
