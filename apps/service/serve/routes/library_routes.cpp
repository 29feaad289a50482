#include "apps/service/serve/routes/library_routes.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "apps/inputs/inputs.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/library/model_json.hpp"
#include "apps/service/serve/library/near_turns.hpp"
#include "apps/words/score_words.hpp"

namespace trivet::apps::service {
namespace {

/// {"name", ..., "thumbnail", "mesh"}
nlohmann::ordered_json listed_model_json(const ModelInfo& model) {
  const auto view = [&](const char* name) {
    return encode_path(fmt::format("/v1/models/{}/{}", model.name, name));
  };
  nlohmann::ordered_json json = model_json(model);
  json["thumbnail"] = view("thumbnail.png");
  json["mesh"] = view("mesh.ply");
  return json;
}

}  // namespace

Routes LibraryRoutes::routes() {
  using std::bind_front;
  return {
      {"GET", "/v1/models", false, false, Effect::reads, "models",
       bind_front(&LibraryRoutes::list_models, this)},
      {"GET", "/v1/models/", true, false, Effect::reads, "model",
       bind_front(&LibraryRoutes::view_model, this)},
      {"GET", "/v1/score-parts", false, false, Effect::reads, "score_parts",
       bind_front(&LibraryRoutes::score_parts, this)},
      {"POST", "/v1/library/reload", false, false, Effect::changes, "reload",
       bind_front(&LibraryRoutes::reload, this)},
  };
}

void LibraryRoutes::list_models(const CallPtr& call, std::string_view) const {
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  nlohmann::ordered_json models = nlohmann::ordered_json::array();
  for (const ModelInfo& model : library.models) models.push_back(listed_model_json(model));
  responder_.reply(call, json_response(200, {{"library", library.file.filename().string()},
                                             {"generation", generation->number},
                                             {"unit", unit_name(library.header.unit)},
                                             {"models", std::move(models)}}));
}

void LibraryRoutes::view_model(const CallPtr& call, std::string_view rest) {
  const std::size_t slash = rest.rfind('/');  // the name may contain slashes, too
  const std::string name(rest.substr(0, slash));
  const std::string_view view = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (view != "mesh.ply" && view != "thumbnail.png" && view != kNearSymmetry) {
    return responder_.reply(
        call, error_response(404, "expected mesh.ply, thumbnail.png or near-symmetry of a model"));
  }
  responder_.run_small(
      call,
      [this, name,
       view = std::string(view)](const LibraryGeneration& generation) -> Result<HttpResponse> {
        const Library& library = generation.recognizer.library();
        const std::optional<std::uint32_t> model = find_model(library, name);
        if (!model) return error_response(404, fmt::format("no model '{}'", name));
        if (view == kNearSymmetry) return json_result(near_turns_json(library, *model));
        if (view == "mesh.ply") {
          TRIVET_TRY_ASSIGN(const ModelSurface* const surface, library.surface(*model));
          return HttpResponse{200, model_mesh(*surface), "model/ply", {}};
        }
        Result<std::string> png = thumbnails_.png(generation, *model);
        if (!png) return png.error();
        return HttpResponse{200, std::move(*png), "image/png", {}};
      });
}

void LibraryRoutes::score_parts(const CallPtr& call, std::string_view) const {
  const auto generation = service_.generation();
  const kernels::ScoreModel& score = generation->recognizer.score();
  const auto independent = most_evidence(score, 0), shared = most_evidence(score, 1);
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < kernels::kNumScoreParts; ++k) {
    const PartWords words = words_of(k);
    parts.push_back({{"name", kernels::kScoreParts[k].name},
                     {"label", words.label},
                     {"meaning", words.meaning},
                     {"most_evidence", {independent[k], shared[k]}}});
  }
  responder_.reply(call, json_response(200, {{"bias", score.bias}, {"parts", std::move(parts)}}));
}

void LibraryRoutes::reload(const CallPtr& call, std::string_view) const {
  reload_(responder_.reply_generation(call));
}

}  // namespace trivet::apps::service
