#include "apps/report/recognition_scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "apps/report/html.hpp"
#include "apps/words/camera_words.hpp"
#include "apps/words/place_text.hpp"
#include "apps/words/rejection_words.hpp"
#include "apps/words/score_words.hpp"
#include "apps/words/view_words.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps {
namespace {

constexpr Color kQuiet{112, 118, 130};        // detections, in the picture of the rejected poses
constexpr float kLeastPicturedScore = 0.01F;  // rejected poses with lower scores are not drawn
constexpr float kNothing = 0.005F;            // of log odds: rounding errors
constexpr float kSmall = 0.6F;  // models within such a fraction of the picture get a close-up

/// One scene, and the data for its figure.
struct Subject {
  const RecognitionReport& report;
  const SceneInput& input;
  const SceneResult& result;
  std::span<const EvaluationMesh> models;

  const kernels::ScoreModel& score() const { return report.recognizer.score(); }
  /// The most that each part can contribute in this scan.
  std::array<float, kernels::kNumScoreParts> most() const {
    const std::optional<kernels::SensorModel>& sensor = result.stats.sensor;
    return most_evidence(score(), sensor ? sensor->correlation : 0);
  }
};

std::string percent(float share) { return fmt::format("{:.0f} %", 100 * share); }

/// A score, escaped for HTML.
std::string score_cell(float score) { return escape_html(score_text(score)); }

/// The pose in the form "at 0.2204, 0.09953, 0.5979 m, turned by 123.4° about 0.10, -0.98, 0.17".
std::string placement(const Subject& subject, const Detection& detection, std::string_view unit) {
  constexpr float kDegreesPerRadian = 57.29578F;
  const Eigen::AngleAxisf turn(detection.T_scene_model.linear());
  const Eigen::Vector3f& axis = turn.axis();
  return fmt::format("at {} {}, turned by {:.1f}° about {:.2f}, {:.2f}, {:.2f}",
                     place_text(detection, subject.result.offset), unit,
                     kDegreesPerRadian * turn.angle(), axis.x(), axis.y(), axis.z());
}

const char* scene_unit(const Subject& subject) {
  return unit_name(
      apps::scene_unit(subject.input, subject.report.recognizer.library().header.unit));
}

Color brighter(const Color& color) {
  const auto up = [](std::uint8_t value) {
    return static_cast<std::uint8_t>(255 - (255 - value) * 2 / 5);
  };
  return {up(color.red), up(color.green), up(color.blue)};
}

/// Whether a rejected pose deserves a picture: its score is high enough, and it is not just a worse
/// alternative to a detection of its model.
bool deserves_picture(const Subject& subject, const RejectedPose& rejected) {
  const bool beneath_its_like =
      rejected.explained_by &&
      subject.result.detections[*rejected.explained_by].model == rejected.model;
  return rejected.score >= kLeastPicturedScore &&
         !(rejected.reason == Rejection::too_low && beneath_its_like);
}

/// The rejected poses that get a row: those with a picture, and the best of each model without any
/// detection.
std::vector<std::size_t> listed_rejections(const Subject& subject) {
  std::vector<std::size_t> out;
  std::set<std::string_view> shown_models;
  for (const Detection& detection : subject.result.detections) shown_models.insert(detection.model);
  for (std::size_t r = 0; r < subject.result.rejected.size(); ++r) {
    const RejectedPose& rejected = subject.result.rejected[r];
    if (shown_models.insert(rejected.model).second || deserves_picture(subject, rejected))
      out.push_back(r);
  }
  return out;
}

/// The label of a rejected pose in picture and tables; detections are 1, 2, ...
std::string rejected_id(std::size_t index) { return fmt::format("R{}", index + 1); }

// Why a pose was rejected.

struct Reason {
  const char* style;  // a CSS class of the page
  Color outline;
};
const Reason& reason_of(const RejectedPose& rejected) {
  static constexpr Reason kTooLow{"doubtful", {255, 196, 61}},
      kExplained{"neutral", {215, 220, 230}}, kTooMany{"missed", {74, 163, 255}};
  switch (rejected.reason) {
    case Rejection::too_low:
      return kTooLow;
    case Rejection::explained:
      return kExplained;
    case Rejection::too_many:
      return kTooMany;
  }
  return kTooLow;
}

std::string reason_cell(const Subject& subject, const RejectedPose& rejected) {
  const RejectionWords words =
      rejection_words(subject.result, rejected, subject.score(), subject.report.options);
  std::string out = fmt::format("<span class=\"{}\">{}</span>", reason_of(rejected).style,
                                escape_html(words.what));
  if (!words.why.empty()) out += ": " + escape_html(words.why);
  if (rejected.explained_by) out += fmt::format(" ({})", *rejected.explained_by + 1);
  return out;
}

// Tables.

std::string table(std::string_view title, std::string_view head, const std::string& rows) {
  return fmt::format(
      "<h2>{}</h2><div "
      "class=\"wrap\" "
      "tabindex=\"0\"><table><thead><tr>{}</thead><tbody>\n{}</tbody></table></div>\n",
      title, head, rows);
}

/// Alternatives that the scan does not distinguish from a detection: "2 other poses; can_1 38 %".
std::string other_than(const Detection& detection) {
  std::string out;
  if (!detection.alternatives.empty())
    out = counted(detection.alternatives.size(), "other pose", "other poses");
  if (detection.is_uncertain) out += (out.empty() ? "" : "; ") + std::string("a place beside it");
  for (std::size_t k = 1; k < detection.candidates.size(); ++k) {
    const Candidate& candidate = detection.candidates[k];
    out +=
        (out.empty() ? "" : "; ") + escape_html(candidate.model) + " " + percent(candidate.share);
  }
  return out;
}

/// "93 %", and for an object that extends beyond the scan "46 %, 30 % outside the scan".
std::string visibility(const Detection& detection) {
  constexpr float kHardly = 0.01F;
  std::string out = percent(detection.visible_fraction);
  if (detection.hidden_fraction >= kHardly)
    out += fmt::format(", {} hidden", percent(detection.hidden_fraction));
  if (detection.outside_fraction >= kHardly)
    out += fmt::format(", {} outside the scan", percent(detection.outside_fraction));
  return out;
}

/// Two rows for each: numbers, then the place and the evidence against it.
std::string found_table(const Subject& subject) {
  const std::vector<Detection>& detections = subject.result.detections;
  if (detections.empty()) return "<h2>Found</h2><p class=\"dim\">None of the models.</p>\n";
  const std::string unit = scene_unit(subject);
  std::string rows;
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const Detection& detection = detections[d];
    rows += fmt::format(
        "<tr class=\"head\"><td class=\"id\">{}<td>{}<td class=\"n\"><b>{}</b><td "
        "class=\"words\">{}<td class=\"n\">{:.3g}\n<tr><td class=\"id\"><td class=\"words dim\" "
        "colspan=\"4\">{}",
        d + 1, model_label(subject.models, detection.model), score_cell(detection.score),
        visibility(detection), detection.rmse, placement(subject, detection, unit));
    if (const std::string others = other_than(detection); !others.empty())
      rows += fmt::format("; <span class=\"doubtful\">ambiguous with {}</span>", others);
    if (const std::string costs = cost_words(detection, subject.score()); !costs.empty())
      rows += "; costs: " + escape_html(costs);
    rows += '\n';
  }
  return "<div class=\"found\">" +
         table("Found",
               fmt::format("<td><th>model<th class=\"n\">score<th>visible<th class=\"n\">rmse [{}]",
                           unit),
               rows) +
         "</div>";
}

