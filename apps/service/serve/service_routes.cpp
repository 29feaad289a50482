#include "apps/service/serve/service_routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>

#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/score_words.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/serve/inference_protocol.hpp"
#include "apps/service/serve/openapi.hpp"
#include "apps/service/serve/page.hpp"
#include "apps/service/serve/scan_request.hpp"
#include "storage/file.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kDefaultShownPoints = 250'000, kMaxShownPoints = 5'000'000;
constexpr std::uint64_t kMaxExampleBytes = 256 << 20;

/// What the inference protocol calls the library.
std::string model_name(const Library& library) { return library.file.stem().string(); }

/// The points of a scan as floats, at most so many of them: spread over all without a pattern.
std::string shown_points(const Points& points, std::size_t max_points) {
  std::string bytes;
  const double share = static_cast<double>(max_points) / static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Fibonacci hashing: the fractions of multiples of the golden ratio are evenly spread.
    const double place = static_cast<double>(i * 0x9E37'79B9'7F4A'7C15ULL) * 0x1p-64;
    if (place >= share || bytes.size() >= 3 * sizeof(float) * max_points) continue;
    const Eigen::Vector3f p = points[i];
    bytes.append(reinterpret_cast<const char*>(p.data()), 3 * sizeof(float));
  }
  return bytes;
}

Json symmetry_json(const Symmetry& symmetry) {
  return {{"poses", symmetry.poses.size()}, {"axis", symmetry.axis.has_value()}};
}

}  // namespace

struct ServiceRoutes::Route {
  std::string_view method, path;
  bool is_prefix;  ///< more may follow
  bool is_work;    ///< goes through the queue, and has a body
  std::string_view name;
  void (ServiceRoutes::*handle)(const CallPtr&, std::string_view rest);
};

const std::vector<ServiceRoutes::Route>& ServiceRoutes::routes() {
  using R = ServiceRoutes;
  static const std::vector<Route> all{
      {"POST", "/v1/recognize", false, true, "recognize", &R::recognize},
      {"POST", "/v1/points", false, true, "points", &R::points},
      {"GET", "/v1/models", false, false, "models", &R::list_models},
      {"GET", "/v1/models/", true, false, "model", &R::view_model},
      {"GET", "/v1/examples", true, false, "examples", &R::examples},
      {"GET", "/v1/score-parts", false, false, "score_parts", &R::score_parts},
      {"POST", "/v1/library/reload", false, false, "reload", &R::reload},
      {"GET", "/v1/openapi.json", false, false, "openapi", &R::openapi},
      {"GET", "/v2", false, false, "server", &R::server},
      {"GET", "/v2/health/live", false, false, "live", &R::live},
      {"GET", "/v2/health/ready", false, false, "ready", &R::ready},
      {"GET", "/v2/models/", true, false, "inference_model", &R::inference_model},
      {"POST", "/v2/models/", true, true, "infer", &R::infer},
      {"GET", "/metrics", false, false, "metrics", &R::metrics},
      {"GET", "/", true, false, "page", &R::page},
  };
  return all;
}

void ServiceRoutes::handle(HttpRequest request, HttpAnswer answer) {
  const auto call = std::make_shared<Call>(std::move(request), std::move(answer));
  Result<Target> target = parse_target(call->request.target);
  if (!target) return reply(call, error_response(target.error()));
  call->target = std::move(*target);
  const std::string& path = call->target.path;
  const Route* other_method = nullptr;
  for (const Route& route : routes()) {
    if (route.is_prefix ? !path.starts_with(route.path) : path != route.path) continue;
    if (route.method != call->request.method) {
      if (route.path != "/") other_method = &route;
      continue;
    }
    if (other_method && route.path == "/") break;
    call->route = route.name;
    return (this->*route.handle)(call, std::string_view(path).substr(route.path.size()));
  }
  if (!other_method) return reply(call, error_response(404, "no such path"));
  reply(call, method_response(other_method->method, call->request));
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
                           std::function<HttpResponse(const ServiceAnswer&)> write) {
  job.num_bytes += call->num_bytes;
  job.is_gone = call->request.is_gone;
  const Result<ServiceClock::time_point> deadline =
      deadline_of(call->request, options_.default_deadline);
  if (!deadline) return reply(call, error_response(deadline.error()));
  job.deadline = *deadline;
  service_.submit(std::move(job),
                  [this, call, write = std::move(write)](const ServiceOutcome& outcome) {
                    call->is_logged = true;
                    if (const Refusal* const refusal = std::get_if<Refusal>(&outcome)) {
                      metrics_.count_rejection(std::string(reason_of(*refusal)));
                      call->told["refusal"] = reason_of(*refusal);
                      return reply(call, refusal_response(*refusal));
                    }
                    if (const Error* const error = std::get_if<Error>(&outcome)) {
                      call->told["error"] = error->message;
                      return reply(call, error_response(*error));
                    }
                    const ServiceAnswer& found = std::get<ServiceAnswer>(outcome);
                    call->told["generation"] = found.generation->number;
                    call->told["queue_seconds"] = found.queue_seconds;
                    call->told["work_seconds"] = found.work_seconds;
                    reply(call, write(found));
                  });
}

