#include "apps/study/page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <thread>

#include "apps/report/evaluation_pictures.hpp"
#include "apps/report/html.hpp"
#include "apps/study/charts.hpp"
#include "apps/study/headline.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "storage/files/file.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::study {
namespace {

std::string anchor(const Experiment& experiment) {
  std::string out;
  for (const char c : experiment.name) out += formats::is_alphanumeric(c) ? c : '_';
  return out;
}

/// The processor's name, if the system reports it.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name") && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  }
  return "unknown";
}

std::string summary(const Study& study, const StudyResults& results) {
  std::string out = "<ul class=\"findings\">\n";
  for (std::size_t e = 0; e < study.experiments.size(); ++e) {
    const Experiment& experiment = study.experiments[e];
    out += fmt::format("<li><a href=\"#{}\">{}</a>: {}\n", anchor(experiment),
                       escape_html(experiment.title), headline(results.experiments[e]));
  }
  return out + "</ul>\n";
}

// Tables.

/// A difference of fractions in percentage points, with its sign: "+1.2", "−0.3", "0.0".
std::string points_text(double difference) {
  const std::string digits = fmt::format("{:.1f}", std::abs(100 * difference));
  if (digits == "0.0") return digits;
  return (difference < 0 ? "\u2212" : "+") + digits;
}

std::string rate_cells(const PanelCell& cell) {
  if (cell.found.all == 0) return "<td class=\"n\"><td><td>";
  const auto [low, high] = cell.found.interval();
  return fmt::format(
      "<td class=\"n\">{} / {}<td class=\"n\">{:.1f} %<td class=\"n dim\">{:.1f} – {:.1f}",
      cell.found.right, cell.found.all, 100 * cell.found.value(), 100 * low, 100 * high);
}

std::string difference_cell(const std::optional<PairedComparison>& comparison) {
  if (!comparison) return "<td><td>";
  const std::string p = comparison->p < 0.001 ? "&lt; 0.001" : fmt::format("{:.2g}", comparison->p);
  const bool bold = beyond_chance(*comparison);
  return fmt::format(
      "<td class=\"n\">{}{}{} <span class=\"dim\">({} to {})</span><td class=\"n dim\">{}",
      bold ? "<b>" : "", points_text(comparison->difference), bold ? "</b>" : "",
      points_text(comparison->low), points_text(comparison->high), p);
}

/// The reference of the difference columns: another row, or another method.
enum class Compared : std::uint8_t { nothing, row, method };

Compared compared(const Panel& panel, std::size_t m) {
  if (m > 0) return Compared::method;
  for (const PanelCell& cell : panel.cells[m]) {
    if (cell.change) return Compared::row;
  }
  return Compared::nothing;
}

std::string difference_head(const Panel& panel, Compared what) {
  if (what == Compared::nothing) return "";
  const std::string other = what == Compared::method ? std::string(choice_name(panel.methods[0]))
                            : panel.reference == Reference::previous
                                ? std::string("the row above")
                                : escape_html(panel.rows[panel.reference_row]);
  return fmt::format("<th class=\"n\">against {}, points<th class=\"n\">p", other);
}

std::string method_table(const Experiment& experiment, const Panel& panel, std::size_t m) {
  const Compared what = compared(panel, m);
  const bool best_f1 = experiment.threshold == Threshold::best_f1;
  std::string rows;
  for (std::size_t row = 0; row < panel.rows.size(); ++row) {
    const PanelCell& cell = panel.cells[m][row];
    const bool usual = panel.reference == Reference::fixed && row == panel.reference_row;
    rows += fmt::format("<tr{}><td>{}{}", usual ? " class=\"usual\"" : "",
                        escape_html(panel.rows[row]), rate_cells(cell));
    rows += cell.false_positives ? fmt::format("<td class=\"n\">{}", *cell.false_positives)
                                 : std::string("<td>");
    if (best_f1) rows += fmt::format("<td class=\"n\">{:.3f}", cell.f1);
    if (what != Compared::nothing)
      rows += difference_cell(what == Compared::row ? cell.change : cell.lead);
    rows +=
        cell.seconds ? fmt::format("<td class=\"n\">{:.2f} s", *cell.seconds) : std::string("<td>");
    rows += '\n';
  }
  return fmt::format(
      "<div class=\"table study\"><table><tr><th>{} <span class=\"dim\">{}</span><th "
      "class=\"n\">found<th class=\"n\">share<th class=\"n\">95 %<th class=\"n\">false{}{}<th "
      "class=\"n\">time\n{}</table></div>\n",
      choice_name(panel.methods[m]), escape_html(panel.axis), best_f1 ? "<th class=\"n\">F1" : "",
      difference_head(panel, what), rows);
}

std::string panel_section(const Experiment& experiment, const Panel& panel) {
  std::string out = "<div class=\"panel\">\n";
  if (!panel.title.empty()) out += fmt::format("<h3>{}</h3>\n", escape_html(panel.title));
  const auto card = [&](std::string_view title, const std::string& chart) {
    if (chart.empty()) return std::string();
    return fmt::format("<div class=\"table\"><h4>{}</h4>{}{}</div>", title, chart,
                       chart_key(panel));
  };
  out += "<div class=\"charts\">" + card("What was found", rate_chart(panel)) +
         card("What it takes", time_chart(panel)) + "</div>\n";
  for (std::size_t m = 0; m < panel.methods.size(); ++m) out += method_table(experiment, panel, m);
  return out + "</div>\n";
}

