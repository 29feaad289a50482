#include "apps/results/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "kernels/common/quantile.hpp"
#include "storage/common/counted.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kResampling = 1;  // any value: the same comparison gives the same bytes

ComparedScene parse_evaluated(const JsonNode& node) {
  ComparedScene scene{node.at("scene").string(), {}, {}, {0, 0, 0}, {}, {}};
  if (node.has("seconds")) scene.seconds = node.at("seconds").number();
  constexpr int kMany = 1 << 30;
  for (const JsonNode& entry : node.at("detections").elements()) {
    if (!entry.at("reported").boolean() || entry.at("verdict").string() == "neutral") continue;
    Detection detection;
    detection.model = entry.at("model").string();
    detection.score = static_cast<float>(entry.at("score").number());
    scene.detections.push_back(std::move(detection));
    const bool is_right = entry.at("verdict").string() == "right";
    scene.truths.push_back(
        is_right ? std::optional<std::size_t>(entry.at("truth").integer(0, kMany)) : std::nullopt);
  }
  for (const JsonNode& entry : node.at("missed").elements())
    scene.missed.push_back(static_cast<std::size_t>(entry.at("truth").integer(0, kMany)));
  return scene;
}

ComparedScene compared_scene(StoredScene&& stored) {
  SceneResult& result = stored.result;
  ComparedScene scene{stored.file.string(), {}, std::move(result.detections),
                      result.offset,        {}, {}};
  if (result.stats.total_seconds > 0) scene.seconds = result.stats.total_seconds;
  return scene;
}

