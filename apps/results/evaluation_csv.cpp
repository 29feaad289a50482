#include "apps/results/evaluation_csv.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "apps/results/csv_table.hpp"
#include "apps/results/evaluation_json.hpp"
#include "storage/files/file.hpp"

namespace trivet::apps {
namespace {

void add_errors(const JudgedDetection& judged, CsvTable& table) {
  table.number(judged.translation_error).number(judged.rotation_error_deg).number(judged.add);
}

CsvTable instances_table(const Manifest& manifest, const Evaluation& evaluation,
                         std::span<const std::optional<SceneResult>> results) {
  CsvTable table(
      "scene,truth,model,counts,occlusion,clutter,visible_fraction,found,score,"
      "translation_error_over_diameter,rotation_error_deg,add_over_diameter");
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    const ManifestScene& scene = manifest.scenes[s];
    const SceneEvaluation& judged = evaluation.scenes[s];
    for (std::size_t t = 0; t < scene.truth.size(); ++t) {
      const TruthInstance& truth = scene.truth[t];
      const TruthOutcome& outcome = judged.truths[t];
      table.row().text(scene.name).count(t).text(truth.model).count(outcome.counts ? 1 : 0);
      table.number(truth.occlusion).number(truth.clutter).number(truth.visible_fraction);
      if (!outcome.found_by) {
        table.count(0).empty(4);
        continue;
      }
      const JudgedDetection& finder = judged.detections[*outcome.found_by];
      table.count(finder.reported ? 1 : 0);
      table.number(static_cast<double>(results[s]->detections[finder.detection].score));
      add_errors(finder, table);
    }
  }
  return table;
}

CsvTable detections_table(const Manifest& manifest, const Evaluation& evaluation,
                          const BopScores& bop,
                          std::span<const std::optional<SceneResult>> results) {
  CsvTable table(
      "scene,detection,model,score,reported,verdict,truth,translation_error_over_diameter,"
      "rotation_error_deg,add_over_diameter,mssd,mspd,vsd,visible_fraction,violation,contour,rmse");
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    for (const JudgedDetection& judged : evaluation.scenes[s].detections) {
      const Detection& detection = results[s]->detections[judged.detection];
      table.row().text(manifest.scenes[s].name).count(judged.detection).text(detection.model);
      table.number(static_cast<double>(detection.score)).count(judged.reported ? 1 : 0);
      table.text(verdict_name(judged.verdict));
      if (judged.truth) {
        table.count(*judged.truth);
        add_errors(judged, table);
      } else {
        table.empty(4);
      }
      if (const std::optional<BopErrors>& errors = bop.errors[s][judged.detection]) {
        table.number(errors->mssd).number(errors->mspd).number(errors->vsd_at_20_percent());
      } else {
        table.empty(3);
      }
      for (const float part :
           {detection.visible_fraction, detection.violation, detection.contour, detection.rmse}) {
        table.number(static_cast<double>(part));
      }
    }
  }
  return table;
}

CsvTable summary_table(const Evaluation& evaluation) {
  CsvTable table(
      "group,name,instances,right,recall,recall_95_low,recall_95_high,add_right,false_positives,"
      "precision");
  const auto add = [&](std::string_view group, std::string_view name, const Tally& tally,
                       bool with_false) {
    const auto [low, high] = wilson_interval(tally.right, tally.instances);
    table.row().text(group).text(name).count(tally.instances).count(tally.right);
    table.number(tally.recall()).number(low).number(high).count(tally.add_right);
    with_false ? table.count(tally.false_positives).number(tally.precision()) : table.empty(2);
  };
  add("all", "", evaluation.total, true);
  for (const auto& [name, tally] : evaluation.by_occlusion) add("occlusion", name, tally, false);
  for (const auto& [name, tally] : evaluation.by_clutter) add("clutter", name, tally, false);
  for (const auto& [name, tally] : evaluation.by_visible_fraction)
    add("visible_fraction", name, tally, false);
  for (const auto& [name, tally] : evaluation.by_model) add("model", name, tally, true);
  return table;
}

}  // namespace

Result<void> write_evaluation_csv(const std::filesystem::path& folder, const Manifest& manifest,
                                  const Evaluation& evaluation, const BopScores& bop,
                                  std::span<const std::optional<SceneResult>> results) {
  TRIVET_TRY(make_folder(folder));
  for (const auto& [name, table] :
       {std::pair{"instances.csv", instances_table(manifest, evaluation, results)},
        {"detections.csv", detections_table(manifest, evaluation, bop, results)},
        {"summary.csv", summary_table(evaluation)}}) {
    TRIVET_TRY(table.write(folder / name));
  }
  return {};
}

}  // namespace trivet::apps
