#include "apps/words/train_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "apps/inputs/inputs.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 60;
constexpr std::array<std::string_view, 3> kOrigins{"trained", "resumed", "kept"};

std::string_view origin_name(ModelOrigin origin) {
  return kOrigins[static_cast<std::size_t>(origin)];
}

const char* kind_of(const ModelFacts& model) { return model.num_triangles > 0 ? "mesh" : "cloud"; }

double seconds_of(const ModelFacts& model) {
  double sum = 0;
  for (const auto& [stage, seconds] : model.times.seconds) sum += seconds;
  return sum;
}

std::string motions_text(bool axis, std::size_t number) {
  if (axis) return number > 0 ? fmt::format("axis + {}", number) : "axis";
  return number > 0 ? fmt::format("{}", number) : "none";
}

std::string row_of(const ModelFacts& model) {
  return fmt::format(
      "{:<32} {:>5} {:>9} {:>9} {:>12.5g} {:>12} {:>12} {:>8.2f} {:>11}\n", model.name,
      kind_of(model), model.num_vertices, model.num_triangles, model.diameter,
      motions_text(model.axis, model.num_symmetries) + (model.declared ? " (given)" : ""),
      motions_text(model.near_axis, model.num_near_symmetries), seconds_of(model), model.bytes);
}

std::size_t count(const TrainReport& report, ModelOrigin origin) {
  return static_cast<std::size_t>(std::ranges::count(report.models, origin, &ModelFacts::origin));
}

Json model_json(const ModelFacts& model) {
  Json stages = Json::object();
  for (const auto& [stage, seconds] : model.times.seconds) stages[stage] = seconds;
  return {{"name", model.name},
          {"origin", origin_name(model.origin)},
          {"kind", kind_of(model)},
          {"vertices", model.num_vertices},
          {"triangles", model.num_triangles},
          {"diameter", model.diameter},
          {"symmetry",
           {{"axis", model.axis}, {"poses", model.num_symmetries}, {"declared", model.declared}}},
          {"near_symmetry", {{"axis", model.near_axis}, {"poses", model.num_near_symmetries}}},
          {"point_pairs", model.num_ppf_entries},
          {"features", model.num_features},
          {"bytes", model.bytes},
          {"seconds", seconds_of(model)},
          {"stages", std::move(stages)},
          {"warnings", model.warnings}};
}

}  // namespace

std::string train_table(const TrainReport& report, LengthUnit unit) {
  std::string text;
  std::size_t num_rows = 0, num_left_out = 0;
  for (const ModelFacts& model : report.models) {
    if (model.origin == ModelOrigin::kept) continue;
    if (num_rows == kMostRows) {
      ++num_left_out;
      continue;
    }
    ++num_rows;
    text += row_of(model);
  }
  if (text.empty()) return text;
  const std::string head =
      fmt::format("{:<32} {:>5} {:>9} {:>9} {:>12} {:>12} {:>12} {:>8} {:>11}\n", "model", "kind",
                  "vertices", "triangles", fmt::format("diameter[{}]", unit_name(unit)), "symmetry",
                  "near", "seconds", "bytes");
  if (num_left_out > 0)
    text += fmt::format("... and {} (--json FILE has all)\n", counted(num_left_out, "more model"));
  return head + text;
}

std::string train_line(const TrainReport& report, const std::string& library) {
  std::uint64_t pairs = 0, features = 0;
  for (const ModelFacts& model : report.models) {
    pairs += model.num_ppf_entries;
    features += model.num_features;
  }
  std::string how;
  const auto add_count = [&](std::size_t number, std::string_view what) {
    if (number > 0) how += fmt::format("{}{} {}", how.empty() ? "" : ", ", number, what);
  };
  add_count(count(report, ModelOrigin::trained), "trained");
  add_count(count(report, ModelOrigin::resumed), "of an earlier run");
  add_count(count(report, ModelOrigin::kept), "as before");
  add_count(report.num_removed, "removed");
  return fmt::format("{}: {}{} ({}), {}, {}, {:.2f} s", library,
                     counted(report.models.size(), "model"), report.unchanged ? ", unchanged" : "",
                     how, counted(pairs, "point pair"), counted(features, "feature"),
                     report.seconds);
}

nlohmann::ordered_json train_json(const TrainReport& report, const TrainRequest& request) {
  Json models = Json::array(), faults = Json::array();
  for (const ModelFacts& model : report.models) models.push_back(model_json(model));
  for (const ModelFault& fault : report.faults)
    faults.push_back({{"name", fault.name}, {"reason", fault.error.message}});
  return {{"library", request.file.string()}, {"unit", unit_name(request.unit)},
          {"seconds", report.seconds},        {"unchanged", report.unchanged},
          {"removed", report.num_removed},    {"models", std::move(models)},
          {"faults", std::move(faults)},      {"left_out", request.left_out}};
}

}  // namespace trivet::apps