std::string rejected_table(const Subject& subject) {
  const std::vector<std::size_t> shown = listed_rejections(subject);
  std::string rows, rest;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const RejectedPose& rejected = subject.result.rejected[shown[i]];
    rows += fmt::format(
        "<tr><td class=\"id\">{}<td>{}<td class=\"n\"><b>{}</b><td class=\"words\">{}\n",
        rejected_id(i), model_label(subject.models, rejected.model), score_cell(rejected.score),
        reason_cell(subject, rejected));
  }
  if (const std::size_t more = subject.result.rejected.size() - shown.size(); more > 0) {
    rest =
        fmt::format("<p class=\"dim\">{} more {}below {} or a worse guess at what was found.</p>\n",
                    more, more == 1 ? "is " : "are ", kLeastPicturedScore);
  }
  if (rows.empty()) return "<h2>Rejected</h2><p class=\"dim\">Nothing worth a look.</p>\n" + rest;
  return table("Rejected", "<td><th>model<th class=\"n\">score<th>why not", rows) + rest;
}

/// One row that adds up: the log odds, their initial value, the reduction by other answers, and
/// bars. The length of a bar is the most that its part can contribute, the filled length its
/// contribution.
std::string parts_row(const Subject& subject, const std::string& id, const std::string& model,
                      float score, const kernels::ScoreParts& parts) {
  const auto most = subject.most();
  const float largest = *std::max_element(most.begin(), most.end());
  std::string row = fmt::format("<tr><td class=\"id\">{}<td>{}<td class=\"n\">{}", id,
                                model_label(subject.models, model), score_cell(score));
  const std::array<float, 2> shares = kernels::sensor_shares(parts);
  const float bias = shares[0] * subject.score().bias[0] + shares[1] * subject.score().bias[1];
  const float others = deduction(subject.score(), parts, score);
  float sum = bias + others;
  for (std::size_t k = 0; k < parts.size(); ++k)
    sum += kernels::part_evidence(subject.score(), parts, k);
  // A rounding error is not a reduction by other answers.
  row += fmt::format("<td class=\"n\">{:+.1f}<td class=\"n\">{:+.1f}<td class=\"n\">{}", sum, bias,
                     others < -kNothing ? fmt::format("{:+.1f}", others) : "");
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (!(most[k] > 0)) continue;
    const float gives = kernels::part_evidence(subject.score(), parts, k);
    row += fmt::format(
        "<td title=\"{}: {}\"><span class=\"part\" style=\"width:{:.0f}%\"><i "
        "style=\"width:{:.0f}%\"></i></span><span class=\"dim\">{:.1f}</span>",
        words_of(k).label, finding_of(k, parts[k]), 100 * most[k] / largest, 100 * gives / most[k],
        gives);
  }
  return row + "\n";
}

