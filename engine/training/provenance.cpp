#include "engine/training/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "engine/training/standard_basis.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/files/nearest_name.hpp"
#include "storage/files/text.hpp"

namespace trivet::engine {
namespace {

using Json = nlohmann::ordered_json;

template <class Derived>
Json numbers(const Eigen::DenseBase<Derived>& values) {
  Json json = Json::array();
  for (const float value : values.reshaped()) json.push_back(value);
  return json;
}

Json declared_json(const std::optional<Symmetry>& declared) {
  if (!declared) return nullptr;
  Json json{{"poses", Json::array()}, {"axis", nullptr}};
  for (const Pose& pose : declared->poses) json["poses"].push_back(numbers(pose.matrix()));
  if (declared->axis)
    json["axis"] = {numbers(declared->axis->direction), numbers(declared->axis->point)};
  return json;
}

/// Extension of the file, which determines formats that the bytes do not identify.
std::string extension_of(const ModelSource& source) {
  return formats::lower_case(source.file.extension().string());
}

/// Value as text for the command line.
std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return json_text(value);
  std::string text;
  for (const Json& item : value) {
    if (!text.empty()) text += ',';
    text += text_of(item);
  }
  return text;
}

}  // namespace

std::string fingerprint_of(const ModelSource& source, const std::string& source_xxh3,
                           LengthUnit unit, const TrainOptions& options) {
  static const std::string kBasis = [] {
    const std::string bytes = basis_bytes(standard_basis({}));
    return xxh3_hex(std::as_bytes(std::span(bytes)));
  }();
  const Json all{{"revision", kTrainingRevision},
                 {"basis", kBasis},
                 {"source", source_xxh3},
                 {"extension", extension_of(source)},
                 {"unit", unit_name(unit)},
                 {"scale", source.scale},
                 {"symmetry", declared_json(source.symmetry)},
                 {"parameters", parameters_json(options)}};
  const std::string text = json_text(all);
  return xxh3_hex(std::as_bytes(std::span(text)));
}

LibraryHeader library_header(LengthUnit unit, const TrainOptions& options) {
  return {unit, "trivet " TRIVET_VERSION, parameters_json(options)};
}

std::string parameters_json(const TrainOptions& options) {
  Json json;
  for (const Option<TrainOptions>& option : options_of<TrainOptions>()) {
    std::visit([&](const auto& value) { json[std::string(option.info.name)] = value; },
               option.get(options));
  }
  return json_text(json);
}

Result<TrainOptions> parse_parameters(const std::string& json) {
  const auto bad = [&](const std::string& what) {
    return Error{ErrorCode::bad_data, fmt::format("parameters of training: {}", what)};
  };
  const Json all = parse_json<Json>(json);
  if (!all.is_object()) return bad("expected a JSON object");
  const std::vector<std::string_view> names = option_names<TrainOptions>();
  for (const auto& [name, value] : all.items()) {
    if (!find_option<TrainOptions>(name)) return bad(unknown_name(name, names));
  }
  TrainOptions options;
  for (const Option<TrainOptions>& option : options_of<TrainOptions>()) {
    const auto found = all.find(std::string(option.info.name));
    if (found == all.end()) return bad(fmt::format("expected '{}', found none", option.info.name));
    if (const Result<void> set = set_option(option, text_of(*found), options); !set)
      return bad(set.error().message);
  }
  return options;
}

}  // namespace trivet::engine
