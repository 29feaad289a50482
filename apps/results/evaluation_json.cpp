#include "apps/results/evaluation_json.hpp"

#include <fmt/format.h>

#include <array>

#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

using nlohmann::ordered_json;

ordered_json tally_json(const Tally& tally) {
  const auto [low, high] = wilson_interval(tally.right, tally.instances);
  return {{"instances", tally.instances},
          {"right", tally.right},
          {"recall", tally.recall()},
          {"recall_95_low", low},
          {"recall_95_high", high},
          {"precision", tally.precision()},
          {"add_right", tally.add_right},
          {"false_positives", tally.false_positives},
          {"among_candidates", tally.among_candidates},
          {"misnamed", tally.misnamed}};
}

/// Sums of groups of truths. False positives belong to no group.
ordered_json groups_json(const Tallies& tallies) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, tally] : tallies) {
    object[name] = tally_json(tally);
    object[name].erase("precision");
    object[name].erase("false_positives");
    object[name].erase("misnamed");
  }
  return object;
}

ordered_json tallies_json(const Tallies& tallies) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, tally] : tallies) object[name] = tally_json(tally);
  return object;
}

ordered_json optional_json(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json threshold_json(const ScoreThreshold& threshold) {
  const auto score = [](const std::optional<float>& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  return {{"min_score", score(threshold.min_score)},
          {"require_pose", threshold.require_pose},
          {"require_identity", threshold.require_identity},
          {"lowest_kept_score", score(threshold.lowest_kept)}};
}

ordered_json point_json(const OperatingPoint& point) {
  return {{"score", point.score},
          {"precision", point.precision},
          {"recall", point.recall},
          {"f1", point.f1()}};
}

ordered_json curve_json(const std::vector<OperatingPoint>& points) {
  ordered_json columns{{"score", ordered_json::array()},
                       {"precision", ordered_json::array()},
                       {"recall", ordered_json::array()}};
  for (const OperatingPoint& point : points) {
    columns["score"].push_back(point.score);
    columns["precision"].push_back(point.precision);
    columns["recall"].push_back(point.recall);
  }
  return columns;
}

ordered_json calibration_json(const std::optional<Calibration>& calibration) {
  if (!calibration) return nullptr;
  ordered_json bins = ordered_json::array();
  for (const CalibrationBin& bin : calibration->bins) {
    const auto [low, high] = wilson_interval(bin.right, bin.all);
    bins.push_back({{"score_low", bin.low},
                    {"score_high", bin.high},
                    {"detections", bin.all},
                    {"right", bin.right},
                    {"mean_score", bin.mean_score},
                    {"right_95_low", low},
                    {"right_95_high", high}});
  }
  return {{"expected_error", calibration->expected_error}, {"bins", std::move(bins)}};
}

ordered_json bop_json(const BopScores& bop) {
  const BopRecall& recall = bop.localization;
  const BopPrecision& precision = bop.detection;
  return {{"localization",
           {{"targets", recall.num_targets},
            {"ar_vsd", optional_json(recall.vsd)},
            {"ar_mssd", recall.mssd},
            {"ar_mspd", optional_json(recall.mspd)},
            {"ar", optional_json(recall.mean)}}},
          {"detection",
           {{"targets", precision.num_targets},
            {"detections_of_absent_models", precision.num_absent},
            {"ap_mssd", precision.mssd},
            {"ap_mspd", optional_json(precision.mspd)},
            {"ap", optional_json(precision.mean)},
            {"ap_mssd_mm", precision.mssd_mm}}}};
}

ordered_json detection_json(const JudgedDetection& judged, const Detection& detection,
                            const std::optional<BopErrors>& errors) {
  ordered_json entry{{"model", detection.model},
                     {"score", detection.score},
                     {"reported", judged.reported},
                     {"verdict", verdict_name(judged.verdict)},
                     {"misnamed", judged.misnamed}};
  if (judged.truth) {
    entry[judged.found ? "truth" : "nearest_truth"] = *judged.truth;
    entry["translation_error_over_diameter"] = judged.translation_error;
    entry["rotation_error_deg"] = judged.rotation_error_deg;
    entry["add_over_diameter"] = judged.add;
  }
  if (errors) {
    entry["mssd"] = errors->mssd;
    entry["mspd"] = optional_json(errors->mspd);
    entry["vsd"] = errors->vsd ? ordered_json(*errors->vsd) : ordered_json(nullptr);
  }
  return entry;
}

ordered_json missed_json(const ManifestScene& scene, const SceneEvaluation& evaluation,
                         std::size_t t, const std::optional<SceneResult>& result) {
  const TruthInstance& truth = scene.truth[t];
  ordered_json entry{{"model", truth.model},
                     {"truth", t},
                     {"occlusion", optional_json(truth.occlusion)},
                     {"clutter", optional_json(truth.clutter)},
                     {"visible_fraction", optional_json(truth.visible_fraction)},
                     {"score_below", nullptr}};
  if (const auto& found_by = evaluation.truths[t].found_by) {
    entry["score_below"] = result->detections[evaluation.detections[*found_by].detection].score;
  }
  return entry;
}

ordered_json scene_evaluation_json(const ManifestScene& scene, const SceneEvaluation& evaluation,
                                   std::span<const std::optional<BopErrors>> errors,
                                   const std::optional<SceneResult>& result) {
  ordered_json detections = ordered_json::array(), missed = ordered_json::array();
  for (const JudgedDetection& judged : evaluation.detections)
    detections.push_back(
        detection_json(judged, result->detections[judged.detection], errors[judged.detection]));
  for (const std::size_t truth : evaluation.missed)
    missed.push_back(missed_json(scene, evaluation, truth, result));
  ordered_json out{{"scene", scene.name}};
  out.update(tally_json(evaluation.tally));
  out.update(
      {{"missing", evaluation.missing},
       {"seconds", result ? ordered_json(result->stats.total_seconds) : ordered_json(nullptr)},
       {"detections", std::move(detections)},
       {"missed", std::move(missed)}});
  return out;
}

std::string tally_row(const std::string& name, const Tally& tally, bool with_false) {
  const auto [low, high] = wilson_interval(tally.right, tally.instances);
  return fmt::format("{:<28} {:>5} / {:<5} {:>7.1f} % {:>6.1f} - {:<5.1f} {:>8} {:>7}\n", name,
                     tally.right, tally.instances, 100 * tally.recall(), 100 * low, 100 * high,
                     with_false ? fmt::format("{}", tally.false_positives) : "", tally.add_right);
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::right:
      return "right";
    case Verdict::wrong:
      return "wrong";
    case Verdict::neutral:
      return "neutral";
  }
  return "";
}

ordered_json evaluation_json(const Manifest& manifest, const Evaluation& evaluation,
                             const ScoreThreshold& threshold, const BopScores& bop,
                             std::span<const std::optional<SceneResult>> results) {
  ordered_json median = ordered_json::object(), p95 = median, scenes = ordered_json::array();
  for (const StageSeconds& stage : evaluation.seconds) {
    median[stage.stage] = stage.median;
    p95[stage.stage] = stage.p95;
  }
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    scenes.push_back(
        scene_evaluation_json(manifest.scenes[s], evaluation.scenes[s], bop.errors[s], results[s]));
  }
  ordered_json document = tally_json(evaluation.total);
  document.update(
      {{"threshold", threshold_json(threshold)},
       {"scenes_missing", evaluation.num_missing},
       {"median_translation_error_over_diameter",
        optional_json(evaluation.median_translation_error)},
       {"median_rotation_error_deg", optional_json(evaluation.median_rotation_error_deg)},
       {"median_seconds", std::move(median)},
       {"p95_seconds", std::move(p95)},
       {"average_precision", evaluation.curve.average_precision},
       {"best_f1",
        evaluation.curve.best_f1 ? point_json(*evaluation.curve.best_f1) : ordered_json(nullptr)},
       {"precision_recall", curve_json(evaluation.curve.points)},
       {"calibration", calibration_json(evaluation.calibration)},
       {"bop", bop_json(bop)},
       {"by_occlusion", groups_json(evaluation.by_occlusion)},
       {"by_clutter", groups_json(evaluation.by_clutter)},
       {"by_visible_fraction", groups_json(evaluation.by_visible_fraction)},
       {"by_model", tallies_json(evaluation.by_model)},
       {"scenes", std::move(scenes)}});
  return document;
}