/// The files of a folder by name, or the single file named.
std::vector<std::filesystem::path> documents_of(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_directory(file, error)) return {file};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(file, error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// Whether a document is one of `trivet evaluate`.
Result<bool> is_evaluation(const std::filesystem::path& file) {
  bool has_truth = false;
  const Result<void> read = with_json(file, [&](const JsonNode& root) {
    if (!root.object().has("scenes"))
      root.refuse("expected a result of `trivet recognize --json` or `trivet evaluate --json`");
    has_truth = root.has("by_model") && root.has("threshold");
  });
  if (!read) return read.error();
  return has_truth;
}

Result<void> add_evaluated(const std::filesystem::path& file, ComparedResult& out) {
  return with_json(file, [&](const JsonNode& root) {
    for (const JsonNode& scene : root.at("scenes").elements())
      out.scenes.push_back(parse_evaluated(scene));
  });
}

Result<void> add_recognized(const std::filesystem::path& file, ComparedResult& out) {
  Result<std::vector<StoredScene>> stored = read_stored_scenes(file);
  if (!stored) return stored.error();
  for (StoredScene& scene : *stored) out.scenes.push_back(compared_scene(std::move(scene)));
  return {};
}

/// Puts the scenes of b into the order of a. Errors: bad_data.
Result<void> arrange(const ComparedResult& a, ComparedResult& b) {
  std::set<std::string> names;
  for (const ComparedScene& scene : a.scenes) names.insert(scene.name);
  const auto stranger = std::ranges::find_if(
      b.scenes, [&](const ComparedScene& scene) { return !names.contains(scene.name); });
  if (names.size() == a.scenes.size() && stranger == b.scenes.end() &&
      b.scenes.size() == a.scenes.size()) {
    std::vector<ComparedScene> arranged;
    for (const ComparedScene& scene : a.scenes) {
      const auto same = std::ranges::find(b.scenes, scene.name, &ComparedScene::name);
      if (same == b.scenes.end()) break;  // b contains one twice
      arranged.push_back(std::move(*same));
      same->name.clear();
    }
    if (arranged.size() == a.scenes.size()) {
      b.scenes = std::move(arranged);
      return {};
    }
  }
  const std::string found =
      stranger == b.scenes.end()
          ? counted(b.scenes.size(), "scene")
          : fmt::format("{}, '{}' among them", counted(b.scenes.size(), "scene"), stranger->name);
  return Error{ErrorCode::bad_data,
               fmt::format("{}: expected the {} of {}, each once, found {}; "
                           "compare results over the same scenes",
                           b.file, counted(a.scenes.size(), "scene"), a.file, found)};
}

std::optional<std::size_t> finder_of(const ComparedScene& scene, std::size_t truth) {
  const auto found = std::ranges::find(scene.truths, std::optional(truth));
  if (found == scene.truths.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scene.truths.begin());
}

SceneComparison compare_by_truth(const ComparedScene& a, const ComparedScene& b) {
  SceneComparison out;
  for (std::size_t i = 0; i < a.truths.size(); ++i) {
    if (!a.truths[i]) {
      out.false_a.push_back(i);
    } else if (const auto j = finder_of(b, *a.truths[i])) {
      out.both.push_back({i, *j});
    } else {
      out.only_a.push_back(i);
    }
  }
  for (std::size_t j = 0; j < b.truths.size(); ++j) {
    if (!b.truths[j]) {
      out.false_b.push_back(j);
    } else if (!finder_of(a, *b.truths[j])) {
      out.only_b.push_back(j);
    }
  }
  for (const std::size_t truth : a.missed) out.neither += std::ranges::count(b.missed, truth);
  return out;
}

SceneComparison compare_by_poses(const ComparedScene& a, ComparedScene& b,
                                 const PoseMatcher& matcher) {
  for (Detection& detection : b.detections) {
    detection.T_scene_model =
        in_cloud_frame(in_file_frame(detection.T_scene_model, b.offset), a.offset);
  }
  b.offset = a.offset;
  SceneComparison out;
  out.both = matcher.match(a.detections, b.detections);
  for (std::size_t i = 0; i < a.detections.size(); ++i) {
    if (std::ranges::count(out.both, i, &DetectionMatch::first) == 0) out.only_a.push_back(i);
  }
  for (std::size_t j = 0; j < b.detections.size(); ++j) {
    if (std::ranges::count(out.both, j, &DetectionMatch::second) == 0) out.only_b.push_back(j);
  }
  return out;
}

// Output.

struct Sums {
  std::size_t both = 0, only_a = 0, only_b = 0, false_a = 0, false_b = 0;
  std::optional<double> seconds_a = 0, seconds_b = 0;  ///< none if a scene has no time
};

Sums sums_of(const Comparison& comparison) {
  Sums sums;
  const auto add = [](std::optional<double>& sum, const std::optional<double>& value) {
    sum = sum && value ? std::optional(*sum + *value) : std::nullopt;
  };
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const SceneComparison& scene = comparison.scenes[s];
    sums.both += scene.both.size();
    sums.only_a += scene.only_a.size();
    sums.only_b += scene.only_b.size();
    sums.false_a += scene.false_a.size();
    sums.false_b += scene.false_b.size();
    add(sums.seconds_a, comparison.a.scenes[s].seconds);
    add(sums.seconds_b, comparison.b.scenes[s].seconds);
  }
  return sums;
}

Json seconds_json(const std::optional<double>& seconds) {
  return seconds ? Json(*seconds) : Json();
}

Json found_json(const ComparedScene& scene, const std::vector<std::size_t>& which, bool has_truth) {
  Json list = Json::array();
  for (const std::size_t i : which) {
    const Detection& detection = scene.detections[i];
    Json entry{{"model", detection.model}, {"score", detection.score}};
    if (!has_truth) {
      entry["T_scene_model"] = matrix_json(in_file_frame(detection.T_scene_model, scene.offset));
    } else if (scene.truths[i]) {
      entry["truth"] = *scene.truths[i];
    }
    list.push_back(std::move(entry));
  }
  return list;
}

std::string seconds_text(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.3f}", *seconds) : "-";
}

std::string row_text(const std::string& name, const SceneComparison* scene, const Sums& sums,
                     bool has_truth) {
  std::string text = fmt::format(
      "{:<36} {:>6} {:>7} {:>7}", name, scene ? scene->both.size() : sums.both,
      scene ? scene->only_a.size() : sums.only_a, scene ? scene->only_b.size() : sums.only_b);
  if (has_truth) {
    text += fmt::format(" {:>8} {:>8}", scene ? scene->false_a.size() : sums.false_a,
                        scene ? scene->false_b.size() : sums.false_b);
  }
  return text +
         fmt::format(" {:>9} {:>9}\n", seconds_text(sums.seconds_a), seconds_text(sums.seconds_b));
}

