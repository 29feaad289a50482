// What changes the library: parts that are brought, trained and published, models that go.
#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/library/model_json.hpp"
#include "apps/service/serve/library/near_turns.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "storage/datasets/parse_symmetry.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kAccepted = 202, kConflict = 409;

HttpResponse read_only_response() {
  return error_response(403,
                        "expected a service started with --allow-training; this one only reads");
}

HttpResponse done_response(const Result<void>& done) {
  return done ? json_response(kAccepted, Json::object()) : error_response(done.error());
}

Result<LengthUnit> parse_unit(const std::string& text) {
  for (const LengthUnit unit : {LengthUnit::meter, LengthUnit::millimeter}) {
    if (text == unit_name(unit)) return unit;
  }
  return Error{ErrorCode::usage, fmt::format("unit: expected m or mm, found '{}'", text)};
}

/// Of {"declaration": as a manifest declares symmetries, or null for what the program finds}. Errors:
/// bad_data.
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

/// library  of the draft; null: it is not trained
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

void ServiceRoutes::list_parts(const CallPtr& call, std::string_view) {
  if (!commissioning_.workshop) return reply(call, json_response(200, {{"allowed", false}}));
  Json parts = Json::array();
  for (const DraftStatus& draft : commissioning_.workshop->drafts()) {
    const auto library = commissioning_.workshop->trained(draft.name);
    parts.push_back(draft_json(draft, library.get()));
  }
  const WorkshopSettings& limits = commissioning_.workshop->settings();
  reply(call, json_response(200, {{"allowed", true},
                                  {"max_bytes", std::uint64_t{limits.max_file_mb} << 20},
                                  {"max_seconds", limits.max_seconds},
                                  {"parts", std::move(parts)}}));
}

void ServiceRoutes::view_part(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  const std::size_t slash = rest.rfind('/');
  const std::string_view name = rest.substr(0, slash);
  const std::string_view view = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (view != "mesh.ply" && view != kNearSymmetry) {
    return reply(call, error_response(404, "expected mesh.ply or near-symmetry of a part"));
  }
  const auto library = commissioning_.workshop->trained(std::string(name));
  if (!library) return reply(call, error_response(404, fmt::format("no trained part '{}'", name)));
  if (view == "mesh.ply")
    return reply(call, {200, model_mesh(library->models.front()), "model/ply", {}});
  submit_one(call, [library](const LibraryGeneration&) -> Result<HttpResponse> {
    return near_turns_response(*library, 0);
  });
}

void ServiceRoutes::bring_part(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  const std::size_t most = std::size_t{commissioning_.workshop->settings().max_file_mb} << 20;
  if (call->request.body.size() > most) {
    return reply(
        call, error_response(413, fmt::format("expected a part of at most {} bytes, found {}", most,
                                              call->request.body.size())));
  }
  const Result<LengthUnit> unit = parse_unit(call->target.parameter("unit").value_or(""));
  if (!unit) return reply(call, error_response(unit.error()));
  submit_one(
      call,
      [this, name = std::string(rest), unit = *unit,
       file = call->target.parameter("file").value_or(""),
       body = std::move(call->request.body)](const LibraryGeneration&) -> Result<HttpResponse> {
        if (const auto refused = commissioning_.workshop->refuse_folder(name))
          return error_response(kConflict, *refused);
        return done_response(commissioning_.workshop->bring(name, file, unit, body));
      });
}

void ServiceRoutes::declare_part(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  const Result<std::optional<Symmetry>> symmetry = parse_declaration(call->request.body);
  if (!symmetry) return reply(call, error_response(symmetry.error()));
  reply(call, done_response(commissioning_.workshop->declare(std::string(rest), *symmetry)));
}

void ServiceRoutes::drop_part(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  const std::string name(rest);
  if (!commissioning_.workshop->has(name)) {
    const auto refused = commissioning_.workshop->refuse_folder(name);
    return reply(call, refused ? error_response(kConflict, *refused)
                               : error_response(404, fmt::format("no part '{}'", name)));
  }
  reply(call, done_response(commissioning_.workshop->drop(name)));
}

PartWorkshop::Done ServiceRoutes::tell_generation(const CallPtr& call) {
  return [this, call](const Result<void>& done) {
    if (done)
      return reply(call, json_response(200, {{"generation", service_.generation()->number}}));
    const bool is_full = done.error().code == ErrorCode::no_space;
    reply(call, is_full ? error_response(done.error()) : error_response(409, done.error().message));
  };
}

void ServiceRoutes::publish_part(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  commissioning_.workshop->publish(std::string(rest), tell_generation(call));
}

void ServiceRoutes::remove_model(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  commissioning_.workshop->remove(std::string(rest), tell_generation(call));
}

void ServiceRoutes::rename_model(const CallPtr& call, std::string_view rest) {
  if (!commissioning_.workshop) return reply(call, read_only_response());
  commissioning_.workshop->rename(std::string(rest), call->target.parameter("name").value_or(""),
                                  tell_generation(call));
}

}  // namespace trivet::apps::service
