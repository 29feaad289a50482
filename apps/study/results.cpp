#include "apps/study/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

namespace trivet::apps::study {
namespace {

/// An evaluated point of the plan.
struct JudgedPoint {
  const StudyPoint* point = nullptr;
  Evaluation evaluation;
  double threshold = 0;
};

/// The scenes of a point, one set after the other.
Manifest manifest_of(const StudyPoint& point, const std::vector<Manifest>& sets) {
  Manifest all = sets[point.sets.front()];
  for (std::size_t i = 1; i < point.sets.size(); ++i) {
    const std::vector<ManifestScene>& more = sets[point.sets[i]].scenes;
    all.scenes.insert(all.scenes.end(), more.begin(), more.end());
  }
  return all;
}

/// Counts detections of models that are in no scene, which the evaluation leaves out, as false
/// positives.
void count_others(const Manifest& manifest, const std::vector<std::optional<SceneResult>>& results,
                  Evaluation& evaluation) {
  for (std::size_t s = 0; s < results.size(); ++s) {
    for (const JudgedDetection& judged : evaluation.scenes[s].detections) {
      const std::string& model = results[s]->detections[judged.detection].model;
      if (judged.reported &&
          std::ranges::find(manifest.models, model, &ManifestModel::name) == manifest.models.end())
        ++evaluation.total.false_positives;
    }
  }
}

class Judge {
 public:
  Judge(const Study& study, const StudyPlan& plan, const StudyFolder& folder,
        const std::vector<Manifest>& sets)
      : study_(study), plan_(plan), folder_(folder), sets_(sets) {}

  Result<JudgedPoint> judge(const StudyPoint& point) {
    const Manifest manifest = manifest_of(point, sets_);
    const Result<const std::vector<EvaluationMesh>*> meshes = meshes_of_set(point.sets.front());
    if (!meshes) return meshes.error();
    const Result<std::vector<std::optional<SceneResult>>> results =
        read_cells(plan_, folder_, sets_, point);
    if (!results) return results.error();
    float threshold = point.settings.recognize.min_score;
    const bool require_pose = point.settings.recognize.require_pose,
               require_identity = point.settings.recognize.require_identity;
    Result<Evaluation> evaluation =
        evaluate(manifest, **meshes, *results, threshold, require_pose, require_identity);
    if (!evaluation) return evaluation.error();
    const bool best = study_.experiments[point.experiment].threshold == Threshold::best_f1;
    if (best && evaluation->curve.best_f1) {
      threshold = static_cast<float>(evaluation->curve.best_f1->score);
      evaluation =
          evaluate(manifest, **meshes, *results, threshold, require_pose, require_identity);
      if (!evaluation) return evaluation.error();
    }
    count_others(manifest, *results, *evaluation);
    return JudgedPoint{&point, std::move(*evaluation), static_cast<double>(threshold)};
  }

  /// The scene of a point with the median of the found fraction.
  Result<StudyPicture> picture(const JudgedPoint& judged, std::string caption) {
    const StudyPoint& point = *judged.point;
    const std::vector<SceneEvaluation>& scenes = judged.evaluation.scenes;
    std::vector<std::size_t> order(scenes.size());
    for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
    std::ranges::stable_sort(order, {}, [&](std::size_t s) { return scenes[s].tally.recall(); });
    const Cell& cell = plan_.cells[point.cells[order[order.size() / 2]]];
    StudyPicture out{cell.set, cell.scene, std::move(caption), {}, {}};
    StudyPoint one = point;
    one.cells = {point.cells[order[order.size() / 2]]};
    Result<std::vector<std::optional<SceneResult>>> results =
        read_cells(plan_, folder_, sets_, one);
    if (!results) return results.error();
    Manifest manifest = sets_[cell.set];
    manifest.scenes = {manifest.scenes[cell.scene]};
    const Result<const std::vector<EvaluationMesh>*> meshes = meshes_of_set(cell.set);
    if (!meshes) return meshes.error();
    Result<Evaluation> evaluation =
        evaluate(manifest, **meshes, *results, static_cast<float>(judged.threshold));
    if (!evaluation) return evaluation.error();
    out.result = std::move(*(*results)[0]);
    out.evaluation = std::move(*evaluation);
    return out;
  }

