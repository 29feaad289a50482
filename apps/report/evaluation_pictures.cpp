#include "apps/report/evaluation_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/html.hpp"
#include "apps/results/evaluation_json.hpp"
#include "apps/words/score_words.hpp"

namespace trivet::apps {
namespace {

constexpr std::size_t kMaxProblems = 80, kMaxRight = 24;
constexpr double kNear = 1;  // diameters; a wrong detection farther away does not belong to a truth

struct Style {
  const char* name;
  Color outline;
};
constexpr Style kRight{"right", {47, 214, 123}}, kWrong{"wrong", {255, 82, 82}},
    kNeutral{"neutral", {181, 188, 200}}, kMissed{"missed", {74, 163, 255}},
    kDoubtful{"doubtful", {255, 196, 61}};

const Style& style_of(const JudgedDetection& judged) {
  if (!judged.reported) return kDoubtful;
  switch (judged.verdict) {
    case Verdict::right:
      return kRight;
    case Verdict::wrong:
      return kWrong;
    case Verdict::neutral:
      return kNeutral;
  }
  return kNeutral;
}

const Detection& detection_of(const ReportInput& input, std::size_t scene,
                              const JudgedDetection& judged) {
  return input.results[scene]->detections[judged.detection];
}

std::string rounded_percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// "91 % occluded, 84 % clutter": the conditions of a truth in the manifest.
std::string conditions(const TruthInstance& truth) {
  std::string out;
  for (const auto& [value, text] : {std::pair{truth.occlusion, "occluded"},
                                    {truth.clutter, "clutter"},
                                    {truth.visible_fraction, "visible"}}) {
    if (value)
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", rounded_percent(*value), text);
  }
  return out;
}

std::string errors(const JudgedDetection& judged) {
  return fmt::format("{:.1f} % of the diameter and {:.1f}° off", 100 * judged.translation_error,
                     judged.rotation_error_deg);
}

/// The drawings in a scene: its reported detections, then the missed truths. Labels are in the same
/// order.
struct Plan {
  std::vector<Overlay> overlays;
  std::vector<PictureLabel> labels;
};

Plan plan_scene(const ReportInput& input, std::size_t s) {
  Plan plan;
  const auto add = [&](const std::string& name, const FilePose& pose, const Style& style,
                       bool filled, std::string label) {
    const EvaluationMesh* const mesh = find_mesh(input.meshes, name);
    if (!mesh) return;
    plan.overlays.push_back({mesh, pose, style.outline, model_color(input.meshes, *mesh), filled});
    plan.labels.push_back({style.outline, std::move(label)});
  };
  for (const JudgedDetection& judged : input.evaluation.scenes[s].detections) {
    if (!judged.reported) continue;
    const Detection& detection = detection_of(input, s, judged);
    add(detection.model, in_file_frame(detection.T_scene_model, input.results[s]->offset),
        style_of(judged), true, detection.model + " " + score_text(detection.score));
  }
  for (const std::size_t t : input.evaluation.scenes[s].missed) {
    const TruthInstance& truth = input.manifest.scenes[s].truth[t];
    add(truth.model, truth.file_pose(), kMissed, false, truth.model + " missed");
  }
  return plan;
}

/// Why a truth was missed, if requested; else empty.
std::string why_paragraph(const ReportInput& input, std::size_t scene, std::size_t truth) {
  const auto why = input.whys.find({scene, truth});
  if (why == input.whys.end()) return "";
  return fmt::format("<p>It {}.</p>", escape_html(why->second));
}

std::string scene_table(const ReportInput& input, std::size_t s) {
  const SceneEvaluation& evaluation = input.evaluation.scenes[s];
  std::string rows;
  for (const JudgedDetection& judged : evaluation.detections) {
    if (!judged.reported) continue;
    const Detection& detection = detection_of(input, s, judged);
    const char* const verdict = style_of(judged).name;
    rows += fmt::format("<tr><td>{}<td class=\"{}\">{}<td class=\"n\">{}",
                        model_label(input.meshes, detection.model), verdict, verdict,
                        escape_html(score_text(detection.score)));
    rows += judged.truth ? fmt::format("<td class=\"n\">{:.2f} %<td class=\"n\">{:.2f}°\n",
                                       100 * judged.translation_error, judged.rotation_error_deg)
                         : "<td><td>\n";
  }
  for (const std::size_t t : evaluation.missed) {
    const TruthInstance& truth = input.manifest.scenes[s].truth[t];
    rows += fmt::format("<tr><td>{}<td class=\"missed\">missed<td colspan=\"3\">{}{}\n",
                        model_label(input.meshes, truth.model), conditions(truth),
                        why_paragraph(input, s, t));
  }
  return "<div class=\"wrap\"><table><tr><th>model<th>verdict<th class=\"n\">score<th "
         "class=\"n\">translation<th class=\"n\">rotation\n" +
         rows + "</table></div>";
}

/// The score and its parts, as far as they are known.
std::string score_parts(const Detection& detection) {
  std::string out = fmt::format("<b>{}</b>", escape_html(score_text(detection.score)));
  for (const auto& [value, text] : {std::pair{detection.visible_fraction, "agrees"},
                                    {detection.violation, "looked through"},
                                    {detection.contour, "of the outline free"}}) {
    if (std::isfinite(value))
      out += fmt::format(", {} {}", rounded_percent(static_cast<double>(value)), text);
  }
  return out;
}

/// Why this instance is shown, in words.
std::string finding(const JudgedDetection* answer, bool missed) {
  if (!answer) return "No answer of this model is near it.";
  if (!answer->reported && answer->found) return "Found, but its score is below the threshold.";
  if (missed) return fmt::format("The nearest answer is {}.", errors(*answer));
  if (answer->verdict == Verdict::right) return fmt::format("Found, {}.", errors(*answer));
  if (!answer->truth) return "The scene holds no such model.";
  if (answer->translation_error < 0.1 && answer->rotation_error_deg < 12)
    return "A second answer for an instance that is found already.";
  return fmt::format("The nearest instance of this model is {}.", errors(*answer));
}

}  // namespace

Gallery choose_exhibits(const ReportInput& input) {
  Gallery gallery;
  std::vector<Exhibit> missed, wrong;
  std::vector<std::pair<float, Exhibit>> right;
  for (std::size_t s = 0; s < input.evaluation.scenes.size(); ++s) {
    const SceneEvaluation& scene = input.evaluation.scenes[s];
    std::vector<bool> shown(scene.detections.size());
    for (const std::size_t t : scene.missed) {
      // The detection for a missed truth: the one that found it below the threshold, else the
      // nearest wrong one.
      std::optional<std::size_t> answer = scene.truths[t].found_by;
      for (std::size_t i = 0; i < scene.detections.size() && !scene.truths[t].found_by; ++i) {
        const JudgedDetection& judged = scene.detections[i];
        if (judged.truth != t || !judged.reported || judged.verdict != Verdict::wrong ||
            judged.translation_error > kNear) {
          continue;
        }
        if (!answer || judged.translation_error < scene.detections[*answer].translation_error)
          answer = i;
      }
      if (answer) shown[*answer] = true;
      missed.push_back({s, t, answer});
    }
    for (std::size_t i = 0; i < scene.detections.size(); ++i) {
      const JudgedDetection& judged = scene.detections[i];
      if (!judged.reported || shown[i] || judged.verdict == Verdict::neutral) continue;
      if (judged.verdict == Verdict::right) {
        right.push_back({detection_of(input, s, judged).score, {s, judged.truth, i}});
      } else {
        const bool near = judged.truth && judged.translation_error <= kNear;
        wrong.push_back({s, near ? judged.truth : std::nullopt, i});
      }
    }
  }
  std::stable_sort(right.begin(), right.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  gallery.problems = std::move(missed);
  gallery.problems.insert(gallery.problems.end(), wrong.begin(), wrong.end());
  gallery.num_problems = gallery.problems.size();
  gallery.num_right = right.size();
  gallery.problems.resize(std::min(kMaxProblems, gallery.problems.size()));
  for (std::size_t i = 0; i < std::min(kMaxRight, right.size()); ++i)
    gallery.right.push_back(right[i].second);
  return gallery;
}

std::string picture_key() {
  std::string out = "<div class=\"key\">";
  for (const auto& [style, text] : {std::pair{kRight, "right"},
                                    {kWrong, "wrong"},
                                    {kMissed, "the truth, missed or beside an answer"},
                                    {kDoubtful, "below the threshold"},
                                    {kNeutral, "not counted"}}) {
    out += fmt::format("<span><i class=\"swatch ring\" style=\"border-color:{}\"></i>{}</span>",
                       css(style.outline), text);
  }
  return out + "</div>\n";
}

Result<std::string> scene_figure(const ReportInput& input, std::size_t s, SceneDrawing& drawing,
                                 PictureStore& store) {
  const ManifestScene& scene = input.manifest.scenes[s];
  const Plan plan = plan_scene(input, s);
  const Result<ScenePictures> pictures = drawing.draw(plan.overlays);
  if (!pictures) return pictures.error();
  const std::string name = fmt::format("scene_{:04}", s);
  const Result<std::string> scan = store.add(pictures->scan, name + "_scan", "scan " + scene.name);
  if (!scan) return scan.error();
  const Result<std::string> overlaid =
      store.add(pictures->overlaid, name + "_found", "detections in " + scene.name);
  if (!overlaid) return overlaid.error();

  const SceneEvaluation& evaluation = input.evaluation.scenes[s];
  const Tally& tally = evaluation.tally;
  std::string caption = fmt::format("<b>{}</b><span class=\"right\">{} of {} found</span>",
                                    escape_html(scene.name), tally.right, tally.instances);
  if (tally.false_positives > 0)
    caption += fmt::format("<span class=\"wrong\">{} wrong</span>", tally.false_positives);
  if (evaluation.missing) caption += "<span class=\"missed\">no result</span>";
  if (input.results[s] && input.results[s]->stats.total_seconds > 0) {
    caption +=
        fmt::format("<span class=\"dim\">{:.2f} s</span>", input.results[s]->stats.total_seconds);
  }
  const std::array<ViewLayer, 2> layers{
      {{"Scan", *scan}, {"Found", *overlaid + picture_labels(plan.labels, pictures->boxes)}}};
  return fmt::format(
      "<figure><figcaption>{}</figcaption><div class=\"scene\">{}<div>{}</div></div></figure>\n",
      caption, layered_view(name + "_view", layers, 1), scene_table(input, s));
}

Result<std::string> exhibit_figure(const ReportInput& input, const Exhibit& exhibit,
                                   SceneDrawing& drawing, PictureStore& store,
                                   const std::string& name) {
  const ManifestScene& scene = input.manifest.scenes[exhibit.scene];
  const SceneEvaluation& evaluation = input.evaluation.scenes[exhibit.scene];
  const TruthInstance* const truth = exhibit.truth ? &scene.truth[*exhibit.truth] : nullptr;
  const JudgedDetection* const answer =
      exhibit.detection ? &evaluation.detections[*exhibit.detection] : nullptr;
  const Detection* const detection =
      answer ? &detection_of(input, exhibit.scene, *answer) : nullptr;
  const bool missed =
      truth && std::count(evaluation.missed.begin(), evaluation.missed.end(), *exhibit.truth) > 0;
  const std::string& model = truth ? truth->model : detection->model;
  const Style& style = missed ? kMissed : style_of(*answer);

  std::vector<Overlay> overlays;
  if (const EvaluationMesh* const mesh = find_mesh(input.meshes, model)) {
    if (truth) overlays.push_back({mesh, truth->file_pose(), kMissed.outline, {}, false});
    if (detection)
      overlays.push_back(
          {mesh,
           in_file_frame(detection->T_scene_model, input.results[exhibit.scene]->offset),
           style_of(*answer).outline,
           {},
           false});
  }
  const Result<ScenePictures> pictures = drawing.draw_around(overlays, overlays);
  if (!pictures) return pictures.error();
  const Result<std::string> scan = store.add(pictures->scan, name + "_scan", "what the sensor saw");
  if (!scan) return scan.error();
  const Result<std::string> drawn =
      store.add(pictures->overlaid, name + "_drawn", "truth and answer in outlines");
  if (!drawn) return drawn.error();

  std::string notes = fmt::format("<p>{}</p>", finding(answer, missed));
  if (truth && !conditions(*truth).empty())
    notes += fmt::format("<p class=\"dim\">{}</p>", conditions(*truth));
  if (detection) notes += fmt::format("<p class=\"dim\">score {}</p>", score_parts(*detection));
  if (missed) notes += why_paragraph(input, exhibit.scene, *exhibit.truth);
  const std::array<ViewLayer, 2> layers{{{"Scan", *scan}, {"Outlines", *drawn}}};
  return fmt::format(
      "<figure class=\"exhibit\"><figcaption><b>{}</b><span class=\"{}\">{}</span><span "
      "class=\"dim\">{}</span></figcaption>{}{}</figure>\n",
      model_label(input.meshes, model), style.name, style.name, escape_html(scene.name),
      layered_view(name, layers, 1), notes);
}

}  // namespace trivet::apps
