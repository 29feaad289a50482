#include "apps/report/evaluation_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/charts.hpp"
#include "apps/report/evaluation_pictures.hpp"
#include "apps/report/html.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "storage/files/file.hpp"

namespace trivet::apps {
namespace {

/// The approximate size of an embedded close-up [byte].
constexpr std::size_t kExhibitBytes = 75'000;

// The result in words.

/// "Of 3 missed, 2 are occluded by 70 % or more", if the occlusion of all is known.
std::string where_missed(const ReportInput& input) {
  constexpr double kMuch = 0.7;
  std::size_t known = 0, much = 0;
  for (std::size_t s = 0; s < input.evaluation.scenes.size(); ++s) {
    for (const std::size_t t : input.evaluation.scenes[s].missed) {
      const std::optional<double>& occlusion = input.manifest.scenes[s].truth[t].occlusion;
      known += occlusion ? 1 : 0;
      much += occlusion.value_or(0) >= kMuch ? 1 : 0;
    }
  }
  const std::size_t missed = input.evaluation.total.instances - input.evaluation.total.right;
  if (missed == 0 || known < missed) return "";
  return fmt::format(" Of {} missed, {} {} occluded by 70 % or more.", missed, much,
                     much == 1 ? "is" : "are");
}

std::string headline(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  const Tally& total = evaluation.total;
  const auto [low, high] = wilson_interval(total.right, total.instances);
  std::string out = fmt::format(
      "<p class=\"headline\">{} of {} found ({}; {:.0f} to {:.0f} % with 95 % confidence), {} in "
      "{}.",
      total.right, counted(total.instances, "instance", "instances"), percent(total.recall()),
      100 * low, 100 * high,
      total.false_positives == 0 ? "no false alarm"
                                 : counted(total.false_positives, "false alarm", "false alarms"),
      counted(evaluation.scenes.size() - evaluation.num_missing, "scene", "scenes"));
  out += where_missed(input);
  if (evaluation.median_translation_error) {
    out += fmt::format(
        " Half of the right poses are off by less than {:.2f} % of the diameter and {:.2f}°.",
        100 * *evaluation.median_translation_error, *evaluation.median_rotation_error_deg);
  }
  if (!evaluation.seconds.empty() && evaluation.seconds.back().stage == "total") {
    out += fmt::format(" A scene takes {:.2f} s (median).", evaluation.seconds.back().median);
  }
  if (evaluation.num_missing > 0) {
    out += fmt::format(" {} without result, counted as not found.",
                       counted(evaluation.num_missing, "scene is", "scenes are"));
  }
  return out + "</p>\n";
}

std::string cards(const Evaluation& evaluation) {
  const Tally& total = evaluation.total;
  std::string out = "<div class=\"cards\">\n";
  out += card("Recall", percent(total.recall()),
              fmt::format("{} of {}", total.right, total.instances));
  out += card("Precision", percent(total.precision()),
              counted(total.false_positives, "false alarm", "false alarms"));
  out += card("ADD below 10 %", fmt::format("{}", total.add_right),
              fmt::format("of {}", total.instances));
  out += card("Average precision", fmt::format("{:.3f}", evaluation.curve.average_precision),
              "over all scores");
  if (evaluation.median_translation_error) {
    out += card(
        "Median error", fmt::format("{:.2f}°", *evaluation.median_rotation_error_deg),
        fmt::format("and {:.2f} % of the diameter", 100 * *evaluation.median_translation_error));
  }
  if (!evaluation.seconds.empty()) {
    const StageSeconds& total_time = evaluation.seconds.back();
    out += card("Median time", fmt::format("{:.2f} s", total_time.median),
                fmt::format("a scene; 95 % below {:.2f} s", total_time.p95));
  }
  return out + "</div>\n";
}

// Tables.

std::string tally_row(std::string_view name, const Tally& tally, bool with_false) {
  const auto [low, high] = wilson_interval(tally.right, tally.instances);
  std::string row =
      fmt::format("<tr><td>{}<td class=\"n\">{} / {}", name, tally.right, tally.instances);
  if (tally.instances == 0) {
    row += "<td><td><td>";
  } else {
    row += fmt::format(
        "<td class=\"n\">{:.0f} %<td><span class=\"bar\"><i style=\"width:{:.1f}%\"></i>"
        "<u style=\"left:{:.1f}%;width:{:.1f}%\"></u></span><td class=\"n dim\">{:.0f} – {:.0f}",
        100 * tally.recall(), 100 * tally.recall(), 100 * low, 100 * (high - low), 100 * low,
        100 * high);
  }
  if (with_false) {
    row += fmt::format("<td class=\"n\">{}<td class=\"n\">{}", tally.false_positives,
                       tally.right + tally.false_positives > 0
                           ? fmt::format("{:.0f} %", 100 * tally.precision())
                           : "");
  }
  return row + fmt::format("<td class=\"n\">{}\n", tally.add_right);
}

std::string tally_table(std::string_view title, const std::string& rows, bool with_false) {
  return fmt::format(
      "<div{}><h2>{}</h2><div class=\"table tally\"><table><tr><td><th class=\"n\">found<th "
      "class=\"n\">recall<td><th class=\"n\">95 %{}<th class=\"n\">ADD\n{}</table></div></div>\n",
      with_false ? " class=\"wide\"" : "", title,
      with_false ? "<th class=\"n\">false<th class=\"n\">precision" : "", rows);
}

std::string group_table(std::string_view title, const Tallies& tallies) {
  if (tallies.empty()) return "";
  std::string rows;
  for (const auto& [name, tally] : tallies) rows += tally_row(escape_html(name), tally, false);
  return tally_table(title, rows, false);
}

std::string time_table(const std::vector<StageSeconds>& stages) {
  if (stages.empty()) return "";
  double longest = 0;
  for (const StageSeconds& stage : stages) longest = std::max(longest, stage.p95);
  const auto width = [&](double seconds) { return longest > 0 ? 100 * seconds / longest : 0; };
  std::string rows;
  for (const StageSeconds& stage : stages) {
    rows += fmt::format(
        "<tr><td>{}<td class=\"n\">{:.3f} s<td class=\"n\">{:.3f} s<td><span class=\"bar\">"
        "<i style=\"width:{:.1f}%\"></i><u style=\"left:{:.1f}%;width:{:.1f}%\"></u></span>\n",
        escape_html(stage.stage), stage.median, stage.p95, width(stage.median), width(stage.median),
        width(stage.p95 - stage.median));
  }
  return fmt::format(
      "<div><h2>Time a scene</h2><div class=\"table\"><table><tr><th>stage<th "
      "class=\"n\">median<th class=\"n\">95 %<td>\n{}</table></div></div>\n",
      rows);
}

std::string bop_table(const BopScores& bop) {
  const auto row = [](std::string_view name, const std::optional<double>& recall,
                      const std::optional<double>& precision) {
    const auto cell = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.3f}", *value) : std::string();
    };
    return fmt::format("<tr><td>{}<td class=\"n\">{}<td class=\"n\">{}\n", name, cell(recall),
                       cell(precision));
  };
  const BopRecall& recall = bop.localization;
  const BopPrecision& precision = bop.detection;
  return fmt::format(
      "<div><h2>BOP scores</h2><div class=\"table\"><table><tr><td><th class=\"n\">AR, "
      "localization<th class=\"n\">AP, detection\n{}</table></div></div>\n",
      row("mean", recall.mean, precision.mean) + row("VSD", recall.vsd, {}) +
          row("MSSD", recall.mssd, precision.mssd) + row("MSPD", recall.mspd, precision.mspd));
}

