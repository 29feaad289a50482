#include "apps/study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/inputs/inputs.hpp"
#include "apps/report/html.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/write_json.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/evaluation/recognize_cells.hpp"
#include "engine/loaded_library/default_score.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::study {
namespace {

namespace fs = std::filesystem;

/// The models of some groups, as they are in scenes.
Result<std::vector<ScanModel>> gather_models(const Study& study,
                                             const std::vector<std::size_t>& groups) {
  std::vector<ScanModel> models;
  std::set<std::string> names;
  for (const std::size_t index : groups) {
    const ModelGroup& group = study.models[index];
    const Result<ModelInputs> inputs = collect_models(group.files);
    if (!inputs) return inputs.error();
    Result<std::vector<ScanModel>> read =
        read_scan_models(inputs->sources, inputs->unit.value_or(LengthUnit::meter), group.options);
    if (!read) return read.error();
    for (ScanModel& part : make_scan_models(group.num_parts, study.seed, group.families))
      read->push_back(std::move(part));
    for (ScanModel& model : *read) {
      if (!names.insert(model.name).second) {
        return Error{ErrorCode::usage, fmt::format("models.{}: expected each model's name once in "
                                                   "a scene, found '{}' again",
                                                   group.name, model.name)};
      }
      models.push_back(std::move(model));
    }
  }
  return models;
}

Result<void> render(const Study& study, const SceneSet& set, const StudyFolder& folder,
                    const std::stop_token& stop) {
  const Result<std::vector<ScanModel>> models = gather_models(study, set.models);
  if (!models) return models.error();
  const fs::path target = folder.scenes(set), part = target.string() + ".part";
  std::error_code error;
  fs::remove_all(part, error);
  const Result<Manifest> rendered =
      render_scenes(*models, LengthUnit::meter, set.options, part, {{}, stop});
  if (!rendered) return rendered.error();
  fs::rename(part, target, error);
  if (!error) return {};
  return Error{ErrorCode::cannot_create, fmt::format("{}: {}", target.string(), error.message())};
}

Result<void> render_missing(const Study& study, const StudyPlan& plan, const StudyFolder& folder,
                            const ProgressOf& progress_of, const Share& share) {
  std::vector<std::size_t> missing;
  for (std::size_t s = 0; s < plan.sets.size(); ++s) {
    if (!fs::exists(folder.manifest(plan.sets[s]))) missing.push_back(s);
  }
  const Progress progress = progress_of("rendered");
  return share(missing, [&](std::span<const std::size_t> some) -> Result<void> {
    for (std::size_t i = 0; i < some.size(); ++i) {
      const SceneSet& set = plan.sets[some[i]];
      TRIVET_TRY(render(study, set, folder, progress.stop));
      progress(i + 1, some.size(), counted(set.options.num_scenes, "scene"));
    }
    return {};
  });
}

Result<std::vector<ModelSource>> training_sources(const LibraryPlan& library,
                                                  const std::vector<Manifest>& sets) {
  std::vector<ModelSource> sources = models_of(sets[library.set]);
  const std::size_t num_own = sources.size();
  std::set<std::string> names;
  for (const ModelSource& source : sources) names.insert(source.name);
  for (const std::size_t other : library.others) {
    for (ModelSource& source : models_of(sets[other])) {
      if (sources.size() - num_own == library.num_others) break;
      if (names.insert(source.name).second) sources.push_back(std::move(source));
    }
  }
  if (sources.size() - num_own < library.num_others) {
    return Error{ErrorCode::usage,
                 fmt::format("train.others: expected at most {}, as many as the other groups have, "
                             "found {}",
                             sources.size() - num_own, library.num_others)};
  }
  return sources;
}

Result<void> train_missing(const StudyPlan& plan, const StudyFolder& folder,
                           const std::vector<Manifest>& sets, const std::set<std::size_t>& needed,
                           const ProgressOf& progress_of, const Share& share) {
  std::vector<std::size_t> missing;
  for (const std::size_t index : needed) {
    if (!fs::exists(folder.library(plan.libraries[index]))) missing.push_back(index);
  }
  const Progress progress = progress_of("trained");
  return share(missing, [&](std::span<const std::size_t> some) -> Result<void> {
    for (std::size_t i = 0; i < some.size(); ++i) {
      const LibraryPlan& library = plan.libraries[some[i]];
      const Result<std::vector<ModelSource>> sources = training_sources(library, sets);
      if (!sources) return sources.error();
      const Result<TrainReport> trained = train_library(
          {*sources, sets[library.set].unit, library.options, folder.library(library)},
          {{}, {{}, progress.stop}, {}});
      if (!trained) return trained.error();
      progress(i + 1, some.size(), counted(trained->models.size(), "model"));
    }
    return {};
  });
}

}  // namespace