void ServiceRoutes::submit_one(const CallPtr& call,
                               std::function<Result<HttpResponse>(const LibraryGeneration&)> work) {
  const auto response = std::make_shared<HttpResponse>();
  ServiceJob job;
  job.work = [work = std::move(work), response](std::size_t, const LibraryGeneration& generation,
                                                const std::stop_token&) -> Result<void> {
    Result<HttpResponse> done = work(generation);
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

void ServiceRoutes::recognize(const CallPtr& call, std::string_view) {
  Result<ScanRequest> asked = parse_scan_request(call->request, call->target);
  if (!asked) return reply(call, error_response(asked.error()));
  struct State {
    ScanRequest request;
    std::vector<SceneResult> results;
  };
  const std::size_t num_scans = asked->scans.size();
  const auto state =
      std::make_shared<State>(State{std::move(*asked), std::vector<SceneResult>(num_scans)});
  ServiceJob job;
  job.num_parts = num_scans;
  job.work = [this, state](std::size_t i, const LibraryGeneration& generation,
                           const std::stop_token& stop) -> Result<void> {
    const ScanPart& scan = state->request.scans[i];
    const auto begun = ServiceClock::now();
    const Result<Cloud> cloud =
        read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene);
    if (!cloud) return cloud.error();
    metrics_.observe_stage("decode",
                           std::chrono::duration<double>(ServiceClock::now() - begun).count());
    Result<SceneResult> result =
        trivet::recognize(generation.recognizer, *cloud,
                          scan.scene.input(generation.recognizer.library().header.unit),
                          state->request.options, stop);
    if (!result) return result.error();
    state->results[i] = std::move(*result);
    return {};
  };
  submit(call, std::move(job), [this, call, state](const ServiceAnswer& found) {
    tell_recognition(call, found, state->results);
    Json scenes = Json::array();
    for (std::size_t i = 0; i < state->results.size(); ++i) {
      scenes.push_back(scene_json(state->request.scans[i].name, state->results[i],
                                  found.generation->recognizer.score(),
                                  state->request.options.max_rejected > 0));
    }
    const Library& library = found.generation->recognizer.library();
    return json_response(
        200, {{"request_id", call->id},
              {"library",
               {{"file", library.file.filename().string()},
                {"generation", found.generation->number},
                {"calibration", calibration_json(found.generation->recognizer)}}},
              {"seconds", {{"queue", found.queue_seconds}, {"work", found.work_seconds}}},
              {"scenes", std::move(scenes)}});
  });
}

void ServiceRoutes::points(const CallPtr& call, std::string_view) {
  Target target = call->target;
  const std::optional<std::string> given = target.parameter("max-points");
  const std::size_t max_points = given ? whole_number(*given).value_or(0) : kDefaultShownPoints;
  if (max_points < 1 || max_points > kMaxShownPoints) {
    return reply(call, error_response(400, fmt::format("max-points: expected 1 to {}, found '{}'",
                                                       kMaxShownPoints, *given)));
  }
  std::erase_if(target.parameters, [](const auto& entry) { return entry.first == "max-points"; });
  Result<ScanRequest> asked = parse_scan_request(call->request, std::move(target));
  if (!asked) return reply(call, error_response(asked.error()));
  if (asked->scans.size() != 1)
    return reply(call, error_response(400, "form: expected one part scene"));
  submit_one(call,
             [asked = std::make_shared<ScanRequest>(std::move(*asked)),
              max_points](const LibraryGeneration&) -> Result<HttpResponse> {
               const ScanPart& scan = asked->scans.front();
               const Result<Cloud> cloud =
                   read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene);
               if (!cloud) return cloud.error();
               return HttpResponse{200,
                                   shown_points(cloud->points, max_points),
                                   kBytes,
                                   {{"X-Points", std::to_string(cloud->points.size())}}};
             });
}

