#include "apps/service/serve/routes/session_routes.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/multipart.hpp"
#include "apps/service/http/tar_stream.hpp"
#include "apps/service/serve/library/model_views.hpp"
#include "apps/service/serve/requests/scan_request.hpp"
#include "apps/service/serve/routes/session_json.hpp"
#include "apps/service/serve/session/session.hpp"
#include "engine/scene/find_view.hpp"
#include "storage/datasets/parse_truth.hpp"
#include "storage/files/json_file.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps::service {
namespace {

/// Finds models of a library that outlives the returned function.
ModelOfName models_of(const LibraryGeneration& generation) {
  return [&generation](const std::string& name) -> std::optional<SessionModel> {
    const Library& library = generation.recognizer.library();
    const std::optional<std::uint32_t> model = find_model(library, name);
    if (!model) return std::nullopt;
    const Result<const ModelSurface*> surface = library.surface(*model);
    if (!surface) return std::nullopt;
    return SessionModel{library.models[*model].symmetry, library.header.unit, generation.number,
                        [own = *surface] { return model_mesh(*own); }};
  };
}

/// How the scan is read, with the viewpoint that a recognition would estimate, since a manifest
/// must contain it.
/// Errors: those of read_scan and find_view.
Result<ScanReading> reading_of(const ScanPart& scan, LengthUnit library_unit) {
  const Result<Cloud> cloud =
      read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene, library_unit);
  if (!cloud) return cloud.error();
  ScanReading reading{scan.name.substr(scan.name.rfind('.') + 1),
                      scan.scene.unit.value_or(library_unit), scan.scene.camera,
                      scan.scene.viewpoint};
  if (reading.camera || reading.viewpoint) return reading;
  TRIVET_TRY_ASSIGN(const engine::FoundView found,
                    engine::find_view(*cloud, scan.scene.input(library_unit)));
  const SceneView& view = found.view;
  if (view.kind != SceneKind::surface && view.source != ViewSource::file)
    reading.viewpoint = view.viewpoint;
  return reading;
}

/// Reads {"truth": entries of a manifest, or null if unknown}. Errors: bad_data.
Result<ScanTruth> parse_scan_truth(const std::string& body, const ModelOfName& models) {
  ScanTruth truth;
  const Result<void> read =
      with_json(std::as_bytes(std::span(body)), "truth", [&](const JsonNode& root) {
        if (!root.only({"truth"}).has("truth")) return;
        truth.emplace();
        for (const JsonNode& entry : root.at("truth").elements()) {
          truth->push_back(parse_truth(entry));
          const std::string& model = truth->back().model;
          if (!is_model_name(model) || !models(model))
            entry.at("model").refuse("expected a model of the library");
        }
      });
  if (!read) return read.error();
  return truth;
}

/// The whole session as a tar file.
HttpResponse archive_response(const std::vector<SessionFile>& files) {
  std::vector<TarEntry> entries;
  entries.reserve(files.size());
  for (const SessionFile& file : files)
    entries.push_back({fmt::format("session/{}", file.name), file.file, file.num_bytes});
  HttpResponse response{200,
                        {},
                        "application/x-tar",
                        {{"Content-Disposition", "attachment; filename=\"session.tar\""}}};
  response.stream = tar_stream(std::move(entries));
  return response;
}

/// The response to a request that needs no job, for errors other than `failed`.
HttpResponse refusal_at_once(const SessionError& error) {
  Result<HttpResponse> response = session_error_response(error);
  return response ? *std::move(response) : error_response(response.error());
}

/// Splits a path of two names, such as RUN/NAME; none: another number of names.
std::optional<std::pair<std::string, std::string>> two_names(std::string_view path) {
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos || path.find('/', slash + 1) != std::string_view::npos)
    return std::nullopt;
  return std::pair{std::string(path.substr(0, slash)), std::string(path.substr(slash + 1))};
}

}  // namespace

Routes SessionRoutes::routes() const {
  using std::bind_front;
  return {
      {"GET", "/v1/session", false, false, Effect::reads, "session",
       bind_front(&SessionRoutes::index, this)},
      {"GET", "/v1/session/archive", false, false, Effect::reads, "session_archive",
       bind_front(&SessionRoutes::archive, this)},
      {"GET", "/v1/session/scans/", true, false, Effect::reads, "session_scan",
       bind_front(&SessionRoutes::get_scan, this)},
      {"PUT", "/v1/session/scans/", true, true, Effect::changes, "put_session_scan",
       bind_front(&SessionRoutes::put_scan, this)},
      {"DELETE", "/v1/session/scans/", true, false, Effect::changes, "delete_session_scan",
       bind_front(&SessionRoutes::delete_scan, this)},
      {"GET", "/v1/session/runs/", true, false, Effect::reads, "session_answer",
       bind_front(&SessionRoutes::get_answer, this)},
      {"PUT", "/v1/session/runs/", true, true, Effect::changes, "put_session_answer",
       bind_front(&SessionRoutes::put_answer, this)},
      {"DELETE", "/v1/session/runs/", true, false, Effect::changes, "delete_session_run",
       bind_front(&SessionRoutes::delete_run, this)},
  };
}

