#include "apps/service/serve/service_routes.hpp"

#include <fmt/format.h>

#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/openapi.hpp"
#include "apps/service/serve/page.hpp"
#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps::service {
namespace {

/// Of an answer: whether files or the library are others afterwards.
enum class Effect : std::uint8_t { reads, changes };

}  // namespace

struct ServiceRoutes::Route {
  std::string_view method, path;
  bool is_prefix;  ///< more may follow
  bool is_work;    ///< goes through the queue, and has a body
  Effect effect;
  std::string_view name;
  void (ServiceRoutes::*handle)(const CallPtr&, std::string_view rest);
};

const std::vector<ServiceRoutes::Route>& ServiceRoutes::routes() {
  using R = ServiceRoutes;
  static const std::vector<Route> all{
      {"POST", "/v1/recognize", false, true, Effect::reads, "recognize", &R::recognize},
      {"POST", "/v1/points", false, true, Effect::reads, "points", &R::points},
      {"GET", "/v1/models", false, false, Effect::reads, "models", &R::list_models},
      {"GET", "/v1/models/", true, false, Effect::reads, "model", &R::view_model},
      {"PUT", "/v1/models/", true, false, Effect::changes, "publish_part", &R::publish_part},
      {"PATCH", "/v1/models/", true, false, Effect::changes, "rename_model", &R::rename_model},
      {"DELETE", "/v1/models/", true, false, Effect::changes, "remove_model", &R::remove_model},
      {"GET", "/v1/parts", false, false, Effect::reads, "parts", &R::list_parts},
      {"GET", "/v1/parts/", true, false, Effect::reads, "part", &R::view_part},
      {"PUT", "/v1/parts/", true, true, Effect::changes, "bring_part", &R::bring_part},
      {"PATCH", "/v1/parts/", true, false, Effect::changes, "declare_part", &R::declare_part},
      {"DELETE", "/v1/parts/", true, false, Effect::changes, "drop_part", &R::drop_part},
      {"GET", "/v1/live", false, false, Effect::reads, "live_scans", &R::list_live},
      {"GET", "/v1/live/", true, false, Effect::reads, "live_scan", &R::view_live},
      {"GET", "/v1/examples", true, false, Effect::reads, "examples", &R::examples},
      {"GET", "/v1/session", false, false, Effect::reads, "session", &R::session},
      {"GET", "/v1/session/archive", false, false, Effect::reads, "session_archive",
       &R::session_archive},
      {"GET", "/v1/session/scans/", true, false, Effect::reads, "session_scan", &R::session_scan},
      {"PUT", "/v1/session/scans/", true, true, Effect::changes, "put_session_scan",
       &R::put_session_scan},
      {"DELETE", "/v1/session/scans/", true, false, Effect::changes, "delete_session_scan",
       &R::delete_session_scan},
      {"GET", "/v1/session/runs/", true, false, Effect::reads, "session_answer",
       &R::session_answer},
      {"PUT", "/v1/session/runs/", true, true, Effect::changes, "put_session_answer",
       &R::put_session_answer},
      {"DELETE", "/v1/session/runs/", true, false, Effect::changes, "delete_session_run",
       &R::delete_session_run},
      {"GET", "/v1/score-parts", false, false, Effect::reads, "score_parts", &R::score_parts},
      {"POST", "/v1/library/reload", false, false, Effect::changes, "reload", &R::reload},
      {"GET", "/v1/openapi.json", false, false, Effect::reads, "openapi", &R::openapi},
      {"GET", "/v2", false, false, Effect::reads, "server", &R::server},
      {"GET", "/v2/health/live", false, false, Effect::reads, "live", &R::live},
      {"GET", "/v2/health/ready", false, false, Effect::reads, "ready", &R::ready},
      {"POST", "/v2/repository/index", false, false, Effect::reads, "repository", &R::repository},
      {"GET", "/v2/models/stats", false, false, Effect::reads, "inference_statistics",
       &R::inference_statistics},
      {"GET", "/v2/models/", true, false, Effect::reads, "inference_model", &R::inference_model},
      {"POST", "/v2/models/", true, true, Effect::reads, "infer", &R::infer},
      {"GET", "/metrics", false, false, Effect::reads, "metrics", &R::metrics},
      {"GET", "/", true, false, Effect::reads, "page", &R::page},
  };
  return all;
}

