#include "apps/service/serve/routes/inference_routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/inference/metadata.hpp"
#include "apps/service/serve/inference/protocol.hpp"
#include "apps/service/serve/requests/recognize_query.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

/// Limit of the JSON that is parsed on the network thread.
constexpr std::size_t kShortJson = 64 << 10;

double seconds_since(ServiceClock::time_point begun) {
  return std::chrono::duration<double>(ServiceClock::now() - begun).count();
}

/// The most memory that an inference uses in addition to its body. A point of a binary tensor is 12
/// bytes; two bytes of JSON may become a number, a node of 16 bytes and its place.
std::size_t tensor_bytes(std::size_t body_bytes, std::optional<std::size_t> header_size) {
  constexpr std::size_t kTensorPoint = 12, kJsonNumber = 2, kJsonNode = 24;
  const std::size_t json = std::min(body_bytes, header_size.value_or(body_bytes));
  const std::size_t num_points = (body_bytes - json) / kTensorPoint + json / (3 * kJsonNumber);
  return scene_bytes(num_points) + json / kJsonNumber * kJsonNode;
}

/// The name of the library in the inference protocol.
std::string model_name(const Library& library) { return library.file.stem().string(); }

/// The rest of a path after /v2/models/NAME[/versions/N], where NAME is the current library.
/// Errors: usage (another name or version).
Result<std::string_view> rest_of_model(std::string_view path, const LibraryGeneration& generation) {
  const std::string model = model_name(generation.recognizer.library());
  const std::string version = std::to_string(generation.number);
  std::string_view rest = path;
  const auto cut = [&rest](std::string_view front) {
    const bool is_there =
        rest.starts_with(front) && (rest.size() == front.size() || rest[front.size()] == '/');
    if (is_there) rest.remove_prefix(front.size());
    return is_there;
  };
  if (!cut(model) || (cut("/versions") && !cut("/" + version))) {
    return Error{ErrorCode::usage,
                 fmt::format("expected model {}, version {}, found '{}'", model, version, path)};
  }
  return rest;
}

/// Whether a request for the repository index has {"ready": true} and so asks for ready models
/// only.
/// Errors: bad_data.
Result<bool> asks_for_ready(std::string_view body) {
  bool only_ready = false;
  if (body.size() > kShortJson) {
    return Error{ErrorCode::bad_data, fmt::format("request: expected at most {} bytes, found {}",
                                                  kShortJson, body.size())};
  }
  if (body.empty()) return only_ready;
  const Result<void> done =
      with_json(std::as_bytes(std::span(body)), "request", [&](const JsonNode& root) {
        if (root.object().has("ready")) only_ready = root.at("ready").boolean();
      });
  if (!done) return done.error();
  return only_ready;
}

/// An inference in progress.
struct Inference {
  InferenceRequest request;
  SceneResult result;
  double input_seconds = 0, output_seconds = 0;
};

Result<void> run_inference(Call& call, std::optional<std::size_t> header_size,
                           const LibraryGeneration& generation, const std::stop_token& stop,
                           Inference& out) {
  const auto begun = ServiceClock::now();
  Result<InferenceRequest> request = parse_inference(call.request.body, header_size);
  if (!request) return request.error();
  out.request = std::move(*request);
  call.set_timeout(out.request.timeout);
  Result<RecognizeQuery> query = parse_recognize_query(out.request.options);
  if (!query) return query.error();
  SceneInput input = query->scene.input(generation.recognizer.library().header.unit);
  if (out.request.viewpoint) input.viewpoint = out.request.viewpoint->cast<double>();
  const Cloud cloud = extract_cloud(out.request);
  out.input_seconds = seconds_since(begun);
  Result<SceneResult> result =
      trivet::recognize(generation.recognizer, cloud, input, query->options, stop);
  if (!result) return result.error();
  out.result = std::move(*result);
  return {};
}

HttpResponse inference_response(Inference& inference, const ServiceAnswer& answer) {
  const auto begun = ServiceClock::now();
  InferenceResponse written = write_inference(inference.request, inference.result,
                                              model_name(answer.generation->recognizer.library()),
                                              answer.generation->number);
  inference.output_seconds = seconds_since(begun);
  if (written.header_size == written.body.size())
    return {200, std::move(written.body), "application/json", {}};
  return {200,
          std::move(written.body),
          kBytes,
          {{"Inference-Header-Content-Length", std::to_string(written.header_size)}}};
}

}  // namespace

