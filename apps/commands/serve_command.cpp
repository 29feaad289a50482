#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/service/daemon.hpp"
#include "apps/service/serve/library/library_slot.hpp"
#include "apps/service/serve/memory_trim.hpp"
#include "apps/service/serve/notify_systemd.hpp"
#include "apps/service/serve/requests/examples.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "apps/service/serve/serve_settings.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/service/serve/session/session.hpp"
#include "engine/options/method.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps {
namespace {

using namespace service;

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{50};

/// Handles SIGHUP.
void reload(LibrarySlot& slot, Daemon& daemon) {
  RequestLog& log = daemon.log();
  notify_systemd("RELOADING=1");
  (void)daemon.read_tokens();  // reports its errors itself
  slot.reload([&log](const Result<void>& done) {
    notify_systemd("READY=1");
    if (done) {
      log.write("info", "library reloaded");
    } else {
      log.write("error", "library not reloaded", {{"error", done.error().message}});
    }
  });
}

/// Waits until it is stopped.
void wait(const std::stop_token& stop, LibrarySlot& slot, Daemon& daemon,
          const RecognitionService& service, MemoryTrim& memory) {
  const auto watchdog = watchdog_interval();
  auto last_notice = ServiceClock::now();
  Daemon::wait(stop, kPollInterval, [&] {
    const ServiceState state = service.state();
    memory.trim(state.num_running + state.num_waiting > 0);
    // Twice as often as required.
    if (watchdog && ServiceClock::now() - last_notice >= *watchdog / 2 && !state.is_stuck) {
      notify_systemd("WATCHDOG=1");
      last_notice = ServiceClock::now();
    }
    if (Daemon::received_sighup()) reload(slot, daemon);
  });
}

/// Opens a session, and warns of damaged files in it.
Result<std::unique_ptr<Session>> open_session(const ServeSettings& settings,
                                              const Context& context) {
  Result<std::unique_ptr<Session>> session =
      Session::open(settings.session, std::uint64_t{settings.session_mb} << 20);
  if (!session) return session;
  const SessionContents contents = (*session)->contents();
  for (const DamagedFile& damaged : contents.damaged) {
    context.console.warning(
        fmt::format("{}: {}: {}", settings.session, damaged.file, damaged.reason));
  }
  return session;
}

/// Everything that a service opens before it listens. A check of the settings opens the same, so
/// that valid settings are sure to start. No training has started yet.
struct OpenedService {
  explicit OpenedService(const ServeSettings& settings)
      : daemon(settings.listen, settings.max_waiting_mb) {}