ServiceRoutes::ServiceRoutes(RecognitionService& service, Metrics& metrics, RequestLog& log,
                             const RouteOptions& options, std::vector<Example> examples,
                             Reload reload, Commissioning commissioning)
    : service_(service),
      metrics_(metrics),
      log_(log),
      replies_(metrics, log),
      options_(options),
      examples_(std::move(examples)),
      reload_(std::move(reload)),
      commissioning_(commissioning) {
  for (const Route& route : routes()) {
    const std::string name(route.name);
    if (route.is_work) {
      metrics_.expect_requests(name, kCodesOfWork);
    } else {
      metrics_.expect_requests(name, kUsualCodes);
    }
  }
  metrics_.expect_requests("other", kCodesOfOthers);
}

void ServiceRoutes::handle(HttpRequest request, HttpAnswer answer) {
  const auto call = std::make_shared<Call>(std::move(request), std::move(answer));
  Result<Target> target = parse_target(call->request.target);
  if (!target) return reply(call, error_response(target.error()));
  call->target = std::move(*target);
  const std::string& path = call->target.path;
  std::string other_methods;
  for (const Route& route : routes()) {
    if (route.is_prefix ? !path.starts_with(route.path) : path != route.path) continue;
    if (route.method != call->request.method) {
      if (route.path == "/") continue;
      if (!other_methods.empty()) other_methods += ", ";
      other_methods += route.method;
      continue;
    }
    if (!other_methods.empty() && route.path == "/") break;
    call->route = route.name;
    if (route.effect == Effect::changes && options_.read_only) {
      count_refused(AccessFault::read_only);
      call->told["refusal"] = name_of(AccessFault::read_only);
      return reply(call, error_response(403,
                                        "expected a service without --read-only: this one "
                                        "recognizes, and changes nothing"));
    }
    return (this->*route.handle)(call, std::string_view(path).substr(route.path.size()));
  }
  if (other_methods.empty()) return reply(call, error_response(404, "no such path"));
  reply(call, method_response(other_methods, call->request));
}

bool ServiceRoutes::is_free(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  return path == "/v2/health/live" || path == "/v2/health/ready" || path == "/" ||
         (path.starts_with('/') && find_page_file(path.substr(1)));
}

std::optional<HttpResponse> ServiceRoutes::admit(std::string_view target, std::size_t body_bytes) {
  const std::string_view path = target.substr(0, target.find('?'));
  for (const Route& route : routes()) {
    if (!route.is_work || !path.starts_with(route.path)) continue;
    if (body_bytes > options_.max_waiting_bytes) {
      return error_response(413, fmt::format("expected a body of at most {} bytes, found {}",
                                             options_.max_waiting_bytes, body_bytes));
    }
    if (!service_.is_full(body_bytes)) return std::nullopt;
    metrics_.count_rejection(std::string(reason_of(Refusal::full)));
    metrics_.count_request(std::string(route.name), 503);
    return refusal_response(Refusal::full);
  }
  return std::nullopt;
}

void ServiceRoutes::submit(const CallPtr& call, ServiceJob job,
                           std::function<HttpResponse(const ServiceAnswer&)> write,
                           std::function<void(const ServiceAnswer&)> note) {
  if (job.part_bytes > options_.max_working_bytes) {
    constexpr std::size_t kMb = 1 << 20;
    metrics_.count_rejection(std::string(reason_of(Refusal::too_large)));
    return reply(
        call, error_response(413, fmt::format("expected scenes that need at most {} MB each, all "
                                              "that scenes may take, found one that may need {} "
                                              "MB by the size that it states; send fewer points, "
                                              "or serve with a larger --memory",
                                              options_.max_working_bytes / kMb,
                                              (job.part_bytes + kMb - 1) / kMb)));
  }
  job.num_bytes += call->num_bytes;
  job.is_gone = [call] { return call->is_overdue() || call->request.is_gone(); };
  const Result<ServiceClock::time_point> deadline =
      deadline_of(call->request, options_.default_deadline);
  if (!deadline) return reply(call, error_response(deadline.error()));
  job.deadline = *deadline;
  const auto response = std::make_shared<HttpResponse>();
  job.conclude = [response, write = std::move(write)](const ServiceAnswer& found) {
    *response = write(found);
  };
  service_.submit(std::move(job),
                  [this, call, response, note = std::move(note)](const ServiceOutcome& outcome) {
                    call->is_logged = true;
                    if (const Refusal* const refusal = std::get_if<Refusal>(&outcome)) {
                      const bool is_late = *refusal == Refusal::gone && call->is_overdue();
                      return refuse(call, is_late ? Refusal::too_late : *refusal);
                    }
                    if (const Error* const error = std::get_if<Error>(&outcome)) {
                      call->told["error"] = error->message;
                      return reply(call, error_response(*error));
                    }
                    const ServiceAnswer& found = std::get<ServiceAnswer>(outcome);
                    call->told["generation"] = found.generation->number;
                    call->told["queue_seconds"] = found.queue_seconds;
                    call->told["work_seconds"] = found.work_seconds;
                    if (note) note(found);
                    reply(call, std::move(*response));
                  });
}

