#include "apps/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/report_html.hpp"
#include "engine/draw_scene.hpp"
#include "engine/manifest_inputs.hpp"
#include "storage/file.hpp"
#include "storage/read_cloud.hpp"

namespace trivet::apps {
namespace {

/// Told apart by eye, and none like the outlines.
constexpr std::array<Colour, 10> kModelColours{{{236, 168, 62},
                                                {158, 118, 226},
                                                {62, 178, 178},
                                                {232, 124, 174},
                                                {178, 178, 74},
                                                {212, 116, 84},
                                                {120, 166, 216},
                                                {196, 150, 110},
                                                {200, 160, 222},
                                                {130, 190, 150}}};

struct VerdictStyle {
  const char* name;
  Colour outline;
};
constexpr VerdictStyle kRight{"right", {47, 214, 123}}, kWrong{"wrong", {255, 82, 82}},
    kNeutral{"neutral", {181, 188, 200}}, kMissed{"missed", {74, 163, 255}};

const VerdictStyle& style_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::right:
      return kRight;
    case Verdict::wrong:
      return kWrong;
    case Verdict::neutral:
      return kNeutral;
  }
  return kNeutral;
}

std::string css(const Colour& colour) {
  return fmt::format("rgb({},{},{})", colour.red, colour.green, colour.blue);
}

const Model* find_model(const Library& library, const std::string& name) {
  const auto found = std::find_if(library.models.begin(), library.models.end(),
                                  [&](const Model& model) { return model.name == name; });
  return found == library.models.end() ? nullptr : &*found;
}

/// The palette, then a paler one, and so on.
Colour colour_of(const Library& library, const Model& model) {
  const auto index = static_cast<std::size_t>(&model - library.models.data());
  Colour colour = kModelColours[index % kModelColours.size()];
  for (std::size_t round = 0; round < index / kModelColours.size() % 3; ++round) {
    for (std::uint8_t* value : {&colour.red, &colour.green, &colour.blue}) {
      *value = static_cast<std::uint8_t>(255 - (255 - *value) * 6 / 10);
    }
  }
  return colour;
}

std::string swatch(const Library& library, const std::string& name) {
  const Model* const model = find_model(library, name);
  if (!model) return escape_html(name);
  return fmt::format("<i class=\"swatch\" style=\"background:{}\"></i> {}",
                     css(colour_of(library, *model)), escape_html(name));
}

// Sums.

std::string card(std::string_view title, std::string_view value, std::string_view note) {
  return fmt::format(
      "<div class=\"card\"><span class=\"dim\">{}</span><b>{}</b><span "
      "class=\"dim\">{}</span></div>\n",
      title, value, note);
}

std::string cards(const Evaluation& evaluation) {
  const Tally& total = evaluation.total;
  const auto [low, high] = wilson_interval(total.right, total.instances);
  std::string out = "<div class=\"cards\">\n";
  out += card("Found", fmt::format("{:.1f} %", 100 * total.recall()),
              fmt::format("{} of {}; 95 %: {:.1f} to {:.1f} %", total.right, total.instances,
                          100 * low, 100 * high));
  out += card("False positives", fmt::format("{}", total.false_positives),
              fmt::format("in {} scenes", evaluation.scenes.size() - evaluation.num_missing));
  out += card("ADD below 10 %", fmt::format("{}", total.add_right),
              fmt::format("of {}", total.instances));
  if (evaluation.median_translation_error) {
    out += card(
        "Median error", fmt::format("{:.2f}°", *evaluation.median_rotation_error_deg),
        fmt::format("and {:.2f} % of the diameter", 100 * *evaluation.median_translation_error));
  }
  if (!evaluation.median_seconds.seconds.empty()) {
    out +=
        card("Median time",
             fmt::format("{:.2f} s", evaluation.median_seconds.seconds.back().second), "a scene");
  }
  return out + "</div>\n";
}

std::string tally_row(std::string_view name, const Tally& tally, bool with_false) {
  const auto [low, high] = wilson_interval(tally.right, tally.instances);
  return fmt::format(
      "<tr><td>{}<td class=\"n\">{} / {}<td class=\"n\">{:.0f} %<td><span class=\"bar\" title=\"95 "
      "%: {:.1f} to {:.1f} %\">"
      "<i style=\"width:{:.1f}%\"></i><u style=\"left:{:.1f}%;width:{:.1f}%\"></u></span><td "
      "class=\"n\">{}<td class=\"n\">{}\n",
      name, tally.right, tally.instances, 100 * tally.recall(), 100 * low, 100 * high,
      100 * tally.recall(), 100 * low, 100 * (high - low),
      with_false ? fmt::format("{}", tally.false_positives) : "", tally.add_right);
}

