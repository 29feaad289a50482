#include "apps/service/serve/routes/part_routes.hpp"

#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/library/model_json.hpp"
#include "apps/service/serve/library/model_views.hpp"
#include "apps/service/serve/library/near_turns.hpp"
#include "storage/datasets/parse_symmetry.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kAccepted = 202, kConflict = 409;

HttpResponse done_response(const Result<void>& done) {
  return done ? json_response(kAccepted, Json::object()) : error_response(done.error());
}

Result<LengthUnit> parse_unit(const std::string& text) {
  for (const LengthUnit unit : {LengthUnit::meter, LengthUnit::millimeter}) {
    if (text == unit_name(unit)) return unit;
  }
  return Error{ErrorCode::usage, fmt::format("unit: expected m or mm, found '{}'", text)};
}

/// Reads {"declaration": symmetries in the form of a manifest, or null for the detected ones}.
/// Errors: bad_data.
Result<std::optional<Symmetry>> parse_declaration(const std::string& body) {
  std::optional<Symmetry> symmetry;
  const Result<void> read =
      with_json(std::as_bytes(std::span(body)), "declaration", [&](const JsonNode& root) {
        if (!root.only({"declaration"}).value().contains("declaration"))
          root.refuse("expected a declaration, or null for none");
        if (root.has("declaration")) {
          symmetry = parse_symmetry(root.at("declaration").only({"symmetries", "symmetry_axis"}));
        }
      });
  if (!read) return read.error();
  return symmetry;
}

/// library  that of the draft; null: not trained
Json draft_json(const DraftStatus& draft, const Library* library) {
  Json error, model;
  if (!draft.error.empty()) error = draft.error;
  if (library) {
    model = model_json(library->models.front());
    model["mesh"] = encode_path(fmt::format("/v1/parts/{}/mesh.ply", draft.name));
  }
  return {{"name", draft.name},
          {"file", draft.file},
          {"bytes", draft.num_bytes},
          {"unit", unit_name(draft.unit)},
          {"state", name_of(draft.state)},
          {"seconds", draft.seconds},
          {"error", std::move(error)},
          {"facts", draft.facts},
          {"model", std::move(model)}};
}

}  // namespace

Routes PartRoutes::routes() const {
  using std::bind_front;
  return {
      {"PUT", "/v1/models/", true, false, Effect::changes, "publish_part",
       bind_front(&PartRoutes::publish_part, this)},
      {"PATCH", "/v1/models/", true, false, Effect::changes, "rename_model",
       bind_front(&PartRoutes::rename_model, this)},
      {"DELETE", "/v1/models/", true, false, Effect::changes, "remove_model",
       bind_front(&PartRoutes::remove_model, this)},
      {"GET", "/v1/parts", false, false, Effect::reads, "parts",
       bind_front(&PartRoutes::list_parts, this)},
      {"GET", "/v1/parts/", true, false, Effect::reads, "part",
       bind_front(&PartRoutes::view_part, this)},
      {"PUT", "/v1/parts/", true, true, Effect::changes, "bring_part",
       bind_front(&PartRoutes::bring_part, this)},
      {"PATCH", "/v1/parts/", true, false, Effect::changes, "declare_part",
       bind_front(&PartRoutes::declare_part, this)},
      {"DELETE", "/v1/parts/", true, false, Effect::changes, "drop_part",
       bind_front(&PartRoutes::drop_part, this)},
  };
}

void PartRoutes::list_parts(const CallPtr& call, std::string_view) const {
  if (!workshop_) return responder_.reply(call, json_response(200, {{"allowed", false}}));
  Json parts = Json::array();
  for (const DraftStatus& draft : workshop_->drafts()) {
    const auto library = workshop_->trained(draft.name);
    parts.push_back(draft_json(draft, library.get()));
  }
  const WorkshopSettings& limits = workshop_->settings();
  responder_.reply(call, json_response(200, {{"allowed", true},
                                             {"max_bytes", std::uint64_t{limits.max_file_mb} << 20},
                                             {"max_seconds", limits.max_seconds},
                                             {"parts", std::move(parts)}}));
}

void PartRoutes::view_part(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  const std::size_t slash = rest.rfind('/');
  const std::string_view name = rest.substr(0, slash);
  const std::string_view view = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (view != "mesh.ply" && view != kNearSymmetry) {
    return responder_.reply(call,
                            error_response(404, "expected mesh.ply or near-symmetry of a part"));
  }
  const auto library = workshop_->trained(std::string(name));
  if (!library)
    return responder_.reply(call, error_response(404, fmt::format("no trained part '{}'", name)));
  if (view == "mesh.ply") {
    const Result<const ModelSurface*> surface = library->surface(0);
    return responder_.reply(call, surface
                                      ? HttpResponse{200, model_mesh(**surface), "model/ply", {}}
                                      : error_response(surface.error()));
  }
  responder_.run_small(call, [library](const LibraryGeneration&) -> Result<HttpResponse> {
    return json_result(near_turns_json(*library, 0));
  });
}

void PartRoutes::bring_part(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  const std::size_t most = std::size_t{workshop_->settings().max_file_mb} << 20;
  if (call->request.body.size() > most) {
    return responder_.reply(
        call, error_response(413, fmt::format("expected a part of at most {} bytes, found {}", most,
                                              call->request.body.size())));
  }
  const Result<LengthUnit> unit = parse_unit(call->target.parameter("unit").value_or(""));
  if (!unit) return responder_.reply(call, error_response(unit.error()));
  responder_.run_small(
      call,
      [this, name = std::string(rest), unit = *unit,
       file = call->target.parameter("file").value_or(""),
       body = std::move(call->request.body)](const LibraryGeneration&) -> Result<HttpResponse> {
        if (const auto refused = workshop_->refuse_folder(name))
          return error_response(kConflict, *refused);
        return done_response(workshop_->bring(name, file, unit, body));
      });
}

void PartRoutes::declare_part(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  const Result<std::optional<Symmetry>> symmetry = parse_declaration(call->request.body);
  if (!symmetry) return responder_.reply(call, error_response(symmetry.error()));
  responder_.reply(call, done_response(workshop_->declare(std::string(rest), *symmetry)));
}

void PartRoutes::drop_part(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  const std::string name(rest);
  if (!workshop_->has(name)) {
    const auto refused = workshop_->refuse_folder(name);
    return responder_.reply(call, refused ? error_response(kConflict, *refused)
                                          : error_response(404, fmt::format("no part '{}'", name)));
  }
  responder_.reply(call, done_response(workshop_->drop(name)));
}

void PartRoutes::publish_part(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  workshop_->publish(std::string(rest), responder_.reply_generation(call));
}

void PartRoutes::remove_model(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  workshop_->remove(std::string(rest), responder_.reply_generation(call));
}

void PartRoutes::rename_model(const CallPtr& call, std::string_view rest) const {
  if (!has_workshop(call)) return;
  workshop_->rename(std::string(rest), call->target.parameter("name").value_or(""),
                    responder_.reply_generation(call));
}

bool PartRoutes::has_workshop(const CallPtr& call) const {
  if (workshop_) return true;
  responder_.reply(
      call,
      error_response(403, "expected a service started with --allow-training; this one only reads"));
  return false;
}

}  // namespace trivet::apps::service