  Daemon daemon;
  Metrics metrics;
  std::vector<Example> examples;  // this and the following members: none if not requested
  std::unique_ptr<Session> session;
  std::optional<RecognitionService> service;
  std::optional<LibrarySlot> slot;
  std::unique_ptr<PartWorkshop> workshop;
  std::unique_ptr<LiveScans> live;
};

/// files   files of the library, which is verified completely if its options require it
/// Errors: the first error, with the messages of all.
Result<std::unique_ptr<OpenedService>> open_service(const ServeSettings& settings,
                                                    const LibraryFiles& files,
                                                    const Context& context) {
  auto opened = std::make_unique<OpenedService>(settings);
  std::vector<Error> faults;
  const auto collect = [&](auto result, auto& into) {
    if (result) {
      into = *std::move(result);
    } else if (std::ranges::find(faults, result.error().message, &Error::message) == faults.end()) {
      faults.push_back(result.error());
    }
  };
  if (!settings.examples.empty()) collect(list_examples(settings.examples), opened->examples);
  if (!settings.session.empty()) collect(open_session(settings, context), opened->session);

  std::shared_ptr<const LibraryGeneration> first;
  collect(load_generation(files, 1), first);
  if (first) {
    opened->service.emplace(settings.service(), std::move(first));
    opened->slot.emplace(settings.files(), *opened->service, opened->metrics, opened->daemon.log());
  }
  if (!settings.workshop.folder.empty()) {
    const auto reload = [&slot = opened->slot](LibrarySlot::Done done) {
      slot->reload(std::move(done));
    };
    collect(PartWorkshop::open(settings.workshop, settings.library, reload, opened->daemon.log()),
            opened->workshop);
  }
  if (!settings.live.folder.empty() && opened->service) {
    collect(
        LiveScans::watch(settings.live, *opened->service, opened->metrics, opened->daemon.log()),
        opened->live);
  } else if (!settings.live.folder.empty()) {
    Parameters ignored;
    collect(LiveScans::check(settings.live), ignored);
  }
  if (const Result<void> read = opened->daemon.read_tokens(); !read) faults.push_back(read.error());
  if (faults.empty()) return opened;
  std::vector<std::string_view> sentences;
  sentences.reserve(faults.size());
  for (const Error& fault : faults) sentences.emplace_back(fault.message);
  return Error{faults.front().code, fmt::format("{}", fmt::join(sentences, "\nerror: "))};
}

/// Opens everything that a service with these settings opens, with the library verified completely,
/// and prints the result.
Result<void> check(const ServeSettings& settings, const Context& context) {
  LibraryFiles files = settings.files();
  files.options.verify = true;
  const auto opened = open_service(settings, files, context);
  if (!opened) return opened.error();
  const Library& library = (*opened)->service->generation()->recognizer.library();
  std::vector<std::string_view> methods;
  if (library.has_pairs()) {
    methods.push_back(name_of(Source::ppf));
  }
  if (library.basis.components.size() > 0) methods.push_back(name_of(Source::trisi));
  std::string found = fmt::format("{}: {} model{} [{}], for method {}", settings.library,
                                  library.models.size(), library.models.size() == 1 ? "" : "s",
                                  unit_name(library.header.unit), fmt::join(methods, " and "));
  if (!settings.workshop.folder.empty())
    found += fmt::format("\nparts are trained in {}", settings.workshop.folder);
  if (!settings.session.empty()) found += fmt::format("\nscans are kept in {}", settings.session);
  if (!settings.live.folder.empty())
    found += fmt::format("\nscans are taken from {}", settings.live.folder);
  if (!settings.examples.empty())
    found += fmt::format("\n{}: examples: {}", settings.examples, (*opened)->examples.size());
  context.console.line(found);
  context.console.line("the configuration is good");
  return {};
}

Result<void> serve(const ServeSettings& settings, const Context& context) {
  Daemon::handle_sighup();
  wait_for_memory_on_this_thread();
  MemoryTrim memory;
  auto made = open_service(settings, settings.files(), context);
  if (!made) return made.error();
  OpenedService& opened = **made;
  Daemon& daemon = opened.daemon;
  if (opened.workshop) opened.workshop->start();
  ServiceRoutes routes(
      *opened.service, opened.metrics, daemon.log(),
      {milliseconds(settings.listen.deadline_ms), settings.service().max_waiting_bytes,
       settings.service().max_working_bytes, settings.read_only},
      {std::move(opened.examples),
       [&](LibrarySlot::Done done) { opened.slot->reload(std::move(done)); }, opened.workshop.get(),
       opened.live.get(), opened.session.get()});
  routes.set_num_connections([&] { return daemon.num_connections(); });
  TRIVET_TRY(daemon.start(routes));
  routes.set_ready(true);
  context.console.line(fmt::format("serving {} on {}", settings.library, daemon.url()));
  notify_systemd("READY=1");
  wait(context.stop, *opened.slot, daemon, *opened.service, memory);

  notify_systemd("STOPPING=1");
  daemon.drain([&] { routes.set_ready(false); },
               [&](ServiceClock::time_point deadline) { return opened.service->drain(deadline); });
  opened.live.reset();
  opened.workshop.reset();
  opened.slot.reset();  // a library that is being loaded also sends a response
  daemon.log_end();
  return {};
}

}  // namespace

void add_serve(CLI::App& app, Context& context) {
  CLI::App* const command = app.add_subcommand(
      "serve",
      "Recognize over HTTP, with a page to try it\n\n"
      "POST /v1/recognize?format=ply takes a scan as its body and the options of `trivet "
      "recognize`\n"
      "as parameters; / is the page. SIGHUP or POST /v1/library/reload reload the library;\n"
      "SIGTERM answers what came in, then ends.");
  auto arguments = std::make_shared<SettingArguments>();
  ServeSettings defaults;
  add_settings(*command, settings_of(defaults), *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context]() -> Result<void> {
      ServeSettings settings;
      TRIVET_TRY(read_settings(settings, *arguments));
      return arguments->check_config ? check(settings, context) : serve(settings, context);
    };
  });
}

}  // namespace trivet::apps
