#include "apps/service/serve/routes/openapi.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "apps/service/serve/requests/recognize_query.hpp"
#include "engine/options/presets.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::service {

/// Defined by what cmake/embed.cmake writes.
std::span<const std::pair<std::string_view, std::string_view>> embedded_api();

namespace {

using Json = nlohmann::ordered_json;

Json value_json(const OptionValue& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

Json names_of(std::span<const Choice> choices) {
  Json names = Json::array();
  for (const Choice& choice : choices) names.push_back(choice.name);
  return names;
}

Json number_schema(const OptionInfo& info) {
  Json schema{{"type", info.kind == OptionKind::count ? "integer" : "number"}};
  const auto bound = [&](const char* name, double at) {
    if (!std::isfinite(at)) return;
    schema[name] = info.kind == OptionKind::count ? Json(static_cast<std::uint64_t>(at)) : Json(at);
  };
  bound(info.range.above_low ? "exclusiveMinimum" : "minimum", info.range.low);
  bound("maximum", info.range.high);
  return schema;
}

Json schema_of(const OptionInfo& info) {
  switch (info.kind) {
    case OptionKind::flag:
      return {{"type", "boolean"}};
    case OptionKind::number:
    case OptionKind::count:
      return number_schema(info);
    case OptionKind::choice:
      return {{"enum", names_of(info.choices)}};
    case OptionKind::numbers:
      return {{"type", "array"},
              {"items", {{"type", "number"}}},
              {"minItems", info.length},
              {"maxItems", std::max(info.length, info.max_length)}};
    case OptionKind::names:
      break;
  }
  Json items{{"type", "string"}};
  if (!info.choices.empty()) items = {{"enum", names_of(info.choices)}};
  return {{"type", "array"}, {"items", items}};
}

Json parameter_of(const OptionInfo& info, const OptionValue& usual) {
  std::string text(info.help);
  if (!info.unit.empty()) text += fmt::format(" [{}]", info.unit);
  text += '.';
  if (is_unset(usual) && !info.unset_help.empty())
    text += fmt::format(" Absent: {}.", info.unset_help);
  Json parameter{
      {"name", info.name}, {"in", "query"}, {"description", text}, {"schema", schema_of(info)}};
  if (info.kind == OptionKind::numbers || info.kind == OptionKind::names) {
    parameter["style"] = "form";
    parameter["explode"] = false;
  } else if (info.kind == OptionKind::count) {
    parameter["schema"]["default"] = static_cast<std::uint64_t>(std::get<double>(usual));
  } else if (!is_unset(usual)) {
    parameter["schema"]["default"] = value_json(usual);
  }
  // For who makes a form of them.
  parameter["x-group"] = info.group;
  parameter["x-label"] = info.label;
  if (!info.unit.empty()) parameter["x-unit"] = info.unit;
  return parameter;
}

/// By preset, what it sets otherwise than the usual one: {"fast": {"references": 0.05, ...}, ...}.
Json presets_json() {
  Json presets = Json::object();
  for (const auto& [name, values] : recognize_presets()) {
    Json& changed = presets[name] = Json::object();
    for (const auto& option : options_of<RecognizeOptions>()) {
      if (const OptionValue value = option.get(values); value != option.get({}))
        changed[option.info.name] = value_json(value);
    }
  }
  return presets;
}

/// Each path of the library, once more with its generation.
void add_versions(Json& paths) {
  constexpr std::string_view kModel = "/v2/models/{library}";
  std::vector<std::pair<std::string, Json>> versions;
  for (const auto& [path, operations] : paths.items()) {
    if (!path.starts_with(kModel)) continue;
    const std::string rest = path.substr(kModel.size());
    auto& version =
        versions.emplace_back(std::string(kModel) + "/versions/{version}" + rest, operations);
    for (Json& operation : version.second) {
      operation["operationId"] = operation["operationId"].get<std::string>() + "_of_version";
      operation["parameters"].push_back({{"$ref", "#/components/parameters/version"}});
    }
  }
  for (auto& [path, operations] : versions) paths[path] = std::move(operations);
}

/// The document with what follows from something else: the parameters of a recognition from its
/// options, and the paths with versions from those without.
std::string write_document() {
  Json document = parse_json<Json>(embedded_api().front().second);
  add_versions(document["paths"]);
  Json& parameters = document["components"]["parameters"];
  Json& of_recognize = document["paths"]["/v1/recognize"]["post"]["parameters"];
  const auto add = [&](const OptionInfo& info, const OptionValue& usual) {
    const std::string name(info.name);
    parameters[name] = parameter_of(info, usual);
    of_recognize.push_back({{"$ref", "#/components/parameters/" + name}});
  };
  for (const auto& option : options_of<ServedScene>()) add(option.info, option.get({}));
  add(preset_parameter(), std::string(kUsualPreset));
  parameters[preset_parameter().name]["x-presets"] = presets_json();
  for (const auto& option : options_of<RecognizeOptions>()) add(option.info, option.get({}));
  return json_text(document);
}

}  // namespace

std::string_view openapi_document() {
  static const std::string document = write_document();
  return document;
}

}  // namespace trivet::apps::service
