#include "apps/serve/service_routes.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "apps/detections_json.hpp"
#include "apps/inputs.hpp"
#include "apps/recognise_arguments.hpp"
#include "apps/serve/inference_protocol.hpp"
#include "apps/serve/query.hpp"
#include "storage/read_cloud.hpp"

namespace trivet::apps {
namespace {

using Json = nlohmann::ordered_json;

HttpResponse json_response(unsigned status, const Json& json) {
  return {status, json.dump() + "\n", "application/json", {}};
}

HttpResponse error_response(unsigned status, const std::string& reason) {
  return json_response(status, {{"error", reason}});
}

/// sysexits and HTTP speak of the same faults.
unsigned status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
    case ErrorCode::bad_data:
    case ErrorCode::missing_input:
      return 400;
    case ErrorCode::cannot_create:
    case ErrorCode::io:
    case ErrorCode::resumable:
    case ErrorCode::internal:
      return 500;
  }
  return 500;
}

constexpr double kMaxDeadlineMs = 3.6e6;

/// What the inference protocol calls the library.
std::string model_name(const Library& library) { return library.file.stem().string(); }

bool is_plain(const std::string& id) {
  return !id.empty() && id.size() <= 128 && std::ranges::all_of(id, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
}

/// The client's, or one of our own.
std::string request_id(const HttpRequest& request) {
  const std::string given = request.header("x-request-id");
  if (is_plain(given)) return given;
  thread_local std::mt19937_64 random{std::random_device{}()};
  return fmt::format("{:016x}", random());
}

/// What a body is, by the parameter `format` or its content type.
Result<std::string> format_of(const Target& target, const std::string& content_type) {
  static const std::set<std::string> known{"ply", "pcd", "obj", "stl", "off", "xyz", "png"};
  if (const std::optional<std::string> format = target.parameter("format")) {
    if (known.contains(*format)) return *format;
    return Error{ErrorCode::usage, fmt::format("format: expected one of {}, found '{}'",
                                               fmt::join(known, ", "), *format)};
  }
  if (content_type == "image/png") return std::string("png");
  if (content_type == "application/ply" || content_type == "model/ply") return std::string("ply");
  return Error{ErrorCode::usage, fmt::format("expected the parameter format, one of {}, found none",
                                             fmt::join(known, ", "))};
}

struct RecogniseQuery {
  RecogniseOptions options;
  ServedScene scene;
};

/// The options of `trivet recognize`, with the same names, ranges and words for what is wrong.
Result<RecogniseQuery> parse_options(
    const std::vector<std::pair<std::string, std::string>>& parameters) {
  RecogniseArguments arguments;
  RecogniseQuery query;
  CLI::App app;
  add_recognise_options(app, arguments);
  // Names a file of this machine.
  app.remove_option(app.get_option("--expected"));
  app.add_option("--camera", query.scene.camera)->delimiter(',')->expected(4, 5);
  app.add_option("--viewpoint", query.scene.viewpoint)->delimiter(',')->expected(3);
  app.add_option("--unit", query.scene.unit)->check(CLI::IsMember({"m", "mm"}));
  std::vector<std::string> words;
  for (const auto& [name, value] : parameters) {
    if (name == "format") continue;
    words.push_back("--" + name + (value.empty() ? "" : "=" + value));
  }
  std::ranges::reverse(words);  // as the parser takes them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return Error{ErrorCode::usage, error.what()};
  }
  Result<RecogniseOptions> options = options_of(arguments);
  if (!options) return options.error();
  if (const Result<void> valid = validate(*options); !valid) return valid.error();
  query.options = std::move(*options);
  return query;
}

Result<Cloud> read_body(const std::string& body, const std::string& format,
                        const ServedScene& scene) {
  ReadOptions options;
  if (!scene.camera.empty()) {
    const std::vector<double>& c = scene.camera;
    options.camera = Camera{c[0], c[1], c[2], c[3], c.size() > 4 ? c[4] : 1};
  }
  return read_cloud(std::as_bytes(std::span(body)), "body." + format, options);
}