std::string tables(const ReportInput& input) {
  std::string models;
  for (const auto& [name, tally] : input.evaluation.by_model)
    models += tally_row(model_label(input.meshes, name), tally, true);
  return "<div class=\"tables\">\n" + tally_table("By model", models, true) +
         group_table("By occlusion", input.evaluation.by_occlusion) +
         group_table("By clutter", input.evaluation.by_clutter) +
         group_table("By visible share", input.evaluation.by_visible_fraction) +
         bop_table(input.bop) + time_table(input.evaluation.seconds) + "</div>\n";
}

// Curves.

std::string charts(const Evaluation& evaluation) {
  if (evaluation.curve.points.empty()) return "";
  std::string out =
      "<div class=\"tables\">\n<div><h2>Precision and recall</h2><div class=\"table\">" +
      precision_recall_chart(evaluation) +
      "<p class=\"key\"><span><i class=\"dot reported\"></i>what was reported</span>";
  if (const auto& best = evaluation.curve.best_f1) {
    out +=
        fmt::format("<span><i class=\"dot best\"></i>best F1 {:.3f}, from score {:.3f} on</span>",
                    best->f1(), best->score);
  }
  out += "</p></div></div>\n";
  if (!evaluation.calibration) return out + "</div>\n";
  return out + "<div><h2>What a score is worth</h2><div class=\"table\">" +
         calibration_chart(*evaluation.calibration) +
         fmt::format(
             "<p class=\"key\"><span>Share of right detections by score, with 95 % intervals; on "
             "the dashed line a score is a probability. Mean distance from it: {:.2f}.</span></p>"
             "</div></div>\n</div>\n",
             evaluation.calibration->expected_error);
}