 private:
  Result<const std::vector<EvaluationMesh>*> meshes_of_set(std::size_t set) {
    auto known = meshes_.find(set);
    if (known == meshes_.end()) {
      Result<std::vector<EvaluationMesh>> meshes = read_evaluation_meshes(sets_[set]);
      if (!meshes) return meshes.error();
      known = meshes_.emplace(set, std::move(*meshes)).first;
    }
    return &known->second;
  }

  const Study& study_;
  const StudyPlan& plan_;
  const StudyFolder& folder_;
  const std::vector<Manifest>& sets_;
  std::map<std::size_t, std::vector<EvaluationMesh>> meshes_;
};

// Pairs of points on the same scenes.

/// Trials keyed by set and scene.
using Trials = std::map<std::pair<std::size_t, std::size_t>, PairedTrials>;

std::vector<bool> found_truths(const SceneEvaluation& scene) {
  std::vector<bool> found(scene.truths.size(), true);
  for (const std::size_t missed : scene.missed) found[missed] = false;
  return found;
}

void add_trials(const JudgedPoint& first, const JudgedPoint& second, Trials& trials) {
  std::size_t s = 0;
  for (const std::size_t set : first.point->sets) {
    const std::size_t num_scenes = first.point->cells.size() / first.point->sets.size();
    for (std::size_t i = 0; i < num_scenes; ++i, ++s) {
      const SceneEvaluation& scene = first.evaluation.scenes[s];
      const std::vector<bool> a = found_truths(scene),
                              b = found_truths(second.evaluation.scenes[s]);
      PairedTrials& here = trials[{set, i}];
      for (std::size_t t = 0; t < a.size(); ++t) {
        if (!scene.truths[t].counts) continue;
        ++(a[t] ? (b[t] ? here.both : here.only_first) : (b[t] ? here.only_second : here.neither));
      }
    }
  }
}

PairedComparison compare(const Trials& trials, std::uint64_t seed) {
  std::vector<PairedTrials> scenes;
  for (const auto& entry : trials) scenes.push_back(entry.second);
  return compare_paired(scenes, seed);
}

/// None if the points do not have the same scenes.
std::optional<PairedComparison> compare(const JudgedPoint& first, const JudgedPoint& second,
                                        std::uint64_t seed) {
  if (first.point->sets != second.point->sets) return std::nullopt;
  Trials trials;
  add_trials(first, second, trials);
  return compare(trials, seed);
}

// Panels.

PanelCell cell_of(const JudgedPoint& judged) {
  const Evaluation& evaluation = judged.evaluation;
  const Tally& total = evaluation.total;
  PanelCell cell;
  cell.found = {total.right, total.instances};
  cell.false_positives = total.false_positives;
  cell.num_scenes = evaluation.scenes.size();
  cell.num_add_right = total.add_right;
  cell.f1 = f1_score(cell.found, total.false_positives);
  cell.threshold = judged.threshold;
  if (!evaluation.seconds.empty()) cell.seconds = evaluation.seconds.back().median;
  cell.translation_error = evaluation.median_translation_error;
  cell.rotation_error_deg = evaluation.median_rotation_error_deg;
  return cell;
}

/// The variant that leaves the settings unchanged.
std::optional<std::size_t> default_variant(const Study& study, const Experiment& experiment,
                                           const SceneGroup& scenes, Method method) {
  const Setting* const setting = find_setting(experiment.vary);
  Experiment plain = experiment;
  plain.changes.clear();
  const Result<StudySettings> usual = settings_of(study, plain, scenes, method, {"", {}, {}});
  for (std::size_t v = 0; usual && v < experiment.variants.size(); ++v) {
    const std::vector<SettingChange>& changes = experiment.variants[v].changes;
    if (setting ? changes.front().value == setting->get(*usual) : changes.empty()) return v;
  }
  return std::nullopt;
}

ExperimentKind kind_of(const Experiment& experiment) {
  if (experiment.curve != Curve::variants) return ExperimentKind::bins;
  if (experiment.variants.size() == 1) return ExperimentKind::groups;
  if (experiment.against == Against::previous) return ExperimentKind::steps;
  const bool tunes = experiment.vary.empty() || experiment.vary.starts_with("train.") ||
                     experiment.vary.starts_with("recognize.");
  // Other models of a library than those of the scenes are not a parameter.
  return tunes && experiment.vary != "train.others" ? ExperimentKind::parameter
                                                    : ExperimentKind::conditions;
}

class Arranger {
 public:
  Arranger(const Study& study, std::size_t experiment, std::vector<JudgedPoint>&& points)
      : study_(study), experiment_(study.experiments[experiment]), points_(std::move(points)) {}