std::string tally_table(std::string_view title, const std::string& rows) {
  return fmt::format(
      "<div><h2>{0}</h2><div class=\"table\"><table><tr><th><th class=\"n\">found<th "
      "class=\"n\">recall"
      "<th>95 % interval<th class=\"n\">false<th class=\"n\">ADD\n{1}</table></div></div>\n",
      title, rows);
}

std::string tables(const Library& library, const Evaluation& evaluation) {
  std::string models, occlusions, stages;
  for (const auto& [name, tally] : evaluation.by_model)
    models += tally_row(swatch(library, name), tally, true);
  for (const auto& [name, tally] : evaluation.by_occlusion)
    occlusions += tally_row(escape_html(name), tally, false);
  const auto& seconds = evaluation.median_seconds.seconds;
  for (const auto& [stage, value] : seconds) {
    const double share =
        seconds.back().second > 0 ? std::min(1.0, value / seconds.back().second) : 0;
    stages += fmt::format(
        "<tr><td>{}<td class=\"n\">{:.3f} s<td><span class=\"bar\"><i "
        "style=\"width:{:.1f}%\"></i></span>\n",
        escape_html(stage), value, 100 * share);
  }
  return "<div class=\"tables\">\n" + tally_table("By model", models) + "<div>" +
         tally_table("By occlusion", occlusions) +
         "<h2>Median time a scene</h2><div class=\"table\"><table>" + stages +
         "</table></div></div></div>\n";
}

std::string key() {
  std::string out = "<div class=\"key\">";
  for (const auto& [style, text] : {std::pair{kRight, "right"},
                                    {kWrong, "false positive"},
                                    {kMissed, "missed"},
                                    {kNeutral, "not counted"}}) {
    out += fmt::format("<span><i class=\"swatch ring\" style=\"border-color:{}\"></i>{}</span>",
                       css(style.outline), text);
  }
  return out +
         "<span class=\"dim\">Fill: the model's colour, paler where something is in front of "
         "it.</span></div>\n";
}

// Scenes.

/// What is drawn into a scene: its detections, then what was missed. Labels stand in the same
/// order.
struct Drawing {
  std::vector<Overlay> overlays;
  std::vector<std::pair<const VerdictStyle*, std::string>> labels;
};

Drawing plan_drawing(const Library& library, const ManifestScene& scene,
                     const SceneEvaluation& evaluation, const std::optional<SceneResult>& result) {
  Drawing drawing;
  const auto add = [&](const std::string& name, const Pose& pose, const VerdictStyle& style,
                       bool filled, std::string label) {
    const Model* const model = find_model(library, name);
    if (!model) return;
    drawing.overlays.push_back({model, pose, style.outline, colour_of(library, *model), filled});
    drawing.labels.emplace_back(&style, std::move(label));
  };
  for (const JudgedDetection& judged : evaluation.detections) {
    const Detection& detection = result->detections[judged.detection];
    add(detection.model, detection.T_scene_model, style_of(judged.verdict), true,
        fmt::format("{} {:.2f}", detection.model, detection.score));
  }
  for (const std::size_t t : evaluation.missed) {
    add(scene.truth[t].model, scene.truth[t].T_scene_model, kMissed, false,
        scene.truth[t].model + " missed");
  }
  return drawing;
}

Result<std::string> image_tag(const Picture& picture, std::string_view text) {
  const auto png = encode_png(picture);
  if (!png) return png.error();
  return fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">", picture.width,
                     picture.height, escape_html(text), png_address(*png));
}

std::string labels(const Drawing& drawing, const std::vector<DrawnBox>& boxes) {
  std::string out;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].left > boxes[i].right) continue;
    const float x = std::clamp((boxes[i].left + boxes[i].right) / 2, 0.08F, 0.92F);
    const float y = std::clamp((boxes[i].top + boxes[i].bottom) / 2, 0.03F, 0.97F);
    out += fmt::format("<span class=\"tag {}\" style=\"left:{:.1f}%;top:{:.1f}%\">{}</span>",
                       drawing.labels[i].first->name, 100 * x, 100 * y,
                       escape_html(drawing.labels[i].second));
  }
  return out;
}

