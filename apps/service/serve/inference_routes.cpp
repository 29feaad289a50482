// The Open Inference Protocol.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/inference_protocol.hpp"
#include "apps/service/serve/recognize_query.hpp"
#include "apps/service/serve/service_routes.hpp"

namespace trivet::apps::service {
namespace {

/// What the inference protocol calls the library.
std::string model_name(const Library& library) { return library.file.stem().string(); }

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
