#include "apps/report/recognition_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/report/html.hpp"
#include "apps/report/pictures.hpp"
#include "apps/report/recognition_scene.hpp"
#include "apps/words/score_words.hpp"
#include "storage/files/file.hpp"

namespace trivet::apps {
namespace {

constexpr std::size_t kPicturesPerScene = 4;

std::string headline(const RecognitionReport& report) {
  std::size_t found = 0, ambiguous = 0;
  std::set<std::string> models;
  double seconds = 0;
  for (const SceneResult& result : report.results) {
    found += result.detections.size();
    seconds += result.stats.total_seconds;
    for (const Detection& detection : result.detections) {
      models.insert(detection.model);
      ambiguous += detection.is_ambiguous() ? 1 : 0;
    }
  }
  std::string out =
      fmt::format("<p class=\"headline\">{} found in {}, of {} of the {}.",
                  found == 0 ? "Nothing" : counted(found, "object", "objects"),
                  counted(report.scenes.size(), "scene", "scenes"), models.size(),
                  counted(report.recognizer.library().models.size(), "model", "models"));
  if (found == 0) {
    out = fmt::format("<p class=\"headline\">Nothing was found in {}.",
                      counted(report.scenes.size(), "scene", "scenes"));
  }
  if (ambiguous > 0) {
    out += fmt::format(" {} ambiguous: the scan cannot distinguish the pose from another one.",
                       counted(ambiguous, "is", "are"));
  }
  if (!report.results.empty()) {
    out += fmt::format(" A scene takes {:.2f} s (mean).",
                       seconds / static_cast<double>(report.results.size()));
  }
  return out + "</p>\n";
}

/// The table of contents, with a link to each scene.
std::string contents(const RecognitionReport& report) {
  if (report.scenes.size() < 2) return "";
  std::string rows;
  for (std::size_t s = 0; s < report.scenes.size(); ++s) {
    const SceneResult& result = report.results[s];
    std::string found;
    for (std::size_t d = 0; d < result.detections.size(); ++d)
      found += (d == 0 ? "" : ", ") + escape_html(result.detections[d].model);
    rows += fmt::format(
        "<tr><td><a href=\"#scene_{:04}\">{}</a><td class=\"n\">{}<td class=\"words\">{}<td "
        "class=\"n\">{:.2f} s\n",
        s, escape_html(report.scenes[s].file.filename().string()), result.detections.size(), found,
        result.stats.total_seconds);
  }
  return "<div class=\"table\"><table><tr><th>scene<th class=\"n\">found<th>models<th "
         "class=\"n\">time\n" +
         rows + "</table></div>\n";
}

std::string score_key(const kernels::ScoreModel& model) {
  const auto independent = most_evidence(model, 0), shared = most_evidence(model, 1);
  std::string rows;
  for (std::size_t k = 0; k < independent.size(); ++k) {
    if (!(independent[k] > 0 || shared[k] > 0)) continue;
    rows += fmt::format(
        "<tr><td>{}<td class=\"n\">{:.1f}<td class=\"n\">{:.1f}<td class=\"words\">{}\n",
        words_of(k).label, independent[k], shared[k], words_of(k).meaning);
  }
  return fmt::format(
      "<div><h2>How a score is made</h2><div class=\"table\"><p class=\"dim\">Each part gives "
      "evidence for a pose, in log odds, up to the most that it can give. {:.1f} and what all "
      "parts give is the logarithm of the odds that the object is there: 0 is 50 %, 3 is 95 %. "
      "That is where each pixel of a scan errs for itself; where neighbors err alike, it is "
      "{:.1f} "
      "and what the parts give then. Scans between are between.</p>"
      "<table><tr><th>part<th class=\"n\">at most<th class=\"n\">where neighbors err alike"
      "<th>what it looks at\n{}</table></div></div>\n",
      model.bias[0], model.bias[1], rows);
}

std::string calibration_words(const Recognizer& recognizer) {
  const nlohmann::ordered_json name = calibration_json(recognizer);
  return name.is_null() ? "none" : name.get<std::string>();
}

/// Instructions to reproduce the result.
std::string origin(const RecognitionReport& report) {
  const Library& library = report.recognizer.library();
  std::string rows;
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, std::string>>{
           {"program", "trivet " TRIVET_VERSION},
           {"library", library.file.filename().string()},
           {"library format", fmt::format("{}.{}", kLibraryVersionMajor, library.version_minor)},
           {"trained by", library.header.producer},
           {"training", library.header.parameters},
           {"calibration of the score", calibration_words(report.recognizer)},
           {"unit of the library", unit_name(library.header.unit)}}) {
    rows += fmt::format("<tr><td>{}<td class=\"words\">{}\n", name, escape_html(value));
  }
  for (const Option<RecognizeOptions>& option : options_of<RecognizeOptions>()) {
    rows += fmt::format("<tr><td>{}<td class=\"words\">{}\n", label_with_unit(option.info),
                        escape_html(option_text(option.info, option.get(report.options))));
  }
  return fmt::format(
      "<div><h2>To repeat it</h2><div class=\"table\"><pre>{}</pre><table>{}</table></div></div>\n",
      escape_html(report.command), rows);
}

}  // namespace

Result<void> write_recognition_report(const std::filesystem::path& folder,
                                      const RecognitionReport& report, const Progress& progress) {
  TRIVET_TRY(make_folder(folder));
  const Result<std::vector<EvaluationMesh>> meshes = meshes_of(report.recognizer.library());
  if (!meshes) return meshes.error();
  const std::vector<EvaluationMesh>& models = *meshes;
  const std::size_t bytes = kPicturesPerScene * kPictureBytes * report.scenes.size();
  PictureStore store(folder, {.within_page = bytes <= kMaxPageBytes, .as_files = true});

  std::string content = fmt::format(
      "<h1>Trivet: what was recognized</h1>\n<p class=\"dim\">{}, {}, {}</p>\n",
      escape_html(report.recognizer.library().file.filename().string()),
      counted(models.size(), "model", "models"), counted(report.scenes.size(), "scene", "scenes"));
  content += headline(report) + contents(report);
  for (std::size_t s = 0; s < report.scenes.size(); ++s) {
    if (progress.stop.stop_requested()) {
      return Error{ErrorCode::resumable,
                   fmt::format("stopped after drawing {} of {} scenes", s, report.scenes.size())};
    }
    const Result<std::string> figure = recognition_figure(report, s, models, store);
    if (!figure) return figure.error();
    content += *figure;
    progress(s + 1, report.scenes.size(), report.scenes[s].file.filename().string());
  }
  content += "<div class=\"tables\">\n" + score_key(report.recognizer.score()) + origin(report) +
             "</div>\n";
  const std::string page = html_page("Trivet: what was recognized", content);
  return publish_file(folder / "index.html", std::as_bytes(std::span(page)));
}

}  // namespace trivet::apps
