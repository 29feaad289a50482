#include "apps/evaluation_json.hpp"

#include <fmt/format.h>

#include <array>

namespace trivet::apps {
namespace {

using nlohmann::ordered_json;

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

ordered_json tally_json(const Tally& tally) {
  const auto [low, high] = wilson_interval(tally.right, tally.instances);
  return {{"instances", tally.instances},
          {"right", tally.right},
          {"recall", tally.recall()},
          {"recall_95_low", low},
          {"recall_95_high", high},
          {"add_right", tally.add_right},
          {"false_positives", tally.false_positives}};
}

ordered_json tallies_json(const std::vector<std::pair<std::string, Tally>>& tallies) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, tally] : tallies) object[name] = tally_json(tally);
  return object;
}

ordered_json optional_json(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json scene_evaluation_json(const ManifestScene& scene, const SceneEvaluation& evaluation,
                                   const std::optional<SceneResult>& result) {
  ordered_json detections = ordered_json::array(), missed = ordered_json::array();
  for (const JudgedDetection& judged : evaluation.detections) {
    const Detection& detection = result->detections[judged.detection];
    ordered_json entry{{"model", detection.model},
                       {"score", detection.score},
                       {"verdict", verdict_name(judged.verdict)}};
    if (judged.truth) {
      entry["truth"] = *judged.truth;
      entry["translation_error_over_diameter"] = judged.translation_error;
      entry["rotation_error_deg"] = judged.rotation_error_deg;
      entry["add_right"] = judged.add_right;
    }
    detections.push_back(std::move(entry));
  }
  for (const std::size_t truth : evaluation.missed) {
    missed.push_back({{"model", scene.truth[truth].model},
                      {"truth", truth},
                      {"occlusion", optional_json(scene.truth[truth].occlusion)}});
  }
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

ordered_json evaluation_json(const Manifest& manifest, const Evaluation& evaluation,
                             std::span<const std::optional<SceneResult>> results) {
  ordered_json seconds = ordered_json::object(), scenes = ordered_json::array();
  for (const auto& [stage, value] : evaluation.median_seconds.seconds) seconds[stage] = value;
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    scenes.push_back(scene_evaluation_json(manifest.scenes[s], evaluation.scenes[s], results[s]));
  }
  ordered_json document = tally_json(evaluation.total);
  document.update(
      {{"scenes_missing", evaluation.num_missing},
       {"median_translation_error_over_diameter",
        optional_json(evaluation.median_translation_error)},
       {"median_rotation_error_deg", optional_json(evaluation.median_rotation_error_deg)},
       {"median_seconds", std::move(seconds)},
       {"by_occlusion", tallies_json(evaluation.by_occlusion)},
       {"by_model", tallies_json(evaluation.by_model)},
       {"scenes", std::move(scenes)}});
  return document;
}

std::string evaluation_table(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<28} {:>13} {:>9} {:>14} {:>8} {:>7}\n", "", "right / all",
                                 "recall", "95 % interval", "false", "ADD");
  text += tally_row(fmt::format("{} scenes", evaluation.scenes.size()), evaluation.total, true);
  for (const auto& [name, tally] : evaluation.by_occlusion)
    text += tally_row("  occlusion " + name, tally, false);
  for (const auto& [name, tally] : evaluation.by_model) text += tally_row("  " + name, tally, true);
  if (evaluation.num_missing > 0)
    text += fmt::format("{} scenes have no result\n", evaluation.num_missing);
  if (evaluation.median_translation_error) {
    text += fmt::format("median error of right ones   {:.2f} % of the diameter, {:.2f} degrees\n",
                        100 * *evaluation.median_translation_error,
                        *evaluation.median_rotation_error_deg);
  }
  text += "median seconds a scene      ";
  for (const auto& [stage, value] : evaluation.median_seconds.seconds)
    text += fmt::format(" {} {:.3f}", stage, value);
  return text + "\n";
}

}  // namespace trivet::apps