std::string evaluation_table(const Evaluation& evaluation, const BopScores& bop) {
  std::string text = fmt::format("{:<28} {:>13} {:>9} {:>14} {:>8} {:>7}\n", "", "right / all",
                                 "recall", "95 % interval", "false", "ADD");
  text += tally_row(counted(evaluation.scenes.size(), "scene"), evaluation.total, true);
  for (const auto& [group, tallies] : {std::pair{"occlusion", &evaluation.by_occlusion},
                                       {"clutter", &evaluation.by_clutter},
                                       {"visible", &evaluation.by_visible_fraction}}) {
    for (const auto& [name, tally] : *tallies)
      text += tally_row(fmt::format("  {} {}", group, name), tally, false);
  }
  for (const auto& [name, tally] : evaluation.by_model) text += tally_row("  " + name, tally, true);
  const Tally& total = evaluation.total;
  if (total.among_candidates > total.right || total.misnamed > 0) {
    text += fmt::format(
        "among the candidates         {} / {}; {} of the false ones have only the "
        "wrong name\n",
        total.among_candidates, total.instances, total.misnamed);
  }
  if (evaluation.num_missing > 0)
    text += counted(evaluation.num_missing, "scene has", "scenes have") + " no result\n";
  if (evaluation.median_translation_error) {
    text += fmt::format("median error of right ones   {:.2f} % of the diameter, {:.2f} degrees\n",
                        100 * *evaluation.median_translation_error,
                        *evaluation.median_rotation_error_deg);
  }
  if (const auto& best = evaluation.curve.best_f1) {
    text += fmt::format(
        "average precision            {:.3f}; best F1 {:.3f} at score {:.3f}: precision {:.1f} %, "
        "recall {:.1f} %\n",
        evaluation.curve.average_precision, best->f1(), best->score, 100 * best->precision,
        100 * best->recall);
  }
  if (evaluation.calibration) {
    text += fmt::format("calibration error            {:.3f}\n",
                        evaluation.calibration->expected_error);
  }
  const auto share = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : std::string("-");
  };
  text += fmt::format("BOP localization             AR {} (VSD {}, MSSD {:.3f}, MSPD {})\n",
                      share(bop.localization.mean), share(bop.localization.vsd),
                      bop.localization.mssd, share(bop.localization.mspd));
  text += fmt::format("BOP detection                AP {} (MSSD {:.3f}, MSPD {})\n",
                      share(bop.detection.mean), bop.detection.mssd, share(bop.detection.mspd));
  if (evaluation.seconds.empty()) return text;
  text += "median seconds a scene      ";
  for (const StageSeconds& stage : evaluation.seconds)
    text += fmt::format(" {} {:.3f}", stage.stage, stage.median);
  return text + "\n";
}

std::string threshold_words(const ScoreThreshold& threshold, const std::string& source) {
  if (!threshold.min_score)
    return fmt::format("threshold                    all detections of {} count as reported\n",
                       source);
  std::string text =
      fmt::format("threshold                    score{}{} {:.3g} and above reported",
                  threshold.require_pose ? " x pose_share" : "",
                  threshold.require_identity ? " x identity" : "", *threshold.min_score);
  if (threshold.lowest_kept) {
    text += fmt::format("; average precision, calibration and BOP's scores from {:.3g} on",
                        *threshold.lowest_kept);
  }
  return text + "\n";
}

}  // namespace trivet::apps