  ExperimentResults arrange() const {
    ExperimentResults out{kind_of(experiment_), {}};
    switch (out.kind) {
      case ExperimentKind::bins:
        if (experiment_.scenes.size() > 1)
          out.panels.push_back(bins(experiment_.scenes, "All scenes together"));
        for (const std::size_t group : experiment_.scenes)
          out.panels.push_back(bins({group}, study_.scenes[group].title));
        break;
      case ExperimentKind::groups:
        out.panels.push_back(groups());
        break;
      case ExperimentKind::steps:
      case ExperimentKind::parameter:
      case ExperimentKind::conditions:
        for (const std::size_t group : experiment_.scenes) {
          out.panels.push_back(variants(group));
          // Without the default among the values there is no reference to compare them with.
          if (out.panels.back().reference == Reference::none) out.kind = ExperimentKind::conditions;
        }
        break;
    }
    return out;
  }

  const JudgedPoint& at(std::size_t group, std::size_t method, std::size_t variant) const {
    return *std::ranges::find_if(points_, [&](const JudgedPoint& judged) {
      return judged.point->scenes == group && judged.point->method == method &&
             judged.point->variant == variant;
    });
  }

 private:
  /// A panel with one point per row and method.
  template <class At>
  Panel panel_of(std::size_t num_rows, At&& at_row) const {
    Panel panel;
    panel.methods = experiment_.methods;
    for (std::size_t m = 0; m < panel.methods.size(); ++m) {
      std::vector<PanelCell> column;
      for (std::size_t row = 0; row < num_rows; ++row) {
        const JudgedPoint& judged = at_row(m, row);
        column.push_back(cell_of(judged));
        if (m > 0) column.back().lead = compare(judged, at_row(0, row), study_.seed);
      }
      panel.cells.push_back(std::move(column));
    }
    return panel;
  }

  Panel variants(std::size_t group) const {
    Panel panel = panel_of(
        experiment_.variants.size(),
        [&](std::size_t m, std::size_t row) -> const JudgedPoint& { return at(group, m, row); });
    panel.title = study_.scenes[group].title;
    panel.axis = experiment_.vary.empty() ? "" : find_setting(experiment_.vary)->label;
    panel.is_curve = !experiment_.vary.empty();
    for (const Variant& variant : experiment_.variants) {
      panel.rows.push_back(variant.name);
      panel.is_curve = panel.is_curve && variant.number.has_value();
    }
    const std::optional<std::size_t> usual =
        default_variant(study_, experiment_, study_.scenes[group], experiment_.methods.front());
    panel.reference = experiment_.against == Against::previous ? Reference::previous
                      : usual                                  ? Reference::fixed
                                                               : Reference::none;
    panel.reference_row = usual.value_or(0);
    for (std::size_t m = 0; m < panel.methods.size(); ++m) {
      for (std::size_t row = 0; row < panel.rows.size(); ++row) {
        if (panel.reference == Reference::none) continue;
        if (panel.reference == Reference::previous && row == 0) continue;
        const std::size_t other =
            panel.reference == Reference::fixed ? panel.reference_row : row - 1;
        if (other != row)
          panel.cells[m][row].change = compare(at(group, m, row), at(group, m, other), study_.seed);
      }
    }
    return panel;
  }

