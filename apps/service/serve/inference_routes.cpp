// The Open Inference Protocol.
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
#include "apps/service/serve/service_routes.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

/// JSON that is read on the network's thread.
constexpr std::size_t kShortJson = 64 << 10;

double seconds_since(ServiceClock::time_point begun) {
  return std::chrono::duration<double>(ServiceClock::now() - begun).count();
}

/// The most memory that an inference takes beside its body: a point of a binary tensor is 12 bytes,
/// and two bytes of JSON may become a number, a node of 16 and its place.
std::size_t tensor_bytes(std::size_t body_bytes, std::optional<std::size_t> header_size) {
  constexpr std::size_t kTensorPoint = 12, kJsonNumber = 2, kJsonNode = 24;
  const std::size_t json = std::min(body_bytes, header_size.value_or(body_bytes));
  const std::size_t num_points = (body_bytes - json) / kTensorPoint + json / (3 * kJsonNumber);
  return scene_bytes(num_points) + json / kJsonNumber * kJsonNode;
}

/// What the inference protocol calls the library.
std::string model_name(const Library& library) { return library.file.stem().string(); }

/// What a path behind /v2/models/ asks for: NAME[/versions/N] of the library that answers, and the
/// rest. Errors: usage (another name or version).
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

/// What a repository index is asked for: {"ready": true} for nothing but what answers. Errors:
/// bad_data.
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

}  // namespace

void ServiceRoutes::inference_model(const CallPtr& call, std::string_view rest) {
  const auto generation = service_.generation();
  const Result<std::string_view> asked = rest_of_model(rest, *generation);
  if (!asked) return reply(call, error_response(404, asked.error().message));
  const std::string model = model_name(generation->recognizer.library());
  if (asked->empty())
    return reply(call, json_response(200, inference_metadata(model, generation->number)));
  if (*asked == "/config") return reply(call, json_response(200, inference_configuration(model)));
  if (*asked == "/stats")
    return reply(call, json_response(200, inferences_.tell(model, generation->number)));
  if (*asked != "/ready") return reply(call, error_response(404, "no such path"));
  const bool ready = is_ready_;
  reply(call, json_response(ready ? 200 : 503, {{"name", model}, {"ready", ready}}));
}

void ServiceRoutes::inference_statistics(const CallPtr& call, std::string_view) {
  const auto generation = service_.generation();
  reply(call, json_response(200, inferences_.tell(model_name(generation->recognizer.library()),
                                                  generation->number)));
}

void ServiceRoutes::repository(const CallPtr& call, std::string_view) {
  const Result<bool> only_ready = asks_for_ready(call->request.body);
  if (!only_ready) return reply(call, error_response(only_ready.error()));
  const auto generation = service_.generation();
  reply(call, json_response(200, repository_index(model_name(generation->recognizer.library()),
                                                  generation->number, is_ready_, *only_ready)));
}

void ServiceRoutes::infer(const CallPtr& call, std::string_view rest) {
  const auto generation = service_.generation();
  const Result<std::string_view> asked = rest_of_model(rest, *generation);
  if (!asked) return reply(call, error_response(404, asked.error().message));
  if (*asked != "/infer") return reply(call, error_response(404, "no such path"));
  const std::string given = call->request.header("inference-header-content-length");
  const std::optional<std::size_t> header_size = whole_number(given);
  if (!given.empty() && !header_size) {
    return reply(
        call, error_response(400, "Inference-Header-Content-Length: expected a number of bytes"));
  }
  call->answer = [this, number = generation->number, begun = ServiceClock::now(),
                  answer = std::move(call->answer)](HttpResponse response) {
    if (response.status >= 400) inferences_.count_failure(number, seconds_since(begun));
    answer(std::move(response));
  };
  // A timeout behind more JSON than that is seen when the request's turn has come.
  const std::string_view json =
      std::string_view(call->request.body).substr(0, header_size.value_or(std::string::npos));
  if (json.size() <= kShortJson) call->set_timeout(inference_timeout(json));
  struct State {
    InferenceRequest request;
    SceneResult result;
    double input_seconds = 0, output_seconds = 0;
  };
  const auto state = std::make_shared<State>();
  ServiceJob job;
  job.part_bytes = tensor_bytes(call->num_bytes, header_size);
  job.work = [call, header_size, state](std::size_t, const LibraryGeneration& answering,
                                        const std::stop_token& stop) -> Result<void> {
    const auto begun = ServiceClock::now();
    Result<InferenceRequest> request = parse_inference(call->request.body, header_size);
    if (!request) return request.error();
    state->request = std::move(*request);
    call->set_timeout(state->request.timeout);
    Result<RecognizeQuery> query = parse_recognize_query(state->request.options);
    if (!query) return query.error();
    SceneInput input = query->scene.input(answering.recognizer.library().header.unit);
    if (state->request.viewpoint) input.viewpoint = state->request.viewpoint->cast<double>();
    const Cloud cloud = take_cloud(state->request);
    state->input_seconds = seconds_since(begun);
    Result<SceneResult> result =
        trivet::recognize(answering.recognizer, cloud, input, query->options, stop);
    if (!result) return result.error();
    state->result = std::move(*result);
    return {};
  };
  submit(
      call, std::move(job),
      [state](const ServiceAnswer& found) {
        const auto begun = ServiceClock::now();
        InferenceResponse done = write_inference(state->request, state->result,
                                                 model_name(found.generation->recognizer.library()),
                                                 found.generation->number);
        state->output_seconds = seconds_since(begun);
        if (done.header_size == done.body.size())
          return HttpResponse{200, std::move(done.body), "application/json", {}};
        return HttpResponse{
            200,
            std::move(done.body),
            kBytes,
            {{"Inference-Header-Content-Length", std::to_string(done.header_size)}}};
      },
      [this, call, state](const ServiceAnswer& found) {
        tell_recognition(call, found, {&state->result, 1});
        inferences_.count_success(
            found.generation->number,
            {call->seconds(), found.queue_seconds, state->input_seconds,
             found.work_seconds - state->input_seconds - state->output_seconds,
             state->output_seconds});
      });
}

}  // namespace trivet::apps::service
