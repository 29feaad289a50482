#include "apps/study/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "apps/inputs/inputs.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string key_of(const Json& json) {
  const std::string text = json_text(json);
  return xxh3_hex(std::as_bytes(std::span(text)));
}

Result<std::string> hash_file(const fs::path& file) {
  const Result<std::vector<std::byte>> bytes =
      read_file(file, std::numeric_limits<std::uint64_t>::max());
  if (!bytes) return bytes.error();
  return xxh3_hex(*bytes);
}

/// Unique items by their key, in the order of insertion.
template <class Thing>
class Unique {
 public:
  explicit Unique(std::vector<Thing>& things) : things_(things) {}
  std::size_t add(Thing&& thing) {
    const auto [place, is_new] = places_.emplace(thing.key, things_.size());
    if (is_new) things_.push_back(std::move(thing));
    return place->second;
  }

 private:
  std::vector<Thing>& things_;
  std::map<std::string, std::size_t> places_;
};

class Planner {
 public:
  explicit Planner(const Study& study) : study_(study) {}

  Result<StudyPlan> plan() {
    for (const ModelGroup& group : study_.models) {
      Result<Json> json = model_json(group);
      if (!json) return json.error();
      models_.push_back(std::move(*json));
    }
    for (std::size_t e = 0; e < study_.experiments.size(); ++e) {
      const Experiment& experiment = study_.experiments[e];
      for (const std::size_t group : experiment.scenes) {
        for (std::size_t m = 0; m < experiment.methods.size(); ++m) {
          for (std::size_t v = 0; v < experiment.variants.size(); ++v) {
            if (const Result<void> done = add_point({e, group, m, v, {}, {}, {}}); !done)
              return done.error();
          }
        }
      }
    }
    sort_cells();
    return std::move(plan_);
  }

 private:
  static Result<Json> model_json(const ModelGroup& group) {
    const Result<ModelInputs> inputs = collect_models(group.files);
    if (!inputs) return inputs.error();
    Json files = Json::array();
    for (const ModelSource& source : inputs->sources) {
      const Result<std::string> hash = hash_file(source.file);
      if (!hash) return hash.error();
      files.push_back({source.name, source.scale, *hash});
    }
    return Json{{"files", std::move(files)},
                {"diameter", group.options.diameter},
                {"metal", group.options.metal},
                {"parts", group.num_parts},
                {"families", group.families}};
  }

  Json models_json(const std::vector<std::size_t>& groups) const {
    Json json{{"version", TRIVET_VERSION}, {"seed", study_.seed}};
    for (const std::size_t group : groups) json["models"].push_back(models_[group]);
    return json;
  }

  /// Adds scenes of these models, for one repetition.
  std::size_t add_scanned(const std::vector<std::size_t>& groups, StudySettings settings,
                          std::uint32_t repetition) {
    settings.scan.seed += repetition;
    Json json = models_json(groups);
    json["scan"] = stage_json("scan", settings);
    return sets_.add({key_of(json), groups, {}, settings.scan});
  }

  Result<std::size_t> add_listed(const fs::path& manifest) {
    const Result<std::string> hash = hash_file(manifest);
    if (!hash) return hash.error();
    return sets_.add(
        {key_of({{"version", TRIVET_VERSION}, {"manifest", *hash}}), {}, manifest, {}});
  }

  /// The number of scenes of a set.
  Result<std::size_t> count_scenes(std::size_t set) {
    const SceneSet& planned = plan_.sets[set];
    if (planned.manifest.empty()) return std::size_t{planned.options.num_scenes};
    const auto known = listed_.find(set);
    if (known != listed_.end()) return known->second;
    const Result<Manifest> manifest = read_manifest(planned.manifest);
    if (!manifest) return manifest.error();
    return listed_[set] = manifest->scenes.size();
  }

  std::size_t add_library(std::size_t set, const SceneGroup& group, Method method,
                          const StudySettings& settings) {
    LibraryPlan library;
    library.set = set;
    library.num_others = settings.num_others;
    library.options = settings.train;
    Json json = plan_.sets[set].manifest.empty() ? models_json(group.models)
                                                 : Json{{"manifest", plan_.sets[set].key}};
    json["train"] = stage_json("train", settings);
    json["method"] = method;
    if (settings.num_others > 0) {
      json["others"] = models_json(group.others);
      // One scene is enough to get its models.
      StudySettings one;
      one.scan.num_scenes = one.scan.num_instances = 1;
      one.scan.seed = study_.seed;
      for (const std::size_t other : group.others)
        library.others.push_back(add_scanned({other}, one, 0));
    }
    library.key = key_of(json);
    return libraries_.add(std::move(library));
  }

  Result<void> add_point(StudyPoint point) {
    const Experiment& experiment = study_.experiments[point.experiment];
    const SceneGroup& group = study_.scenes[point.scenes];
    const Method method = experiment.methods[point.method];
    Result<StudySettings> settings =
        settings_of(study_, experiment, group, method, experiment.variants[point.variant]);
    if (!settings) return settings.error();
    RecognizeOptions& recognize = settings->recognize;
    recognize.doubtful_score = std::min(kLowestKeptScore, recognize.min_score);
    for (std::uint32_t repetition = 0; repetition < experiment.repetitions; ++repetition) {
      Result<std::size_t> set = group.manifest.empty()
                                    ? add_scanned(group.models, *settings, repetition)
                                    : add_listed(group.manifest);
      if (!set) return set.error();
      const Result<std::size_t> num_scenes = count_scenes(*set);
      if (!num_scenes) return num_scenes.error();
      const std::size_t library = add_library(*set, group, method, *settings);
      Json json{{"set", plan_.sets[*set].key},
                {"library", plan_.libraries[library].key},
                {"degrade", stage_json("degrade", *settings)},
                {"recognize", stage_json("recognize", *settings)},
                {"seed", study_.seed}};
      for (std::size_t scene = 0; scene < *num_scenes; ++scene) {
        json["scene"] = scene;
        point.cells.push_back(cells_.add({key_of(json), *set, scene, library, settings->degrade,
                                          study_.seed + scene, recognize}));
      }
      point.sets.push_back(*set);
    }
    point.settings = std::move(*settings);
    plan_.points.push_back(std::move(point));
    return {};
  }

  /// Sorts cells by library, then by scene.
  void sort_cells() {
    std::vector<std::size_t> order(plan_.cells.size()), place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return plan_.cells[i].library; });
    std::vector<Cell> sorted;
    for (std::size_t i = 0; i < order.size(); ++i) {
      place[order[i]] = i;
      sorted.push_back(std::move(plan_.cells[order[i]]));
    }
    plan_.cells = std::move(sorted);
    for (StudyPoint& point : plan_.points) {
      for (std::size_t& cell : point.cells) cell = place[cell];
    }
  }

  const Study& study_;
  std::vector<Json> models_;
  std::map<std::size_t, std::size_t> listed_;
  StudyPlan plan_;
  Unique<SceneSet> sets_{plan_.sets};
  Unique<LibraryPlan> libraries_{plan_.libraries};
  Unique<Cell> cells_{plan_.cells};
};

}  // namespace

Result<StudyPlan> plan_study(const Study& study) { return Planner(study).plan(); }

}  // namespace trivet::apps::study
