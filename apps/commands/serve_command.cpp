#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/commands/daemon_command.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/service/daemon.hpp"
#include "apps/service/serve/examples.hpp"
#include "apps/service/serve/library_slot.hpp"
#include "apps/service/serve/memory_trim.hpp"
#include "apps/service/serve/metrics.hpp"
#include "apps/service/serve/notify_systemd.hpp"
#include "apps/service/serve/serve_settings.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/service/serve/session/session.hpp"
#include "engine/method.hpp"
#include "engine/recognition_service.hpp"
#include "engine/training/provenance.hpp"

namespace trivet::apps {
namespace {

using namespace service;

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{50};

std::atomic<bool> reload_asked{false};

/// What SIGHUP asks for.
void reload(LibrarySlot& slot, RequestLog& log) {
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

/// Until told to stop.
void wait(const std::stop_token& stop, LibrarySlot& slot, RequestLog& log,
          const RecognitionService& service, MemoryTrim& memory) {
  const auto watchdog = watchdog_interval();
  auto told = ServiceClock::now();
  Daemon::wait(stop, kPollInterval, [&] {
    const ServiceState state = service.state();
    memory.look(state.num_running + state.num_waiting > 0);
    // Twice as often as it must be.
    if (watchdog && ServiceClock::now() - told >= *watchdog / 2 && !state.is_stuck) {
      notify_systemd("WATCHDOG=1");
      told = ServiceClock::now();
    }
    if (reload_asked.exchange(false)) reload(slot, log);
  });
}

/// None where none are asked for.
Result<std::vector<Example>> examples_of(const ServeSettings& settings) {
  if (settings.examples.empty()) return std::vector<Example>();
  return list_examples(settings.examples);
}

/// Null where none is asked for. What is damaged there is told.
Result<std::unique_ptr<Session>> session_of(const ServeSettings& settings, const Context& context) {
  if (settings.session.empty()) return std::unique_ptr<Session>();
  Result<std::unique_ptr<Session>> session =
      Session::open(settings.session, std::uint64_t{settings.session_mb} << 20);
  if (!session) return session;
  const nlohmann::ordered_json index = (*session)->index();
  for (const auto& fault : index["faults"]) {
    context.console.warning(fmt::format("{}: {}: {}", settings.session,
                                        fault["file"].get<std::string>(),
                                        fault["reason"].get<std::string>()));
  }
  return session;
}

/// What a service with these settings would read before it answers, and all of the library.
Result<std::string> check(const ServeSettings& settings) {
  OpenOptions opening = settings.opening;
  opening.verify = true;
  const Result<Recognizer> recognizer = open_recognizer(settings.library, opening);
  if (!recognizer) return recognizer.error();
  const Result<std::vector<Example>> examples = examples_of(settings);
  if (!examples) return examples.error();
  const Library& library = recognizer->library();
  std::vector<std::string_view> methods;
  if (std::ranges::any_of(library.models, [](const Model& model) { return model.has_pairs(); })) {
    methods.push_back(name_of(Source::ppf));
  }
  if (library.basis.components.size() > 0) methods.push_back(name_of(Source::trisi));
  std::string found = fmt::format("{}: {} model{} [{}], for method {}", settings.library,
                                  library.models.size(), library.models.size() == 1 ? "" : "s",
                                  unit_name(library.header.unit), fmt::join(methods, " and "));
  if (!settings.workshop.folder.empty()) {
    const auto options = engine::parse_parameters(library.header.parameters);
    if (!options) return options.error();
    found += fmt::format("\nparts are trained in {}", settings.workshop.folder);
  }
  if (!settings.examples.empty())
    found += fmt::format("\n{}: examples: {}", settings.examples, examples->size());
  return found;
}

Result<void> serve(const ServeSettings& settings, const Context& context) {
  std::signal(SIGHUP, [](int) { reload_asked = true; });
  MemoryTrim memory;
  Result<std::vector<Example>> examples = examples_of(settings);
  if (!examples) return examples.error();
  const Result<std::unique_ptr<Session>> session = session_of(settings, context);
  if (!session) return session.error();
  Daemon daemon(settings.listen, settings.max_waiting_mb);
  Result<std::shared_ptr<const LibraryGeneration>> first = load_generation(settings.files(), 1);
  if (!first) return first.error();

  Metrics metrics;
  RecognitionService service(settings.service(), *first);
  first = std::shared_ptr<const LibraryGeneration>();
  std::optional<LibrarySlot> slot(std::in_place, settings.files(), service, metrics, daemon.log());
  std::unique_ptr<PartWorkshop> workshop;
  if (!settings.workshop.folder.empty()) {
    auto opened = PartWorkshop::open(
        settings.workshop, settings.library,
        [&](LibrarySlot::Done done) { slot->reload(std::move(done)); }, daemon.log());
    if (!opened) return opened.error();
    workshop = *std::move(opened);
  }
  std::unique_ptr<LiveScans> live;
  if (!settings.live.folder.empty()) {
    auto watched = LiveScans::watch(settings.live, service, metrics, daemon.log());
    if (!watched) return watched.error();
    live = *std::move(watched);
  }
  ServiceRoutes routes(
      service, metrics, daemon.log(),
      {milliseconds(settings.listen.deadline_ms), settings.service().max_waiting_bytes},
      std::move(*examples), [&](LibrarySlot::Done done) { slot->reload(std::move(done)); },
      {workshop.get(), live.get(), session->get()});
  routes.set_num_connections([&] { return daemon.num_connections(); });
  if (const Result<void> started = daemon.start(routes); !started) return started.error();
  routes.set_ready(true);
  context.console.line(fmt::format("serving {} on {}", settings.library, daemon.url()));
  notify_systemd("READY=1");
  wait(context.stop, *slot, daemon.log(), service, memory);

  notify_systemd("STOPPING=1");
  daemon.drain([&] { routes.set_ready(false); },
               [&](ServiceClock::time_point deadline) { return service.drain(deadline); });
  live.reset();
  workshop.reset();
  slot.reset();  // a library that is being read is answered for, too
  daemon.tell_end();
  return {};
}

}  // namespace

void add_serve(CLI::App& app, Context& context) {
  add_daemon<ServeSettings>(
      app, context, "serve",
      "Recognize over HTTP, with a page to try it\n\n"
      "POST /v1/recognize?format=ply takes a scan as its body and the options of `trivet "
      "recognize`\n"
      "as parameters; / is the page. SIGHUP or POST /v1/library/reload read the library anew;\n"
      "SIGTERM answers what came in, then ends.",
      {serve, check});
}

}  // namespace trivet::apps