std::string found_text(const char* of, const Comparison& comparison, bool is_a) {
  std::string text;
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const ComparedScene& scene = (is_a ? comparison.a : comparison.b).scenes[s];
    for (const std::size_t i : is_a ? comparison.scenes[s].only_a : comparison.scenes[s].only_b) {
      const Detection& detection = scene.detections[i];
      text += fmt::format("  {}: {}, score {:.3f}", scene.name, detection.model, detection.score);
      if (comparison.a.has_truth) {
        text += fmt::format(", truth {}", *scene.truths[i]);
      } else {
        const Eigen::Vector3d at =
            in_file_frame(detection.T_scene_model, scene.offset).translation();
        text += fmt::format(", at {:.6g}, {:.6g}, {:.6g}", at.x(), at.y(), at.z());
      }
      text += "\n";
    }
  }
  return text.empty() ? text : fmt::format("only in {}:\n{}", of, text);
}

/// The scores of objects that both found.
std::string scores_text(const Comparison& comparison) {
  std::vector<double> of_a, of_b;
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    for (const auto& [i, j] : comparison.scenes[s].both) {
      of_a.push_back(comparison.a.scenes[s].detections[i].score);
      of_b.push_back(comparison.b.scenes[s].detections[j].score);
    }
  }
  if (of_a.empty()) return {};
  return fmt::format("median score of what both found: A {:.3f}, B {:.3f}\n",
                     *kernels::quantile(std::move(of_a), 0.5),
                     *kernels::quantile(std::move(of_b), 0.5));
}

std::string paired_text(const PairedComparison& paired) {
  const auto n = static_cast<double>(std::max<std::size_t>(paired.total.num_trials(), 1));
  const auto rate = [n](std::size_t found) { return 100 * static_cast<double>(found) / n; };
  return fmt::format(
      "A finds {:.1f} % and B {:.1f} % of {}: A - B {:+.1f} points, {:+.1f} to {:+.1f} with 95 % "
      "confidence, p {:.2g}\n",
      rate(paired.total.both + paired.total.only_first),
      rate(paired.total.both + paired.total.only_second),
      counted(paired.total.num_trials(), "instance"), 100 * paired.difference, 100 * paired.low,
      100 * paired.high, paired.p);
}

}  // namespace

Result<ComparedResult> read_compared(const std::string& file) {
  ComparedResult out{file, false, {}};
  const std::vector<std::filesystem::path> documents = documents_of(file);
  if (documents.empty()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected results (.json) in the folder, found none", file)};
  }
  for (const std::filesystem::path& document : documents) {
    const Result<bool> has_truth = is_evaluation(document);
    if (!has_truth) return has_truth.error();
    if (document == documents.front()) out.has_truth = *has_truth;
    if (*has_truth != out.has_truth) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}: expected a result of `trivet {}` as {}, found one of the other",
                               document.string(), out.has_truth ? "evaluate" : "recognize",
                               documents.front().string())};
    }
    const Result<void> added =
        *has_truth ? add_evaluated(document, out) : add_recognized(document, out);
    if (!added) return added.error();
  }
  return out;
}