Json stage_seconds(const ServiceAnswer& answer) {
  return {{"queue", answer.queue_seconds}, {"work", answer.work_seconds}};
}

HttpResponse refused(Refusal refusal) {
  switch (refusal) {
    case Refusal::full: {
      HttpResponse response = error_response(503, "as many requests wait as may");
      response.headers.emplace_back("Retry-After", "1");
      return response;
    }
    case Refusal::too_late:
      return error_response(504, "the deadline passed");
    case Refusal::gone:
      return error_response(499, "the client closed the connection");
    case Refusal::closed:
      return error_response(503, "the service is being shut down");
  }
  return error_response(500, "unknown refusal");
}

std::string_view reason_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::full:
      return "full";
    case Refusal::too_late:
      return "deadline";
    case Refusal::gone:
      return "gone";
    case Refusal::closed:
      return "closed";
  }
  return "";
}

bool has_method(const HttpRequest& request, std::string_view method, const HttpAnswer& reply) {
  if (request.method == method) return true;
  HttpResponse response =
      error_response(405, fmt::format("expected {}, found {}", method, request.method));
  response.headers.emplace_back("Allow", std::string(method));
  reply(std::move(response));
  return false;
}

}  // namespace

void ServiceRoutes::recognise(HttpRequest request, HttpAnswer answer, const std::string& id) {
  const auto fail = [&](const Error& error) {
    answer(error_response(status_of(error.code), error.message));
  };
  const Result<Target> target = parse_target(request.target);
  if (!target) return fail(target.error());
  const Result<std::string> format = format_of(*target, request.header("content-type"));
  if (!format) return fail(format.error());
  Result<RecogniseQuery> query = parse_options(target->parameters);
  if (!query) return fail(query.error());
  const Result<ServiceClock::time_point> deadline = deadline_of(request);
  if (!deadline) return fail(deadline.error());

  ServiceJob job;
  job.num_bytes = request.body.size();
  job.inputs.push_back(input_of(query->scene));
  job.read = [body = std::make_shared<const std::string>(std::move(request.body)), name = *format,
              scene = query->scene](std::size_t) { return read_body(*body, name, scene); };
  job.options = std::move(query->options);
  job.deadline = *deadline;
  job.is_gone = std::move(request.is_gone);

  submit(std::move(job), std::move(answer), [id](const ServiceAnswer& found) {
    Json scenes = Json::array();
    for (const SceneResult& result : found.results) scenes.push_back(scene_json("body", result));
    const Library& library = found.generation->recogniser.library();
    return json_response(
        200,
        {{"request_id", id},
         {"library",
          {{"file", library.file.filename().string()}, {"generation", found.generation->number}}},
         {"seconds", stage_seconds(found)},
         {"scenes", std::move(scenes)}});
  });
}

void ServiceRoutes::infer(HttpRequest request, HttpAnswer answer) {
  const auto fail = [&](const Error& error) {
    answer(error_response(status_of(error.code), error.message));
  };
  std::optional<std::size_t> header_size;
  if (const std::string given = request.header("inference-header-content-length"); !given.empty()) {
    std::size_t size = 0;
    const auto end = std::from_chars(given.data(), given.data() + given.size(), size).ptr;
    if (end != given.data() + given.size()) {
      return fail(
          {ErrorCode::usage, "Inference-Header-Content-Length: expected a number of bytes"});
    }
    header_size = size;
  }
  Result<InferenceRequest> inference = parse_inference(request.body, header_size);
  if (!inference) return fail(inference.error());
  Result<RecogniseQuery> query = parse_options(inference->options);
  if (!query) return fail(query.error());
  const Result<ServiceClock::time_point> deadline = deadline_of(request);
  if (!deadline) return fail(deadline.error());

  ServiceJob job;
  job.num_bytes = request.body.size() + inference->points.size() * 24;
  Cloud cloud;
  for (std::size_t i = 0; i < inference->points.size(); ++i) {
    if (inference->points[i].allFinite()) {
      cloud.points.push_back(inference->points[i]);
    } else {
      ++cloud.num_invalid;
    }
  }
  inference->points = Points();
  SceneInput input = input_of(query->scene);
  if (inference->viewpoint) input.viewpoint = inference->viewpoint;
  job.inputs.push_back(std::move(input));
  // A copyable function, for a cloud that is handed over once.
  job.read = [points = std::make_shared<Cloud>(std::move(cloud))](std::size_t) -> Result<Cloud> {
    return std::move(*points);
  };
  job.options = std::move(query->options);
  job.deadline = *deadline;
  job.is_gone = std::move(request.is_gone);
  submit(std::move(job), std::move(answer),
         [asked = std::move(*inference)](const ServiceAnswer& found) {
           const std::string model = model_name(found.generation->recogniser.library());
           InferenceResponse response =
               write_inference(asked, found.results.front(), model, found.generation->number);
           if (response.header_size == response.body.size())
             return HttpResponse{200, std::move(response.body), "application/json", {}};
           return HttpResponse{
               200,
               std::move(response.body),
               "application/octet-stream",
               {{"Inference-Header-Content-Length", std::to_string(response.header_size)}}};
         });
}