std::string parts_table(const Subject& subject) {
  const auto most = subject.most();
  std::string head = "<td><th>model<th class=\"n\">score";
  for (const PartWords& row : {kScoreRows.sum, kScoreRows.begin, kScoreRows.others})
    head += fmt::format("<th class=\"n\" title=\"{}\">{}", row.meaning, row.label);
  std::string rows;
  for (std::size_t k = 0; k < most.size(); ++k) {
    if (most[k] > 0)
      head += fmt::format("<th title=\"{}\">{}<span><br>of {:.1f}</span>", words_of(k).meaning,
                          words_of(k).label, most[k]);
  }
  for (std::size_t d = 0; d < subject.result.detections.size(); ++d) {
    const Detection& detection = subject.result.detections[d];
    rows += parts_row(subject, std::to_string(d + 1), detection.model, detection.score,
                      detection.parts);
  }
  const std::vector<std::size_t> shown = listed_rejections(subject);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const RejectedPose& rejected = subject.result.rejected[shown[i]];
    rows += parts_row(subject, rejected_id(i), rejected.model, rejected.score, rejected.parts);
  }
  if (rows.empty()) return "";
  return "<div class=\"parts\">" + table("What spoke for and against", head, rows) + "</div>";
}

std::string times_and_counts(const Subject& subject) {
  const SceneStats& stats = subject.result.stats;
  std::string rows;
  double longest = 0;
  for (const auto& [stage, seconds] : stats.times.seconds) longest = std::max(longest, seconds);
  for (const auto& [stage, seconds] : stats.times.seconds) {
    rows += fmt::format(
        "<tr><td>{}<td class=\"n\">{:.3f} s<td><span class=\"bar\"><i "
        "style=\"width:{:.1f}%\"></i></span>\n",
        escape_html(stage), seconds, longest > 0 ? 100 * seconds / longest : 0);
  }
  std::string counts;
  for (const auto& [name, value] : {std::pair{"points", std::uint64_t{stats.num_points}},
                                    {"invalid points", std::uint64_t{stats.num_invalid}},
                                    {"references", stats.num_references},
                                    {"pairs", stats.num_pairs},
                                    {"votes", stats.num_votes},
                                    {"hypotheses", stats.num_hypotheses},
                                    {"refined", stats.num_refined},
                                    {"examined by rays", stats.num_examined}}) {
    counts += fmt::format("<tr><td>{}<td class=\"n\">{}\n", name, value);
  }
  return fmt::format(
      "<details><summary>Times and counts</summary><div class=\"pair\"><table>{}</table>"
      "<table>{}</table></div></details>",
      rows, counts);
}

std::string caption(const Subject& subject) {
  const SceneResult& result = subject.result;
  const auto ambiguous = std::ranges::count_if(result.detections, &Detection::is_ambiguous);
  std::string out =
      fmt::format("<b>{}</b><span class=\"{}\">{} found</span>",
                  escape_html(subject.input.file.filename().string()),
                  result.detections.empty() ? "neutral" : "right", result.detections.size());
  if (ambiguous > 0) out += fmt::format("<span class=\"doubtful\">{} ambiguous</span>", ambiguous);
  return out + fmt::format("<span class=\"dim\">{}, noise {:.3g} {}, {:.2f} s</span>",
                           counted(result.stats.num_points, "point", "points"), result.stats.noise,
                           scene_unit(subject), result.stats.total_seconds);
}

