// What keeps scans, answers and truth.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/multipart.hpp"
#include "apps/service/serve/scan_request.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/service/serve/session/session.hpp"
#include "engine/scene/find_view.hpp"

namespace trivet::apps::service {
namespace {

/// Of a library that outlives what it returns.
ModelOfName models_of(const LibraryGeneration& generation) {
  return [&generation](const std::string& name) -> std::optional<SessionModel> {
    const Library& library = generation.recognizer.library();
    const Model* const model = find_model(library, name);
    if (!model) return std::nullopt;
    const auto index = static_cast<std::uint32_t>(model - library.models.data());
    if (!library.check(index, ModelPart::surface)) return std::nullopt;
    return SessionModel{model->symmetry, library.header.unit, generation.number,
                        [model] { return model_mesh(*model); }};
  };
}

/// With the viewpoint that a recognition would find out, since a manifest must say it. Errors: those
/// of read_scan and find_view.
Result<ScanReading> reading_of(const ScanPart& scan, LengthUnit library_unit) {
  const Result<Cloud> cloud =
      read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene, library_unit);
  if (!cloud) return cloud.error();
  ScanReading reading{scan.name.substr(scan.name.rfind('.') + 1),
                      scan.scene.unit.value_or(library_unit), scan.scene.camera,
                      scan.scene.viewpoint};
  if (reading.camera || reading.viewpoint) return reading;
  const Result<SceneView> view = engine::find_view(*cloud, scan.scene.input(library_unit));
  if (!view) return view.error();
  if (view->kind != SceneKind::surface && view->source != ViewSource::file)
    reading.viewpoint = view->viewpoint;
  return reading;
}

/// The names in a path, as RUN/NAME; none where it has another number of them.
std::optional<std::pair<std::string, std::string>> two_names(std::string_view path) {
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos || path.find('/', slash + 1) != std::string_view::npos)
    return std::nullopt;
  return std::pair{std::string(path.substr(0, slash)), std::string(path.substr(slash + 1))};
}

}  // namespace

bool ServiceRoutes::has_session(const CallPtr& call) const {
  if (commissioning_.session) return true;
  reply(call, error_response(404, "no session is kept: start the service with --session DIR"));
  return false;
}

void ServiceRoutes::session(const CallPtr& call, std::string_view) {
  if (!commissioning_.session) return reply(call, json_response(200, {{"kept", false}}));
  reply(call, json_response(200, commissioning_.session->index()));
}

void ServiceRoutes::session_archive(const CallPtr& call, std::string_view) {
  if (has_session(call)) reply(call, commissioning_.session->archive());
}

void ServiceRoutes::session_scan(const CallPtr& call, std::string_view rest) {
  if (has_session(call)) reply(call, commissioning_.session->scan(std::string(rest)));
}

void ServiceRoutes::put_session_scan(const CallPtr& call, std::string_view rest) {
  if (!has_session(call)) return;
  if (const auto names = two_names(rest); names && names->second == "truth") {
    return submit_one(call, [this, call, name = names->first](const LibraryGeneration& generation) {
      return commissioning_.session->put_truth(
          name, call->request.body, call->request.header("if-match"), models_of(generation));
    });
  }
  if (is_form(call->request.header("content-type")))
    return reply(call, error_response(400, "expected the scan as the body, found a form"));
  Result<ScanRequest> asked = parse_scan_request(call->request, call->target);
  if (!asked) return reply(call, error_response(asked.error()));
  const ScanPart& kept = asked->scans.front();
  const std::size_t part_bytes = scan_bytes(std::as_bytes(std::span(kept.bytes)), kept.name);
  submit_one(
      call,
      [this, asked = std::make_shared<ScanRequest>(std::move(*asked)),
       name = std::string(rest)](const LibraryGeneration& generation) -> Result<HttpResponse> {
        const ScanPart& scan = asked->scans.front();
        const Result<ScanReading> reading =
            reading_of(scan, generation.recognizer.library().header.unit);
        if (!reading) return reading.error();
        return commissioning_.session->put_scan(name, scan.bytes, *reading);
      },
      part_bytes);
}

void ServiceRoutes::delete_session_scan(const CallPtr& call, std::string_view rest) {
  if (!has_session(call)) return;
  submit_one(call, [this, name = std::string(rest)](const LibraryGeneration&) {
    return commissioning_.session->delete_scan(name);
  });
}

void ServiceRoutes::session_answer(const CallPtr& call, std::string_view rest) {
  if (!has_session(call)) return;
  const auto names = two_names(rest);
  if (!names) return reply(call, error_response(404, "expected the names of a run and a scan"));
  reply(call, commissioning_.session->answer(names->first, names->second));
}

void ServiceRoutes::put_session_answer(const CallPtr& call, std::string_view rest) {
  if (!has_session(call)) return;
  const auto names = two_names(rest);
  if (!names) return reply(call, error_response(404, "expected the names of a run and a scan"));
  submit_one(call, [this, call, names = *names](const LibraryGeneration& generation) {
    return commissioning_.session->put_answer(names.first, names.second, call->request.body,
                                              call->request.header("if-match"),
                                              models_of(generation));
  });
}

void ServiceRoutes::delete_session_run(const CallPtr& call, std::string_view rest) {
  if (!has_session(call)) return;
  submit_one(call, [this, run = std::string(rest)](const LibraryGeneration&) {
    return commissioning_.session->delete_run(run);
  });
}

}  // namespace trivet::apps::service