void ServiceRoutes::list_models(const CallPtr& call, std::string_view) {
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  Json models = Json::array();
  for (const Model& model : library.models) {
    const auto view = [&](const char* what) {
      return write_target({fmt::format("/v1/models/{}/{}", model.name, what), {}});
    };
    models.push_back({{"name", model.name},
                      {"diameter", model.diameter},
                      {"symmetry", symmetry_json(model.symmetry)},
                      {"thumbnail", view("thumbnail.png")},
                      {"mesh", view("mesh.ply")}});
  }
  reply(call, json_response(200, {{"library", library.file.filename().string()},
                                  {"generation", generation->number},
                                  {"unit", unit_name(library.header.unit)},
                                  {"models", std::move(models)}}));
}

void ServiceRoutes::view_model(const CallPtr& call, std::string_view rest) {
  const std::size_t slash = rest.rfind('/');  // a name may have some, too
  const std::string name(rest.substr(0, slash));
  const std::string_view view = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (view != "mesh.ply" && view != "thumbnail.png")
    return reply(call, error_response(404, "expected mesh.ply or thumbnail.png of a model"));
  submit_one(call,
             [this, name, is_mesh = view == "mesh.ply"](
                 const LibraryGeneration& generation) -> Result<HttpResponse> {
               const Model* const model = find_model(generation.recognizer.library(), name);
               if (!model) return error_response(404, fmt::format("no model '{}'", name));
               if (is_mesh) return HttpResponse{200, model_mesh(*model), "model/ply", {}};
               Result<std::string> png = thumbnails_.of(generation, *model);
               if (!png) return png.error();
               return HttpResponse{200, std::move(*png), "image/png", {}};
             });
}

void ServiceRoutes::examples(const CallPtr& call, std::string_view rest) {
  if (rest.empty()) {
    Json list = Json::array();
    for (std::size_t i = 0; i < examples_.size(); ++i) {
      list.push_back({{"name", examples_[i].name},
                      {"query", examples_[i].query},
                      {"url", fmt::format("/v1/examples/{}", i)}});
    }
    return reply(call, json_response(200, {{"examples", std::move(list)}}));
  }
  const std::optional<std::size_t> index = whole_number(rest.substr(1));
  if (rest.front() != '/' || !index || *index >= examples_.size())
    return reply(call, error_response(404, "no such example"));
  submit_one(
      call, [file = examples_[*index].file](const LibraryGeneration&) -> Result<HttpResponse> {
        const Result<MappedFile> bytes = MappedFile::open(file, kMaxExampleBytes);
        if (!bytes) return error_response(404, "the example's file is gone");
        const std::span<const std::byte> view = bytes->bytes();
        return HttpResponse{
            200, std::string(reinterpret_cast<const char*>(view.data()), view.size()), kBytes, {}};
      });
}

void ServiceRoutes::score_parts(const CallPtr& call, std::string_view) {
  const auto generation = service_.generation();
  const kernels::ScoreModel& score = generation->recognizer.score();
  const auto independent = most_evidence(score, 0), shared = most_evidence(score, 1);
  Json parts = Json::array();
  for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k) {
    const PartWords words = words_of(k);
    parts.push_back({{"name", kernels::kScoreParts[k].name},
                     {"label", words.label},
                     {"meaning", words.meaning},
                     {"most_evidence", {independent[k], shared[k]}}});
  }
  reply(call, json_response(200, {{"bias", score.bias}, {"parts", std::move(parts)}}));
}

void ServiceRoutes::reload(const CallPtr& call, std::string_view) {
  reload_([this, call](const Result<void>& done) {
    reply(call, done ? json_response(200, {{"generation", service_.generation()->number}})
                     : error_response(409, done.error().message));
  });
}

void ServiceRoutes::openapi(const CallPtr& call, std::string_view) {
  reply(call, {200, std::string(openapi_document()), "application/json", {}});
}

void ServiceRoutes::live(const CallPtr& call, std::string_view) {
  const bool live = !service_.state().is_stuck;
  reply(call, json_response(live ? 200 : 503, {{"live", live}}));
}

void ServiceRoutes::ready(const CallPtr& call, std::string_view) {
  const bool ready = is_ready_;
  reply(call, json_response(ready ? 200 : 503, {{"ready", ready}}));
}