/// "0.4 mm", "0.9 m": a length in the scene's unit.
std::string length_words(const Subject& subject, float length) {
  const bool meters = scene_unit(subject) == std::string_view(unit_name(LengthUnit::meter));
  const float in_meters = meters ? length : length / 1000;
  return in_meters < 0.1F ? fmt::format("{:.2g} mm", 1000 * in_meters)
                          : fmt::format("{:.3g} m", in_meters);
}

/// The assumed viewpoint of the scene; empty if the caller or the file gave it.
std::string view_in_words(const Subject& subject) {
  const std::optional<SceneView>& view = subject.result.stats.view;
  const std::optional<std::string> words = view ? view_words(*view) : std::nullopt;
  return words ? fmt::format("<p>The scan was {}.</p>\n", *words) : "";
}

/// The measurement errors of the scan; empty for closed surfaces, which no sensor has measured.
std::string sensor_in_words(const Subject& subject) {
  const std::optional<kernels::SensorModel>& sensor = subject.result.stats.sensor;
  if (!sensor || !(sensor->noise > 0)) return "";
  std::string out = fmt::format("The scan errs by {} at {}",
                                length_words(subject, sensor->error_at(sensor->range)),
                                length_words(subject, sensor->range));
  if (sensor->exponent > 0)
    out += fmt::format(", growing with range to the power {:.1f}", sensor->exponent);
  constexpr float kHardly = 0.1F, kMostly = 0.5F;
  out += sensor->correlation < kHardly   ? "; each pixel errs for itself"
         : sensor->correlation < kMostly ? "; neighboring pixels err somewhat alike"
                                         : "; neighboring pixels err alike (a camera that matches "
                                           "windows)";
  const auto edge = std::lround(sensor->edge_pixels());
  if (edge >= 2) out += fmt::format(", so outlines count as uncertain within {} pixels", edge);
  if (sensor->smoothing > 0)
    out += fmt::format(
        "; a filter has smoothed it over {} pixels, and so are the models that it is compared with",
        std::lround(sensor->smoothing));
  return fmt::format("<p class=\"dim\">{}.</p>\n", out);
}

/// The errors of the given camera; empty if there seem to be none.
std::string camera_in_words(const Subject& subject) {
  const std::optional<CameraCheck>& check = subject.result.stats.camera_check;
  const std::optional<std::string> finding = check ? camera_finding(*check) : std::nullopt;
  return finding
             ? fmt::format("<p>By {} of these objects {}.</p>\n", check->objects.size(), *finding)
             : "";
}

// Pictures.

struct FigurePlan {
  std::vector<Overlay> overlays;
  std::vector<PictureLabel> labels;

  void add(const EvaluationMesh& mesh, const FilePose& pose, const Color& outline,
           const Color& surface, bool filled, std::string label) {
    overlays.push_back({&mesh, pose, outline, surface, filled});
    labels.push_back({outline, std::move(label)});
  }
};

FigurePlan plan_found(const Subject& subject) {
  FigurePlan plan;
  for (std::size_t d = 0; d < subject.result.detections.size(); ++d) {
    const Detection& detection = subject.result.detections[d];
    const EvaluationMesh& mesh = *find_mesh(subject.models, detection.model);
    const Color color = model_color(subject.models, mesh);
    plan.add(mesh, in_file_frame(detection.T_scene_model, subject.result.offset), brighter(color),
             color, true, fmt::format("{} {}", d + 1, detection.model));
  }
  return plan;
}

FigurePlan plan_rejected(const Subject& subject) {
  FigurePlan plan;
  const std::vector<std::size_t> shown = listed_rejections(subject);
  if (shown.empty()) return {};
  for (const Detection& detection : subject.result.detections) {
    const EvaluationMesh& mesh = *find_mesh(subject.models, detection.model);
    plan.add(mesh, in_file_frame(detection.T_scene_model, subject.result.offset), kQuiet, kQuiet,
             true, "");
  }
  for (std::size_t i = shown.size(); i-- > 0;) {  // draw the best one last
    const RejectedPose& rejected = subject.result.rejected[shown[i]];
    plan.add(*find_mesh(subject.models, rejected.model),
             in_file_frame(rejected.T_scene_model, subject.result.offset),
             reason_of(rejected).outline, {}, false, rejected_id(i));
  }
  return plan;
}

/// Whether everything that is drawn is in a small part of the picture.
bool is_small(std::span<const DrawnBox> boxes) {
  DrawnBox all;
  for (const DrawnBox& box : boxes) {
    all.left = std::min(all.left, box.left);
    all.right = std::max(all.right, box.right);
    all.top = std::min(all.top, box.top);
    all.bottom = std::max(all.bottom, box.bottom);
  }
  return all.left < all.right && all.right - all.left < kSmall && all.bottom - all.top < kSmall;
}