void ServiceRoutes::refuse(const CallPtr& call, Refusal refusal) {
  metrics_.count_rejection(std::string(reason_of(refusal)));
  call->told["refusal"] = reason_of(refusal);
  reply(call, refusal_response(refusal));
}

void ServiceRoutes::submit_one(const CallPtr& call,
                               std::function<Result<HttpResponse>(const LibraryGeneration&)> work,
                               std::size_t part_bytes) {
  const auto response = std::make_shared<HttpResponse>();
  ServiceJob job;
  job.part_bytes = part_bytes;
  job.work = [work = std::move(work), response](std::size_t, const LibraryGeneration& generation,
                                                const std::stop_token&) -> Result<void> {
    const FailWithoutMemory scope;
    const Library& library = generation.recognizer.library();
    TRIVET_TRY(library.unchanged());
    Result<HttpResponse> done = work(generation);
    TRIVET_TRY(library.unchanged());
    if (!done) return done.error();
    *response = std::move(*done);
    return {};
  };
  submit(call, std::move(job), [response](const ServiceAnswer&) { return std::move(*response); });
}

void ServiceRoutes::tell_recognition(const CallPtr& call, const ServiceAnswer& found,
                                     std::span<const SceneResult> results) {
  std::size_t num_detections = 0;
  for (const SceneResult& result : results) {
    num_detections += result.detections.size();
    for (const auto& [stage, seconds] : result.stats.times.seconds)
      metrics_.observe_stage(stage, seconds);
  }
  metrics_.observe_queue(found.queue_seconds);
  metrics_.observe_request(call->seconds());
  call->told["scenes"] = results.size();
  call->told["detections"] = num_detections;
}

void ServiceRoutes::openapi(const CallPtr& call, std::string_view) {
  reply(call, {200, std::string(openapi_document()), "application/json", {}});
}

void ServiceRoutes::live(const CallPtr& call, std::string_view) {
  const bool live = !service_.state().is_stuck;
  reply(call, json_response(live ? 200 : 503, {{"live", live}}));
}

void ServiceRoutes::ready(const CallPtr& call, std::string_view) {
  const bool ready = is_ready_ && !service_.state().is_stuck &&
                     !service_.generation()->recognizer.library().is_changed();
  reply(call, json_response(ready ? 200 : 503, {{"ready", ready}}));
}

void ServiceRoutes::server(const CallPtr& call, std::string_view) {
  reply(call,
        json_response(200, {{"name", "trivet"},
                            {"version", TRIVET_VERSION},
                            {"extensions", nlohmann::ordered_json::array(
                                               {"binary_tensor_data", "model_configuration",
                                                "schedule_policy", "sequence", "statistics"})}}));
}

void ServiceRoutes::metrics(const CallPtr& call, std::string_view) {
  const ServiceState state = service_.state();
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  reply(call, metrics_.tell({state.num_waiting, state.num_running, state.num_bytes,
                             num_connections_ ? num_connections_() : 0, library.models.size(),
                             library.file_bytes, library.is_changed() ? 1U : 0U, generation->number,
                             log_.num_dropped()}));
}

void ServiceRoutes::page(const CallPtr& call, std::string_view rest) {
  const PageFile* const file = find_page_file(rest.empty() ? "index.html" : rest);
  if (!file && rest.empty()) return reply(call, no_page_response(call->request));
  if (!file) return reply(call, error_response(404, "no such path"));
  reply(call, {200,
               std::string(file->bytes),
               std::string(file->content_type),
               {{"Content-Security-Policy",
                 "default-src 'self'; img-src 'self' data: blob:; style-src 'self'; "
                 "frame-ancestors 'none'"},
                {"X-Content-Type-Options", "nosniff"},
                {"Cache-Control", "no-cache"}}});
}

}  // namespace trivet::apps::service
