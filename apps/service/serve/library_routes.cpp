// What shows the library, and what comes with it.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "apps/inputs/inputs.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/service_routes.hpp"
#include "apps/words/score_words.hpp"
#include "storage/file.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxExampleBytes = 256 << 20;

Json symmetry_json(const Symmetry& symmetry) {
  return {{"poses", symmetry.poses.size()}, {"axis", symmetry.axis.has_value()}};
}

/// What the model nearly looks the same by, and what declares it in a manifest: with the symmetries
/// that it has, since a declaration stands for all.
Json near_symmetry_json(const Model& model) {
  Json declaration;
  if (!model.near_symmetries.empty() || model.near_axis) {
    declaration["symmetries"] = Json::array();
    for (const std::vector<Pose>* poses : {&model.symmetry.poses, &model.near_symmetries}) {
      for (const Pose& pose : *poses)
        declaration["symmetries"].push_back(apps::matrix_json(pose.cast<double>()));
    }
    if (const auto& axis = model.near_axis ? model.near_axis : model.symmetry.axis) {
      const auto vector = [](const auto& v) { return std::array{v.x(), v.y(), v.z()}; };
      declaration["symmetry_axis"] = {{"axis", vector(axis->direction)},
                                      {"offset", vector(axis->point)}};
    }
  }
  return {{"poses", model.near_symmetries.size()},
          {"axis", model.near_axis.has_value()},
          {"declaration", std::move(declaration)}};
}

}  // namespace

void ServiceRoutes::list_models(const CallPtr& call, std::string_view) {
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  Json models = Json::array();
  for (const Model& model : library.models) {
    const auto view = [&](const char* what) {
      return write_target({fmt::format("/v1/models/{}/{}", model.name, what), {}});
    };
    models.push_back({{"name", model.name},
                      {"diameter", model.diameter},
                      {"symmetry", symmetry_json(model.symmetry)},
                      {"near_symmetry", near_symmetry_json(model)},
                      {"thumbnail", view("thumbnail.png")},
                      {"mesh", view("mesh.ply")}});
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
  if (view != "mesh.ply" && view != "thumbnail.png")
    return reply(call, error_response(404, "expected mesh.ply or thumbnail.png of a model"));
  submit_one(call,
             [this, name, is_mesh = view == "mesh.ply"](
                 const LibraryGeneration& generation) -> Result<HttpResponse> {
               const Model* const model = find_model(generation.recognizer.library(), name);
               if (!model) return error_response(404, fmt::format("no model '{}'", name));
               if (is_mesh) return HttpResponse{200, model_mesh(*model), "model/ply", {}};
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
  submit_one(
      call, [file = examples_[*index].file](const LibraryGeneration&) -> Result<HttpResponse> {
        const Result<MappedFile> bytes = MappedFile::open(file, kMaxExampleBytes);
        if (!bytes) return error_response(404, "the example's file is gone");
        const std::span<const std::byte> view = bytes->bytes();
        return HttpResponse{
            200, std::string(reinterpret_cast<const char*>(view.data()), view.size()), kBytes, {}};
      });
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
  reload_([this, call](const Result<void>& done) {
    reply(call, done ? json_response(200, {{"generation", service_.generation()->number}})
                     : error_response(409, done.error().message));
  });
}

}  // namespace trivet::apps::service