  Panel groups() const {
    Panel panel = panel_of(experiment_.scenes.size(),
                           [&](std::size_t m, std::size_t row) -> const JudgedPoint& {
                             return at(experiment_.scenes[row], m, 0);
                           });
    panel.axis = "scenes";
    for (const std::size_t group : experiment_.scenes)
      panel.rows.push_back(study_.scenes[group].title);
    return panel;
  }

  /// Truths grouped by their occlusion or clutter, over some groups of scenes.
  Panel bins(const std::vector<std::size_t>& groups, std::string title) const {
    Panel panel;
    panel.title = std::move(title);
    panel.axis = experiment_.curve == Curve::occlusion ? "occlusion" : "clutter";
    panel.is_curve = true;
    panel.methods = experiment_.methods;
    panel.rows = bin_names(groups);
    for (std::size_t m = 0; m < panel.methods.size(); ++m) {
      Trials trials;
      std::vector<PanelCell> column(panel.rows.size());
      PanelCell total;
      for (const std::size_t group : groups) {
        const JudgedPoint& judged = at(group, m, 0);
        for (const auto& [name, tally] : tallies_of(judged.evaluation)) {
          PanelCell& cell = column[static_cast<std::size_t>(std::ranges::find(panel.rows, name) -
                                                            panel.rows.begin())];
          cell.found.right += tally.right;
          cell.found.all += tally.instances;
          cell.num_add_right += tally.add_right;
        }
        add_group(cell_of(judged), total);
        if (m > 0) add_trials(judged, at(group, 0, 0), trials);
      }
      for (PanelCell& cell : column) cell.num_scenes = total.num_scenes;
      column.push_back(total);
      if (m > 0) column.back().lead = compare(trials, study_.seed);
      panel.cells.push_back(std::move(column));
    }
    panel.rows.emplace_back("all");
    panel.has_total = true;
    return panel;
  }

  const Tallies& tallies_of(const Evaluation& evaluation) const {
    return experiment_.curve == Curve::occlusion ? evaluation.by_occlusion : evaluation.by_clutter;
  }

  /// The bins that contain a truth of any group, in an order that keeps the order within each
  /// group.
  std::vector<std::string> bin_names(const std::vector<std::size_t>& groups) const {
    std::vector<std::string> names;
    for (const std::size_t group : groups) {
      auto place = names.begin();
      for (const auto& entry : tallies_of(at(group, 0, 0).evaluation)) {
        const auto known = std::ranges::find(names, entry.first);
        place = known == names.end() ? names.insert(place, entry.first) + 1 : known + 1;
      }
    }
    return names;
  }

  static void add_group(const PanelCell& group, PanelCell& total) {
    const bool first = total.num_scenes == 0;
    total.found.right += group.found.right;
    total.found.all += group.found.all;
    total.false_positives = total.false_positives.value_or(0) + group.false_positives.value_or(0);
    total.num_scenes += group.num_scenes;
    total.num_add_right += group.num_add_right;
    total.threshold = group.threshold;
    total.f1 = f1_score(total.found, *total.false_positives);
    // The medians of groups cannot be added.
    total.seconds = first ? group.seconds : std::nullopt;
    total.translation_error = first ? group.translation_error : std::nullopt;
    total.rotation_error_deg = first ? group.rotation_error_deg : std::nullopt;
  }