std::string experiment_section(const Experiment& experiment, const ExperimentResults& results) {
  std::string out = fmt::format("<section id=\"{}\"><h2>{}</h2>\n", anchor(experiment),
                                escape_html(experiment.title));
  if (!experiment.about.empty())
    out += fmt::format("<p class=\"dim about\">{}</p>\n", escape_html(experiment.about));
  for (const Panel& panel : results.panels) out += panel_section(experiment, panel);
  return out + "</section>\n";
}

/// The resources of libraries of several sizes.
std::string library_section(const StudyResults& results) {
  if (results.libraries.size() < 2) return "";
  std::string rows;
  for (const LibraryRow& row : results.libraries) {
    constexpr double kMega = 1e6;
    rows += fmt::format(
        "<tr><td class=\"n\">{}<td class=\"n\">{:.0f} MB<td class=\"n\">{:.2f} s<td "
        "class=\"n\">{:.0f} MB\n",
        row.num_models, static_cast<double>(row.file_bytes) / kMega, row.use.open_seconds,
        static_cast<double>(row.use.peak_bytes) / kMega);
  }
  return fmt::format(
      "<section><h2>Libraries</h2>\n<p class=\"dim about\">Until the first scene can begin, and "
      "the most memory of the whole program since then, with a scene on each core.</p>\n<div "
      "class=\"table study\"><table><tr><th class=\"n\">models<th class=\"n\">file<th "
      "class=\"n\">to open<th class=\"n\">memory\n{}</table></div></section>\n",
      rows);
}

// Pictures.

Result<std::string> picture_section(const StudyResults& results, const StudyFolder& folder) {
  if (results.pictures.empty()) return std::string();
  std::string out =
      "<h2>Scenes</h2>\n<p class=\"dim\">One of each kind, that of the median share found. Filled "
      "with the model's color, paler where something is in front of it.</p>\n" +
      picture_key();
  PictureStore store(folder.path(), {.within_page = true, .as_files = false});
  for (const StudyPicture& picture : results.pictures) {
    Manifest manifest = results.sets[picture.set];
    manifest.scenes = {manifest.scenes[picture.scene]};
    manifest.scenes[0].name = picture.caption;
    const Result<std::vector<EvaluationMesh>> meshes = read_evaluation_meshes(manifest);
    if (!meshes) return meshes.error();
    Result<SceneDrawing> drawing = open_scene(scenes_of(manifest, manifest.unit).front(), *meshes);
    if (!drawing) return drawing.error();
    const std::vector<std::optional<SceneResult>> result{picture.result};
    const BopScores none;
    const Result<std::string> figure =
        scene_figure({manifest, *meshes, picture.evaluation, none, result, ""}, 0, *drawing, store);
    if (!figure) return figure.error();
    out += *figure;
  }
  return out;
}

// Methods and environment.

std::string method_notes() {
  return "<section><h2>How to read it</h2>\n<ul class=\"findings\">\n"
         "<li>An instance is found when a reported pose is off by less than a tenth of the "
         "diameter and 12°, but for the symmetries of the model (Drost et al., CVPR 2010). "
         "Instances of which less than 15 % is visible count neither way.\n"
         "<li>Ranges behind a share are Wilson's 95 % intervals. They take instances for "
         "independent, though those of a scene are not quite.\n"
         "<li>Differences are between the same instances in the same scenes. Their ranges are 95 % "
         "of 2,000 bootstraps over scenes; p is McNemar's exact test. <b>Bold</b>: beyond chance, "
         "that is p below 0.05 and a range without 0. Of twenty comparisons of equals, one looks "
         "so.\n"
         "<li>A false alarm is a reported pose at which the truth has no such model.\n"
         "<li>Times are medians of whole scenes on one core, while the other cores had scenes of "
         "their own. They are measurements: everything else is the same in each run.\n"
         "</ul></section>\n";
}

std::string origin(const Study& study, const StudyResults& results, const std::string& command) {
  std::string rows;
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, std::string>>{
           {"program", "trivet " TRIVET_VERSION},
           {"processor",
            fmt::format("{}, {}", processor(),
                        counted(std::thread::hardware_concurrency(), "thread", "threads"))},
           {"scenes", fmt::format("{} with {}", results.num_scenes,
                                  counted(results.num_instances, "instance", "instances"))},
           {"recognitions", fmt::format("{}", results.num_recognitions)}}) {
    rows += fmt::format("<tr><td>{}<td class=\"words\">{}\n", name, escape_html(value));
  }
  return fmt::format(
      "<section><h2>To repeat it</h2><div class=\"table\"><pre>{}</pre><table>{}</table>"
      "<details><summary>the configuration</summary><pre>{}</pre></details></div></section>\n",
      escape_html(command), rows, escape_html(study.text));
}

}  // namespace

Result<void> write_study_page(const Study& study, const StudyResults& results,
                              const StudyFolder& folder, const std::string& command) {
  const std::string title = study.title.empty() ? "Trivet: a study" : study.title;
  std::string content = fmt::format("<h1>{}</h1>\n", escape_html(title));
  if (!study.about.empty())
    content += fmt::format("<p class=\"headline\">{}</p>\n", escape_html(study.about));
  content += summary(study, results);
  for (std::size_t e = 0; e < study.experiments.size(); ++e)
    content += experiment_section(study.experiments[e], results.experiments[e]);
  content += library_section(results);
  const Result<std::string> pictures = picture_section(results, folder);
  if (!pictures) return pictures.error();
  content += *pictures + method_notes() + origin(study, results, command);
  const std::string page = html_page(title, content);
  return publish_file(folder.path() / "index.html", std::as_bytes(std::span(page)));
}

}  // namespace trivet::apps::study