std::string detection_table(const Library& library, const ManifestScene& scene,
                            const SceneEvaluation& evaluation,
                            const std::optional<SceneResult>& result) {
  std::string rows;
  for (const JudgedDetection& judged : evaluation.detections) {
    const Detection& detection = result->detections[judged.detection];
    const char* const verdict = style_of(judged.verdict).name;
    rows +=
        fmt::format("<tr><td>{}<td class=\"{}\">{}<td class=\"n\">{:.3f}<td class=\"n\">{:.0f} %",
                    swatch(library, detection.model), verdict, verdict, detection.score,
                    100 * detection.visible_fraction);
    rows += judged.truth ? fmt::format("<td class=\"n\">{:.2f} %<td class=\"n\">{:.2f}°\n",
                                       100 * judged.translation_error, judged.rotation_error_deg)
                         : "<td><td>\n";
  }
  for (const std::size_t t : evaluation.missed) {
    const std::optional<double>& occlusion = scene.truth[t].occlusion;
    rows += fmt::format("<tr><td>{}<td class=\"missed\">missed{}<td><td><td><td>\n",
                        swatch(library, scene.truth[t].model),
                        occlusion ? fmt::format(", {:.0f} % covered", 100 * *occlusion) : "");
  }
  return "<details><summary>Scores and errors</summary><div><table><tr><th>model<th>verdict<th "
         "class=\"n\">score"
         "<th class=\"n\">agrees<th class=\"n\">translation<th class=\"n\">rotation\n" +
         rows + "</table></div></details>";
}

Result<std::string> scene_figure(const Library& library, const ManifestScene& scene,
                                 const SceneInput& input, const SceneEvaluation& evaluation,
                                 const std::optional<SceneResult>& result) {
  ReadOptions options;
  options.camera = input.camera;
  const Result<Cloud> cloud = read_cloud(input.file, options);
  if (!cloud) return cloud.error();
  const Drawing drawing = plan_drawing(library, scene, evaluation, result);
  const Result<ScenePictures> pictures = draw_scene(*cloud, input, drawing.overlays);
  if (!pictures) return pictures.error();
  const Result<std::string> scan = image_tag(pictures->scan, "scan " + scene.name);
  if (!scan) return scan.error();
  const Result<std::string> overlaid = image_tag(pictures->overlaid, "detections in " + scene.name);
  if (!overlaid) return overlaid.error();

  const Tally& tally = evaluation.tally;
  std::string caption = fmt::format("<b>{}</b><span class=\"right\">{} of {} found</span>",
                                    escape_html(scene.name), tally.right, tally.instances);
  if (tally.false_positives > 0)
    caption += fmt::format("<span class=\"wrong\">{} false</span>", tally.false_positives);
  if (evaluation.missing) caption += "<span class=\"missed\">no result</span>";
  if (result)
    caption += fmt::format("<span class=\"dim\">{:.2f} s</span>", result->stats.total_seconds);
  return fmt::format(
      "<figure><figcaption>{}</figcaption><div class=\"pair\"><div class=\"view\">{}</div><div "
      "class=\"view\">{}{}"
      "</div></div>{}</figure>\n",
      caption, *scan, *overlaid, labels(drawing, pictures->boxes),
      detection_table(library, scene, evaluation, result));
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, const Library& library,
                          const Manifest& manifest, const Evaluation& evaluation,
                          std::span<const std::optional<SceneResult>> results,
                          const Progress& progress) {
  std::string content = fmt::format(
      "<h1>Trivet: what was found</h1>\n<p class=\"dim\">Library {}: {} models. {} scenes.</p>\n",
      escape_html(library.file.filename().string()), library.models.size(), manifest.scenes.size());
  content += cards(evaluation) + tables(library, evaluation) + "<h2>Scenes</h2>\n" + key();
  const std::vector<SceneInput> inputs = scenes_of(manifest, library.header.unit);
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    if (progress.stop.stop_requested()) {
      return Error{ErrorCode::resumable,
                   fmt::format("stopped after drawing {} of {} scenes", s, inputs.size())};
    }
    const Result<std::string> figure =
        scene_figure(library, manifest.scenes[s], inputs[s], evaluation.scenes[s], results[s]);
    if (!figure) return figure.error();
    content += *figure;
    progress(s + 1, inputs.size(), manifest.scenes[s].name);
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return Error{ErrorCode::cannot_create, fmt::format("{}: {}", folder.string(), error.message())};
  const std::string page = html_page("Trivet: what was found", content);
  return publish_file(folder / "index.html", std::as_bytes(std::span(page)));
}

}  // namespace trivet::apps