void ServiceRoutes::submit(ServiceJob job, HttpAnswer answer,
                           std::function<HttpResponse(const ServiceAnswer&)> write) {
  const auto begun = ServiceClock::now();
  service_.submit(std::move(job), [this, answer = std::move(answer), write = std::move(write),
                                   begun](const ServiceOutcome& outcome) {
    if (const Refusal* const refusal = std::get_if<Refusal>(&outcome)) {
      metrics_.count_rejection(std::string(reason_of(*refusal)));
      return answer(refused(*refusal));
    }
    if (const Error* const error = std::get_if<Error>(&outcome))
      return answer(error_response(status_of(error->code), error->message));
    const ServiceAnswer& found = std::get<ServiceAnswer>(outcome);
    metrics_.observe_queue(found.queue_seconds);
    for (const SceneResult& result : found.results) {
      for (const auto& [stage, seconds] : result.stats.times.seconds)
        metrics_.observe_stage(stage, seconds);
    }
    metrics_.observe_request(std::chrono::duration<double>(ServiceClock::now() - begun).count());
    answer(write(found));
  });
}

Result<ServiceClock::time_point> ServiceRoutes::deadline_of(const HttpRequest& request) const {
  std::chrono::milliseconds deadline = options_.default_deadline;
  if (const std::string asked = request.header("x-deadline-ms"); !asked.empty()) {
    char* end = nullptr;
    const double value = std::strtod(asked.c_str(), &end);
    if (*end != '\0' || !(value > 0) || value > kMaxDeadlineMs) {
      return Error{ErrorCode::usage,
                   fmt::format("X-Deadline-Ms: expected above 0 to {:.0f}, found '{}'",
                               kMaxDeadlineMs, asked)};
    }
    deadline = std::chrono::milliseconds(static_cast<std::int64_t>(value));
  }
  return ServiceClock::now() + deadline;
}

SceneInput ServiceRoutes::input_of(const ServedScene& scene) const {
  SceneInput input;
  if (const std::vector<float>& v = scene.viewpoint; !v.empty())
    input.viewpoint = Eigen::Vector3f(v[0], v[1], v[2]);
  const LengthUnit library_unit = service_.generation()->recogniser.library().header.unit;
  if (!scene.unit.empty()) input.scale = unit_scale(parse_unit(scene.unit), library_unit);
  return input;
}

HttpResponse ServiceRoutes::models() const {
  const auto generation = service_.generation();
  Json models = Json::array();
  for (const Model& model : generation->recogniser.library().models) {
    models.push_back({{"name", model.name},
                      {"diameter", model.diameter},
                      {"symmetries", model.symmetry.poses.size()},
                      {"symmetry_axis", model.symmetry.axis.has_value()}});
  }
  return json_response(200, {{"generation", generation->number},
                             {"unit", unit_name(generation->recogniser.library().header.unit)},
                             {"models", std::move(models)}});
}