Routes InferenceRoutes::routes() {
  using std::bind_front;
  return {
      {"POST", "/v2/repository/index", false, false, Effect::reads, "repository",
       bind_front(&InferenceRoutes::repository, this)},
      {"GET", "/v2/models/stats", false, false, Effect::reads, "inference_statistics",
       bind_front(&InferenceRoutes::view_statistics, this)},
      {"GET", "/v2/models/", true, false, Effect::reads, "inference_model",
       bind_front(&InferenceRoutes::view_model, this)},
      {"POST", "/v2/models/", true, true, Effect::reads, "infer",
       bind_front(&InferenceRoutes::infer, this)},
  };
}

void InferenceRoutes::view_model(const CallPtr& call, std::string_view rest) const {
  const auto generation = service_.generation();
  const Result<std::string_view> view = rest_of_model(rest, *generation);
  if (!view) return responder_.reply(call, error_response(404, view.error().message));
  const std::string model = model_name(generation->recognizer.library());
  if (view->empty())
    return responder_.reply(call,
                            json_response(200, inference_metadata(model, generation->number)));
  if (*view == "/config")
    return responder_.reply(call, json_response(200, inference_configuration(model)));
  if (*view == "/stats")
    return responder_.reply(call, json_response(200, statistics_.json(model, generation->number)));
  if (*view != "/ready") return responder_.reply(call, error_response(404, "no such path"));
  const bool ready = is_ready_;
  responder_.reply(call, json_response(ready ? 200 : 503, {{"name", model}, {"ready", ready}}));
}

void InferenceRoutes::view_statistics(const CallPtr& call, std::string_view) const {
  const auto generation = service_.generation();
  responder_.reply(call,
                   json_response(200, statistics_.json(model_name(generation->recognizer.library()),
                                                       generation->number)));
}

void InferenceRoutes::repository(const CallPtr& call, std::string_view) const {
  const Result<bool> only_ready = asks_for_ready(call->request.body);
  if (!only_ready) return responder_.reply(call, error_response(only_ready.error()));
  const auto generation = service_.generation();
  responder_.reply(
      call, json_response(200, repository_index(model_name(generation->recognizer.library()),
                                                generation->number, is_ready_, *only_ready)));
}

void InferenceRoutes::infer(const CallPtr& call, std::string_view rest) {
  const auto generation = service_.generation();
  const Result<std::string_view> view = rest_of_model(rest, *generation);
  if (!view) return responder_.reply(call, error_response(404, view.error().message));
  if (*view != "/infer") return responder_.reply(call, error_response(404, "no such path"));
  const std::string given = call->request.header("inference-header-content-length");
  const std::optional<std::size_t> header_size = whole_number(given);
  if (!given.empty() && !header_size) {
    return responder_.reply(
        call, error_response(400, "Inference-Header-Content-Length: expected a number of bytes"));
  }
  count_failures(call, generation->number);
  // A timeout after more JSON than that is read when the request leaves the queue.
  const std::string_view json =
      std::string_view(call->request.body).substr(0, header_size.value_or(std::string::npos));
  if (json.size() <= kShortJson) call->set_timeout(inference_timeout(json));
  const auto inference = std::make_shared<Inference>();
  ServiceJob job;
  job.part_bytes = tensor_bytes(call->num_bytes, header_size);
  job.work = [call, header_size, inference](std::size_t, const LibraryGeneration& answering,
                                            const std::stop_token& stop) {
    return run_inference(*call, header_size, answering, stop, *inference);
  };
  responder_.run(
      call, std::move(job),
      [inference](const ServiceAnswer& answer) { return inference_response(*inference, answer); },
      [this, call, inference](const ServiceAnswer& answer) {
        responder_.note_recognition(call, answer, {&inference->result, 1});
        statistics_.count_success(
            answer.generation->number,
            {call->seconds(), answer.queue_seconds, inference->input_seconds,
             answer.work_seconds - inference->input_seconds - inference->output_seconds,
             inference->output_seconds});
      });
}

/// Counts an error response to the call.
void InferenceRoutes::count_failures(const CallPtr& call, std::uint64_t generation) {
  call->answer = [this, generation, begun = ServiceClock::now(),
                  answer = std::move(call->answer)](HttpResponse response) {
    if (response.status >= 400) statistics_.count_failure(generation, seconds_since(begun));
    answer(std::move(response));
  };
}

}  // namespace trivet::apps::service