bool SessionRoutes::has_session(const CallPtr& call) const {
  if (session_) return true;
  responder_.reply(call,
                   error_response(404, "no session is kept: start the service with --session DIR"));
  return false;
}

void SessionRoutes::index(const CallPtr& call, std::string_view) const {
  if (!session_) return responder_.reply(call, json_response(200, {{"kept", false}}));
  responder_.reply(call,
                   json_response(200, session_json(session_->contents(), session_->max_bytes())));
}

void SessionRoutes::archive(const CallPtr& call, std::string_view) const {
  if (has_session(call)) responder_.reply(call, archive_response(session_->files()));
}

void SessionRoutes::get_scan(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  SessionResult<FileReader> file = session_->scan(std::string(rest));
  responder_.reply(call, file ? file_response(*std::move(file)) : refusal_at_once(file.error()));
}

void SessionRoutes::put_scan(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  if (const auto names = two_names(rest); names && names->second == "truth")
    return put_truth(call, names->first);
  if (is_form(call->request.header("content-type")))
    return responder_.reply(call,
                            error_response(400, "expected the scan as the body, found a form"));
  Result<ScanRequest> request = parse_scan_request(call->request, call->target);
  if (!request) return responder_.reply(call, error_response(request.error()));
  const ScanPart& part = request->scans.front();
  const std::size_t part_bytes = scan_bytes(std::as_bytes(std::span(part.bytes)), part.name);
  responder_.run_small(
      call,
      [this, request = std::make_shared<ScanRequest>(std::move(*request)),
       name = std::string(rest)](const LibraryGeneration& generation) -> Result<HttpResponse> {
        const ScanPart& scan = request->scans.front();
        const Result<ScanReading> reading =
            reading_of(scan, generation.recognizer.library().header.unit);
        if (!reading) return reading.error();
        const SessionResult<KeptScan> put = session_->put_scan(name, scan.bytes, *reading);
        if (!put) return session_error_response(put.error());
        return json_response(200, scan_json(*put));
      },
      part_bytes);
}

void SessionRoutes::put_truth(const CallPtr& call, const std::string& name) const {
  responder_.run_small(
      call, [this, call, name](const LibraryGeneration& generation) -> Result<HttpResponse> {
        const ModelOfName models = models_of(generation);
        const Result<ScanTruth> truth = parse_scan_truth(call->request.body, models);
        if (!truth) return truth.error();
        const SessionResult<KeptScan> put =
            session_->put_truth(name, *truth, call->request.header("if-match"), models);
        if (!put) return session_error_response(put.error());
        return json_response(200, scan_json(*put));
      });
}

void SessionRoutes::delete_scan(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  responder_.run_small(
      call, [this, name = std::string(rest)](const LibraryGeneration&) -> Result<HttpResponse> {
        const SessionResult<void> deleted = session_->delete_scan(name);
        if (!deleted) return session_error_response(deleted.error());
        return json_response(200, {{"deleted", name}});
      });
}

void SessionRoutes::get_answer(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  const auto names = two_names(rest);
  if (!names)
    return responder_.reply(call, error_response(404, "expected the names of a run and a scan"));
  SessionResult<OpenAnswer> answer = session_->answer(names->first, names->second);
  if (!answer) return responder_.reply(call, refusal_at_once(answer.error()));
  HttpResponse response = file_response(std::move((*answer).file), "application/json");
  response.headers.emplace_back("ETag", (*answer).version);
  responder_.reply(call, std::move(response));
}

void SessionRoutes::put_answer(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  const auto names = two_names(rest);
  if (!names)
    return responder_.reply(call, error_response(404, "expected the names of a run and a scan"));
  responder_.run_small(
      call,
      [this, call, names = *names](const LibraryGeneration& generation) -> Result<HttpResponse> {
        const auto& [run, scan] = names;
        SessionResult<std::string> version = session_->put_answer(
            run, scan, call->request.body, call->request.header("if-match"), models_of(generation));
        if (!version) return session_error_response(version.error());
        return json_response(200, {{"run", run}, {"scan", scan}, {"version", *std::move(version)}});
      });
}

void SessionRoutes::delete_run(const CallPtr& call, std::string_view rest) const {
  if (!has_session(call)) return;
  responder_.run_small(
      call, [this, run = std::string(rest)](const LibraryGeneration&) -> Result<HttpResponse> {
        const SessionResult<void> deleted = session_->delete_run(run);
        if (!deleted) return session_error_response(deleted.error());
        return json_response(200, {{"deleted", run}});
      });
}

}  // namespace trivet::apps::service
