// What shows the library, and what comes with it.
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "apps/inputs/inputs.hpp"
#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/library/model_json.hpp"
#include "apps/service/serve/library/near_turns.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/words/score_words.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

void ServiceRoutes::list_models(const CallPtr& call, std::string_view) {
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  Json models = Json::array();
  for (const Model& model : library.models) {
    const auto view = [&](const char* what) {
      return encode_path(fmt::format("/v1/models/{}/{}", model.name, what));
    };
    Json told = model_json(model);
    told["thumbnail"] = view("thumbnail.png");
    told["mesh"] = view("mesh.ply");
    models.push_back(std::move(told));
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
  if (view != "mesh.ply" && view != "thumbnail.png" && view != kNearSymmetry) {
    return reply(
        call, error_response(404, "expected mesh.ply, thumbnail.png or near-symmetry of a model"));
  }
  submit_one(call,
             [this, name, view = std::string(view)](
                 const LibraryGeneration& generation) -> Result<HttpResponse> {
               const Library& library = generation.recognizer.library();
               const Model* const model = find_model(library, name);
               if (!model) return error_response(404, fmt::format("no model '{}'", name));
               if (view == kNearSymmetry) {
                 return near_turns_response(
                     library, static_cast<std::uint32_t>(model - library.models.data()));
               }
               if (view == "mesh.ply")
                 return HttpResponse{200, model_mesh(*model), "model/ply", {}};
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
  reply(call, file_response(examples_[*index].file));
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
  reload_(tell_generation(call));
}

}  // namespace trivet::apps::service