Result<Comparison> compare_results(ComparedResult a, ComparedResult b, const PoseMatcher* matcher,
                                   std::string measure) {
  if (a.has_truth != b.has_truth) {
    const ComparedResult &with = a.has_truth ? a : b, &without = a.has_truth ? b : a;
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected a result of `trivet evaluate` as {}, found one of "
                    "`trivet recognize`; `trivet evaluate MANIFEST --detections` makes one "
                    "of it",
                    without.file, with.file)};
  }
  if (!a.has_truth && !matcher) {
    return Error{ErrorCode::usage,
                 "expected --library LIBRARY.h5 to tell when two poses are the same, or "
                 "--max-translation LENGTH; found neither"};
  }
  TRIVET_TRY(arrange(a, b));
  Comparison out{std::move(a), std::move(b), {}, {}, std::move(measure)};
  std::vector<PairedTrials> trials;
  for (std::size_t s = 0; s < out.a.scenes.size(); ++s) {
    const ComparedScene& first = out.a.scenes[s];
    ComparedScene& second = out.b.scenes[s];
    out.scenes.push_back(out.a.has_truth ? compare_by_truth(first, second)
                                         : compare_by_poses(first, second, *matcher));
    const SceneComparison& scene = out.scenes.back();
    trials.push_back({scene.both.size(), scene.only_a.size(), scene.only_b.size(), scene.neither});
  }
  if (out.a.has_truth) out.paired = compare_paired(trials, kResampling);
  return out;
}

nlohmann::ordered_json comparison_json(const Comparison& comparison) {
  const bool has_truth = comparison.a.has_truth;
  Json scenes = Json::array();
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const SceneComparison& scene = comparison.scenes[s];
    const ComparedScene &a = comparison.a.scenes[s], &b = comparison.b.scenes[s];
    Json both = Json::array();
    for (const auto& [i, j] : scene.both) {
      Json entry = found_json(a, {i}, has_truth)[0];
      entry["score_b"] = b.detections[j].score;
      both.push_back(std::move(entry));
    }
    scenes.push_back({{"scene", a.name},
                      {"both", std::move(both)},
                      {"only_a", found_json(a, scene.only_a, has_truth)},
                      {"only_b", found_json(b, scene.only_b, has_truth)},
                      {"seconds_a", seconds_json(a.seconds)},
                      {"seconds_b", seconds_json(b.seconds)}});
    if (!has_truth) continue;
    scenes.back()["false_a"] = found_json(a, scene.false_a, has_truth);
    scenes.back()["false_b"] = found_json(b, scene.false_b, has_truth);
    scenes.back()["neither"] = scene.neither;
  }
  const Sums sums = sums_of(comparison);
  Json total{{"both", sums.both},
             {"only_a", sums.only_a},
             {"only_b", sums.only_b},
             {"seconds_a", seconds_json(sums.seconds_a)},
             {"seconds_b", seconds_json(sums.seconds_b)}};
  Json paired;
  if (const auto& test = comparison.paired) {
    total["false_a"] = sums.false_a;
    total["false_b"] = sums.false_b;
    total["neither"] = test->total.neither;
    paired = {{"difference", test->difference},
              {"difference_95_low", test->low},
              {"difference_95_high", test->high},
              {"p", test->p}};
  }
  return {{"a", comparison.a.file},      {"b", comparison.b.file},
          {"same", comparison.measure},  {"total", std::move(total)},
          {"paired", std::move(paired)}, {"scenes", std::move(scenes)}};
}

std::string comparison_text(const Comparison& comparison) {
  const bool has_truth = comparison.a.has_truth;
  std::string text = fmt::format("A  {}\nB  {}\nthe same: {}\n\n", comparison.a.file,
                                 comparison.b.file, comparison.measure);
  text += fmt::format("{:<36} {:>6} {:>7} {:>7}", "", "both", "only A", "only B");
  if (has_truth) text += fmt::format(" {:>8} {:>8}", "false A", "false B");
  text += fmt::format(" {:>9} {:>9}\n", "A [s]", "B [s]");
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    Sums times;
    times.seconds_a = comparison.a.scenes[s].seconds;
    times.seconds_b = comparison.b.scenes[s].seconds;
    text += row_text(comparison.a.scenes[s].name, &comparison.scenes[s], times, has_truth);
  }
  text +=
      row_text(counted(comparison.scenes.size(), "scene"), nullptr, sums_of(comparison), has_truth);
  text += fmt::format("\n{}{}{}", found_text("A", comparison, true),
                      found_text("B", comparison, false), scores_text(comparison));
  if (comparison.paired) text += paired_text(*comparison.paired);
  return text;
}

}  // namespace trivet::apps