Result<void> do_all(std::span<const std::size_t> items,
                    const std::function<Result<void>(std::span<const std::size_t>)>& work) {
  return work(items);
}

Result<std::vector<Manifest>> read_sets(const StudyPlan& plan, const StudyFolder& folder) {
  std::vector<Manifest> sets;
  for (const SceneSet& set : plan.sets) {
    Result<Manifest> manifest = read_manifest(folder.manifest(set));
    if (!manifest) return manifest.error();
    sets.push_back(std::move(*manifest));
  }
  return sets;
}

Result<void> run_study(const Study& study, const StudyPlan& plan, const StudyFolder& folder,
                       const ProgressOf& progress_of, const Share& share) {
  for (const char* const part : {"scenes", "libraries", "cells"}) {
    TRIVET_TRY(make_folder(folder.path() / part));
  }
  TRIVET_TRY(render_missing(study, plan, folder, progress_of, share));
  const Result<std::vector<Manifest>> sets = read_sets(plan, folder);
  if (!sets) return sets.error();

  std::vector<std::size_t> missing;
  std::set<std::size_t> libraries;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    if (fs::exists(folder.cell(plan.cells[i]))) continue;
    missing.push_back(i);
    libraries.insert(plan.cells[i].library);
  }
  TRIVET_TRY(train_missing(plan, folder, *sets, libraries, progress_of, share));

  std::vector<fs::path> files;
  for (const LibraryPlan& library : plan.libraries) files.push_back(folder.library(library));
  std::vector<std::vector<SceneInput>> inputs;  // indexed by set
  for (const Manifest& set : *sets) inputs.push_back(scenes_of(set, set.unit));
  const auto keep = [&](const Cell& cell, const SceneResult& result, const LibraryUse& use) {
    const std::string& name = (*sets)[cell.set].scenes[cell.scene].name;
    nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
    scenes.push_back(scene_json(name, result, default_score(), {}));
    return write_json(
        folder.cell(cell).string(),
        {{"scenes", std::move(scenes)},
         {"library", {{"open_seconds", use.open_seconds}, {"peak_bytes", use.peak_bytes}}}});
  };
  const Progress progress = progress_of("recognized");
  return share(missing, [&](std::span<const std::size_t> some) {
    std::vector<RecognitionCell> cells;
    for (const std::size_t i : some) {
      const Cell& cell = plan.cells[i];
      cells.push_back({cell.library, inputs[cell.set][cell.scene], cell.degrade, cell.degrade_seed,
                       cell.options});
    }
    return recognize_cells(files, cells, progress,
                           [&](std::size_t k, const SceneResult& result, const LibraryUse& use) {
                             return keep(plan.cells[some[k]], result, use);
                           });
  });
}

Result<std::vector<std::optional<SceneResult>>> read_cells(const StudyPlan& plan,
                                                           const StudyFolder& folder,
                                                           const std::vector<Manifest>& sets,
                                                           const StudyPoint& point) {
  std::vector<std::optional<SceneResult>> results;
  for (const std::size_t index : point.cells) {
    const Cell& cell = plan.cells[index];
    Manifest one;
    one.scenes.push_back(sets[cell.set].scenes[cell.scene]);
    Result<std::vector<std::optional<SceneResult>>> result =
        read_detections(folder.cell(cell), one);
    if (!result) return result.error();
    results.push_back(std::move((*result)[0]));
  }
  return results;
}

Result<LibraryUse> read_use(const StudyFolder& folder, const Cell& cell) {
  LibraryUse use;
  const Result<void> read = with_json(folder.cell(cell), [&](const JsonNode& root) {
    const JsonNode library = root.at("library");
    use.open_seconds = library.at("open_seconds").number();
    use.peak_bytes = static_cast<std::uint64_t>(library.at("peak_bytes").number());
  });
  if (!read) return read.error();
  return use;
}

}  // namespace trivet::apps::study