void ServiceRoutes::server(const CallPtr& call, std::string_view) {
  reply(call, json_response(200, {{"name", "trivet"},
                                  {"version", TRIVET_VERSION},
                                  {"extensions", Json::array({"binary_tensor_data"})}}));
}

void ServiceRoutes::metrics(const CallPtr& call, std::string_view) {
  const ServiceState state = service_.state();
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  reply(call, metrics_.tell({state.num_waiting, state.num_running, state.num_bytes,
                             num_connections_ ? num_connections_() : 0, library.models.size(),
                             library.file_bytes, generation->number, log_.num_dropped()}));
}

void ServiceRoutes::page(const CallPtr& call, std::string_view rest) {
  const PageFile* const file = find_page_file(rest.empty() ? "index.html" : rest);
  if (!file && rest.empty()) {
    return reply(call, error_response(404,
                                      "this program was built without the page: run "
                                      "scripts/build-web and build it again"));
  }
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

namespace {

/// What a path behind /v2/models/ asks for: NAME[/versions/N] of the library that answers, and the
/// rest. Errors: usage (another name or version).
Result<std::string_view> rest_of_model(std::string_view rest, const LibraryGeneration& generation) {
  const std::string model = model_name(generation.recognizer.library());
  const std::string version = std::to_string(generation.number);
  const auto cut = [&rest](std::string_view front) {
    if (!rest.starts_with(front)) return false;
    rest.remove_prefix(front.size());
    return true;
  };
  if (!cut(model) || (cut("/versions/") && !cut(version))) {
    return Error{ErrorCode::usage, fmt::format("expected model {}, version {}", model, version)};
  }
  return rest;
}

}  // namespace

void ServiceRoutes::inference_model(const CallPtr& call, std::string_view rest) {
  const auto generation = service_.generation();
  const Result<std::string_view> asked = rest_of_model(rest, *generation);
  if (!asked) return reply(call, error_response(404, asked.error().message));
  const std::string model = model_name(generation->recognizer.library());
  if (asked->empty())
    return reply(call, json_response(200, inference_metadata(model, generation->number)));
  if (*asked != "/ready") return reply(call, error_response(404, "no such path"));
  const bool ready = is_ready_;
  reply(call, json_response(ready ? 200 : 503, {{"name", model}, {"ready", ready}}));
}

void ServiceRoutes::infer(const CallPtr& call, std::string_view rest) {
  const Result<std::string_view> asked = rest_of_model(rest, *service_.generation());
  if (!asked) return reply(call, error_response(404, asked.error().message));
  if (*asked != "/infer") return reply(call, error_response(404, "no such path"));
  const std::string given = call->request.header("inference-header-content-length");
  const std::optional<std::size_t> header_size = whole_number(given);
  if (!given.empty() && !header_size) {
    return reply(
        call, error_response(400, "Inference-Header-Content-Length: expected a number of bytes"));
  }
  struct State {
    InferenceRequest request;
    SceneResult result;
  };
  const auto state = std::make_shared<State>();
  ServiceJob job;
  job.work = [call, header_size, state](std::size_t, const LibraryGeneration& generation,
                                        const std::stop_token& stop) -> Result<void> {
    Result<InferenceRequest> request = parse_inference(call->request.body, header_size);
    if (!request) return request.error();
    state->request = std::move(*request);
    Result<RecognizeQuery> query = parse_recognize_query(state->request.options);
    if (!query) return query.error();
    SceneInput input = query->scene.input(generation.recognizer.library().header.unit);
    if (state->request.viewpoint) input.viewpoint = state->request.viewpoint;
    Result<SceneResult> result = trivet::recognize(
        generation.recognizer, take_cloud(state->request), input, query->options, stop);
    if (!result) return result.error();
    state->result = std::move(*result);
    return {};
  };
  submit(call, std::move(job), [this, call, state](const ServiceAnswer& found) {
    tell_recognition(call, found, {&state->result, 1});
    InferenceResponse done = write_inference(state->request, state->result,
                                             model_name(found.generation->recognizer.library()),
                                             found.generation->number);
    if (done.header_size == done.body.size())
      return HttpResponse{200, std::move(done.body), "application/json", {}};
    return HttpResponse{200,
                        std::move(done.body),
                        kBytes,
                        {{"Inference-Header-Content-Length", std::to_string(done.header_size)}}};
  });
}

}  // namespace trivet::apps::service