  const Study& study_;
  const Experiment& experiment_;
  std::vector<JudgedPoint> points_;
};

}  // namespace

double Rate::value() const noexcept {
  return all > 0 ? static_cast<double>(right) / static_cast<double>(all) : 0;
}

std::pair<double, double> Rate::interval() const noexcept { return wilson_interval(right, all); }

double f1_score(const Rate& found, std::size_t num_false) noexcept {
  const std::size_t sum = found.all + found.right + num_false;
  return sum > 0 ? 2 * static_cast<double>(found.right) / static_cast<double>(sum) : 0;
}

bool beyond_chance(const PairedComparison& comparison) noexcept {
  constexpr double kMaxP = 0.05;
  return comparison.p < kMaxP && (comparison.low > 0 || comparison.high < 0);
}

namespace {

/// The maximum over several libraries of one size, and over several cells.
Result<std::vector<LibraryRow>> library_rows(const StudyPlan& plan, const StudyFolder& folder,
                                             const std::vector<Manifest>& sets) {
  std::map<std::size_t, LibraryRow> rows;  // keyed by number of models
  for (const Cell& cell : plan.cells) {
    const LibraryPlan& library = plan.libraries[cell.library];
    const Result<LibraryUse> use = read_use(folder, cell);
    if (!use) return use.error();
    const std::size_t num_models = sets[library.set].models.size() + library.num_others;
    LibraryRow& row = rows[num_models];
    row.num_models = num_models;
    std::error_code unknown;
    const std::uintmax_t bytes = std::filesystem::file_size(folder.library(library), unknown);
    if (!unknown) row.file_bytes = std::max<std::uint64_t>(row.file_bytes, bytes);
    row.use.open_seconds = std::max(row.use.open_seconds, use->open_seconds);
    row.use.peak_bytes = std::max(row.use.peak_bytes, use->peak_bytes);
  }
  std::vector<LibraryRow> out;
  out.reserve(rows.size());
  for (const auto& [num_models, row] : rows) out.push_back(row);
  return out;
}

}  // namespace

Result<StudyResults> evaluate_study(const Study& study, const StudyPlan& plan,
                                    const StudyFolder& folder) {
  Result<std::vector<Manifest>> sets = read_sets(plan, folder);
  if (!sets) return sets.error();
  StudyResults out;
  out.sets = std::move(*sets);
  Judge judge(study, plan, folder, out.sets);
  std::set<std::size_t> shown, used_sets;
  for (std::size_t e = 0; e < study.experiments.size(); ++e) {
    const Experiment& experiment = study.experiments[e];
    std::vector<JudgedPoint> points;
    for (const StudyPoint& point : plan.points) {
      if (point.experiment != e) continue;
      Result<JudgedPoint> judged = judge.judge(point);
      if (!judged) return judged.error();
      points.push_back(std::move(*judged));
      for (const std::size_t set : point.sets) used_sets.insert(set);
    }
    const Arranger arranger(study, e, std::move(points));
    out.experiments.push_back(arranger.arrange());
    for (const std::size_t group : experiment.scenes) {
      if (out.pictures.size() == study.num_pictures || !shown.insert(group).second) continue;
      const std::size_t method = experiment.methods.size() - 1;
      const std::size_t variant =
          default_variant(study, experiment, study.scenes[group], experiment.methods[method])
              .value_or(0);
      Result<StudyPicture> picture =
          judge.picture(arranger.at(group, method, variant),
                        fmt::format("{}, {}", study.scenes[group].title,
                                    choice_name(experiment.methods[method])));
      if (!picture) return picture.error();
      out.pictures.push_back(std::move(*picture));
    }
  }
  Result<std::vector<LibraryRow>> libraries = library_rows(plan, folder, out.sets);
  if (!libraries) return libraries.error();
  out.libraries = std::move(*libraries);
  out.num_recognitions = plan.cells.size();
  for (const std::size_t set : used_sets) {
    out.num_scenes += out.sets[set].scenes.size();
    for (const ManifestScene& scene : out.sets[set].scenes) out.num_instances += scene.truth.size();
  }
  return out;
}

}  // namespace trivet::apps::study