HttpResponse ServiceRoutes::metrics() const {
  const ServiceState state = service_.state();
  const auto generation = service_.generation();
  const Library& library = generation->recogniser.library();
  std::error_code error;
  const auto bytes = std::filesystem::file_size(library.file, error);
  return {200,
          metrics_.text({state.num_waiting, state.num_running, state.num_bytes,
                         num_connections_ ? num_connections_() : 0, library.models.size(),
                         error ? 0 : static_cast<std::size_t>(bytes), generation->number}),
          "text/plain; version=0.0.4",
          {}};
}

void ServiceRoutes::handle(HttpRequest request, HttpAnswer answer) {
  const std::string path = request.target.substr(0, request.target.find('?'));
  const std::string id = request_id(request);
  const std::string trace = request.header("traceparent");
  auto finish = [this, path, id, trace, answer = std::move(answer)](const std::string& route) {
    return [this, route, id, trace, answer](HttpResponse response) {
      metrics_.count_request(route, response.status);
      response.headers.emplace_back("X-Request-Id", id);
      if (!trace.empty()) response.headers.emplace_back("traceparent", trace);
      answer(std::move(response));
    };
  };
  const auto needs = [&](std::string_view method, const HttpAnswer& reply) {
    return has_method(request, method, reply);
  };
  if (path == "/v1/recognize") {
    const HttpAnswer reply = finish("recognize");
    if (needs("POST", reply)) recognise(std::move(request), reply, id);
  } else if (path == "/v1/models") {
    const HttpAnswer reply = finish("models");
    if (needs("GET", reply)) reply(models());
  } else if (path == "/v1/library/reload") {
    const HttpAnswer reply = finish("reload");
    if (!needs("POST", reply)) return;
    reload_([this, reply](const Result<void>& done) {
      reply(done ? json_response(200, {{"generation", service_.generation()->number}})
                 : error_response(409, done.error().message));
    });
  } else if (path == "/v2/health/live") {
    const bool live = !service_.state().is_stuck;
    finish("live")(json_response(live ? 200 : 503, {{"live", live}}));
  } else if (path == "/v2/health/ready") {
    finish("ready")(json_response(is_ready_ ? 200 : 503, {{"ready", is_ready_.load()}}));
  } else if (path == "/v2") {
    finish("server")(json_response(200, {{"name", "trivet"},
                                         {"version", TRIVET_VERSION},
                                         {"extensions", Json::array({"binary_tensor_data"})}}));
  } else if (path.starts_with("/v2/models/")) {
    handle_model(path.substr(std::string_view("/v2/models/").size()), std::move(request), finish);
  } else if (path == "/metrics") {
    const HttpAnswer reply = finish("metrics");
    if (needs("GET", reply)) reply(metrics());
  } else {
    finish("other")(error_response(404, "no such path"));
  }
}

void ServiceRoutes::handle_model(std::string rest, HttpRequest request,
                                 const std::function<HttpAnswer(const std::string&)>& finish) {
  const auto generation = service_.generation();
  const std::string model = model_name(generation->recogniser.library());
  const std::string version = std::to_string(generation->number);
  const auto cut = [&rest](const std::string& front) {
    if (!rest.starts_with(front)) return false;
    rest.erase(0, front.size());
    return true;
  };
  if (!cut(model) || (cut("/versions/") && !cut(version)))
    return finish("model")(
        error_response(404, fmt::format("expected model {}, version {}", model, version)));
  if (rest.empty()) {
    const HttpAnswer reply = finish("model");
    if (has_method(request, "GET", reply))
      reply(json_response(200, inference_metadata(model, generation->number)));
  } else if (rest == "/ready") {
    finish("model_ready")(
        json_response(is_ready_ ? 200 : 503, {{"name", model}, {"ready", is_ready_.load()}}));
  } else if (rest == "/infer") {
    const HttpAnswer reply = finish("infer");
    if (has_method(request, "POST", reply)) infer(std::move(request), reply);
  } else {
    finish("other")(error_response(404, "no such path"));
  }
}

}  // namespace trivet::apps