/// Draws one scene and stores the pictures under its name.
class Painter {
 public:
  Painter(SceneDrawing& drawing, PictureStore& store, std::string name, std::string scene)
      : drawing_(drawing), store_(store), name_(std::move(name)), scene_(std::move(scene)) {}

  /// The scene, with a close-up below it if the detections, or else the rejected poses, are small.
  Result<std::string> views(const FigurePlan& found, const FigurePlan& rejected) {
    const std::span<const Overlay> models =
        found.overlays.empty() ? rejected.overlays : found.overlays;
    const Result<View> full =
        view("", found, rejected, [&](const auto& overlays) { return drawing_.draw(overlays); });
    if (!full) return full.error();
    if (!is_small(full->boxes)) return full->html;
    const Result<View> close = view("_close", found, rejected, [&](const auto& overlays) {
      return drawing_.draw_around(models, overlays);
    });
    if (!close) return close.error();
    return full->html + close->html;
  }

 private:
  struct View {
    std::string html;
    std::vector<DrawnBox> boxes;  // boxes of the detections, or else of the rejected poses
  };

  /// One view with three layers: the scan, the detections and the rejected poses. The reader sees
  /// one at a time.
  template <class Draw>
  Result<View> view(const std::string& kind, const FigurePlan& found, const FigurePlan& rejected,
                    Draw&& draw) {
    std::vector<std::pair<std::string, const FigurePlan*>> plans{{"Found", &found},
                                                                 {"Rejected", &rejected}};
    std::erase_if(plans, [](const auto& plan) { return plan.second->overlays.empty(); });
    if (plans.empty()) plans.emplace_back("", &found);  // draw the scan in any case
    std::vector<ViewLayer> layers;
    std::vector<DrawnBox> boxes;
    for (const auto& [name, plan] : plans) {
      const Result<ScenePictures> drawn = draw(plan->overlays);
      if (!drawn) return drawn.error();
      if (layers.empty()) {
        boxes = drawn->boxes;
        TRIVET_TRY(add("Scan", kind, drawn->scan, "", layers));
      }
      if (name.empty()) continue;
      const Result<void> done =
          add(name, kind, drawn->overlaid, picture_labels(plan->labels, drawn->boxes), layers);
      if (!done) return done.error();
    }
    const std::size_t shown = std::min<std::size_t>(1, layers.size() - 1);
    return View{layered_view(name_ + "_view" + kind, layers, shown), std::move(boxes)};
  }
  Result<void> add(const std::string& layer, const std::string& kind, const Picture& picture,
                   const std::string& labels, std::vector<ViewLayer>& layers) {
    std::string what = layer;
    what.replace(0, 1, formats::lower_case(what.substr(0, 1)));
    const Result<std::string> image = store_.add(picture, fmt::format("{}_{}{}", name_, what, kind),
                                                 fmt::format("{}: {}", scene_, what));
    if (!image) return image.error();
    layers.push_back({layer, *image + labels});
    return {};
  }

  SceneDrawing& drawing_;
  PictureStore& store_;
  std::string name_, scene_;
};

}  // namespace

Result<std::string> recognition_figure(const RecognitionReport& report, std::size_t s,
                                       std::span<const EvaluationMesh> models,
                                       PictureStore& store) {
  const Subject subject{report, report.scenes[s], report.results[s], models};
  const std::string name = fmt::format("scene_{:04}", s);
  Result<std::string> views("");
  Result<SceneDrawing> drawing = open_scene(subject.input, models);
  if (drawing) {
    Painter painter(*drawing, store, name, subject.input.file.filename().string());
    views = painter.views(plan_found(subject), plan_rejected(subject));
    if (!views) return views.error();
  } else if (drawing.error().code == ErrorCode::bad_data) {
    views = fmt::format("<p class=\"dim\">Nothing to draw: {}</p>",
                        escape_html(drawing.error().message));
  } else {
    return drawing.error();
  }
  return fmt::format(
      "<figure class=\"long\" id=\"{}\"><figcaption>{}</figcaption>{}{}{}<div "
      "class=\"scene\"><div class=\"views\">{}</div><div>{}{}</div></div>{}{}</figure>\n",
      name, caption(subject), view_in_words(subject), sensor_in_words(subject),
      camera_in_words(subject), *views, found_table(subject), rejected_table(subject),
      parts_table(subject), times_and_counts(subject));
}

}  // namespace trivet::apps