// Pictures.

/// The figures of one report, in the order of the page.
struct Figures {
  std::vector<std::string> problems, right, scenes;
};

Result<Figures> draw_figures(const ReportInput& input, const Gallery& gallery, PictureStore& store,
                             const Progress& progress) {
  Figures figures;
  figures.problems.resize(gallery.problems.size());
  figures.right.resize(gallery.right.size());
  // Meshes and scenes are both in the manifest's unit.
  const std::vector<SceneInput> scenes = scenes_of(input.manifest, input.manifest.unit);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    if (progress.stop.stop_requested()) {
      return Error{ErrorCode::resumable,
                   fmt::format("stopped after drawing {} of {} scenes", s, scenes.size())};
    }
    Result<SceneDrawing> drawing = open_scene(scenes[s], input.meshes);
    if (!drawing && input.evaluation.scenes[s].missing) {
      figures.scenes.push_back(
          fmt::format("<p class=\"dim\">{}</p>\n", escape_html(drawing.error().message)));
      continue;
    }
    if (!drawing) return drawing.error();
    Result<std::string> scene = scene_figure(input, s, *drawing, store);
    if (!scene) return scene.error();
    figures.scenes.push_back(std::move(*scene));
    for (const auto& [exhibits, out, kind] :
         {std::tuple{&gallery.problems, &figures.problems, "problem"},
          {&gallery.right, &figures.right, "right"}}) {
      for (std::size_t i = 0; i < exhibits->size(); ++i) {
        if ((*exhibits)[i].scene != s) continue;
        Result<std::string> figure = exhibit_figure(input, (*exhibits)[i], *drawing, store,
                                                    fmt::format("{}_{:04}", kind, i));
        if (!figure) return figure.error();
        (*out)[i] = std::move(*figure);
      }
    }
    progress(s + 1, scenes.size(), input.manifest.scenes[s].name);
  }
  return figures;
}

std::string gallery_section(std::string_view title, const std::vector<std::string>& figures,
                            std::size_t num_all, std::string_view note) {
  if (figures.empty()) return "";
  std::string out = fmt::format("<h2>{}</h2>\n", title);
  if (figures.size() < num_all)
    out += fmt::format("<p class=\"dim\">{} of {}{}</p>\n", figures.size(), num_all, note);
  out += "<div class=\"gallery\">\n";
  for (const std::string& figure : figures) out += figure;
  return out + "</div>\n";
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, const ReportInput& input,
                          const Progress& progress) {
  TRIVET_TRY(make_folder(folder));
  const Gallery gallery = choose_exhibits(input);
  const std::size_t bytes = 2 * kPictureBytes * input.manifest.scenes.size() +
                            kExhibitBytes * (gallery.problems.size() + gallery.right.size());
  const bool within_page = bytes <= kMaxPageBytes;
  PictureStore store(folder, {.within_page = within_page, .as_files = !within_page});
  const Result<Figures> figures = draw_figures(input, gallery, store, progress);
  if (!figures) return figures.error();

  std::string content =
      fmt::format("<h1>Trivet: what was found</h1>\n<p class=\"dim\">{}, {}, {}</p>\n",
                  escape_html(std::filesystem::path(input.source).filename().string()),
                  counted(input.manifest.models.size(), "model", "models"),
                  counted(input.manifest.scenes.size(), "scene", "scenes"));
  content += headline(input) + cards(input.evaluation) + tables(input) + charts(input.evaluation);
  if (!figures->problems.empty() || !figures->right.empty()) {
    content +=
        "<h2>Close-ups</h2>\n<p class=\"dim\">What the sensor saw, and the truth and the answer in "
        "outlines.</p>\n" +
        picture_key();
  }
  content += gallery_section("Missed and wrong", figures->problems, gallery.num_problems, "");
  content +=
      gallery_section("Right", figures->right, gallery.num_right, ", those of the lowest scores");
  content +=
      "<h2>Scenes</h2>\n<p class=\"dim\">Filled with the model's color, paler where something "
      "is in front of it.</p>\n" +
      picture_key();
  for (const std::string& figure : figures->scenes) content += figure;
  const std::string page = html_page("Trivet: what was found", content);
  return publish_file(folder / "index.html", std::as_bytes(std::span(page)));
}

}  // namespace trivet::apps
