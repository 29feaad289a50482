#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <set>
#include <string_view>

#include "apps/study/study.hpp"
#include "engine/simulation/make_parts.hpp"
#include "storage/files/file.hpp"
#include "storage/files/nearest_name.hpp"

namespace trivet::apps::study {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxBytes = 1 << 20;
constexpr double kMaxSeed = 1e15;

/// Reads a configuration and collects its faults.
class Reader {
 public:
  explicit Reader(fs::path file) : file_(std::move(file)) {}

  const std::vector<std::string>& faults() const { return faults_; }

  void fault(const toml::source_region& where, std::string_view text) {
    faults_.push_back(fmt::format("{}:{}: {}", file_.filename().string(), where.begin.line, text));
  }
  void fault(const toml::node& where, std::string_view text) { fault(where.source(), text); }

  /// Reports unknown keys as faults.
  void allow(const toml::table& table, std::initializer_list<std::string_view> keys) {
    for (const auto& [key, node] : table) {
      if (std::ranges::find(keys, key.str()) == keys.end()) {
        fault(key.source(), unknown_name(key.str(), keys));
      }
    }
  }

  void read(const toml::table& table, std::string_view key, std::string& out) {
    const toml::node* const node = table.get(key);
    if (!node) return;
    if (const auto text = node->value_exact<std::string>()) {
      out = *text;
    } else {
      fault(*node, fmt::format("{}: expected a text", key));
    }
  }
  void read(const toml::table& table, std::string_view key, bool& out) {
    const toml::node* const node = table.get(key);
    if (!node) return;
    if (const auto flag = node->value_exact<bool>()) {
      out = *flag;
    } else {
      fault(*node, fmt::format("{}: expected true or false", key));
    }
  }
  template <class Number>
  void read(const toml::table& table, std::string_view key, double low, double high, Number& out) {
    const toml::node* const node = table.get(key);
    if (!node) return;
    const auto number = node->value<double>();
    const bool is_integer = std::is_integral_v<Number>;
    if (node->is_number() && number && *number >= low && *number <= high &&
        (!is_integer || node->is_integer())) {
      out = static_cast<Number>(*number);
    } else {
      fault(*node, fmt::format("{}: expected a {}number from {:g} to {:g}", key,
                               is_integer ? "whole " : "", low, high));
    }
  }
  std::vector<std::string> texts(const toml::table& table, std::string_view key) {
    const toml::node* const node = table.get(key);
    if (!node) return {};
    std::vector<std::string> out;
    const toml::array* const array = node->as_array();
    for (std::size_t i = 0; array && i < array->size(); ++i) {
      if (const auto text = (*array)[i].value_exact<std::string>()) out.push_back(*text);
    }
    if (!array || out.size() != array->size())
      fault(*node, fmt::format("{}: expected a list of texts", key));
    return out;
  }
  /// The indices of names in a list. Unknown names are faults.
  template <class Named>
  std::vector<std::size_t> places(const toml::table& table, std::string_view key,
                                  const std::vector<Named>& named) {
    std::vector<std::size_t> out;
    for (const std::string& name : texts(table, key)) {
      const auto found = std::ranges::find(named, name, &Named::name);
      if (found == named.end()) {
        fault(*table.get(key), fmt::format("{}: found '{}', which is not declared", key, name));
      } else {
        out.push_back(static_cast<std::size_t>(found - named.begin()));
      }
    }
    return out;
  }
  /// One of the names of an enumeration.
  template <class Enum>
  void choose(const toml::table& table, std::string_view key,
              const std::vector<std::pair<std::string_view, Enum>>& names, Enum& out) {
    std::string name;
    read(table, key, name);
    if (name.empty()) return;
    for (const auto& [known, value] : names) {
      if (known == name) {
        out = value;
        return;
      }
    }
    fault(*table.get(key), fmt::format("{}: found '{}'", key, name));
  }

  /// The sub-tables of a table, in the order of the file.
  std::vector<std::pair<std::string, const toml::table*>> tables(const toml::table& root,
                                                                 std::string_view key) {
    std::vector<std::pair<std::string, const toml::table*>> out;
    const toml::node* const node = root.get(key);
    if (!node) return out;
    if (!node->is_table()) {
      fault(*node, fmt::format("{}: expected tables [{}.NAME]", key, key));
      return out;
    }
    for (const auto& [name, child] : *node->as_table()) {
      if (child.is_table()) {
        out.emplace_back(name.str(), child.as_table());
      } else {
        fault(child, fmt::format("expected a table [{}.{}]", key, name.str()));
      }
    }
    std::ranges::stable_sort(out, {},
                             [](const auto& entry) { return entry.second->source().begin.line; });
    return out;
  }

  std::optional<OptionValue> value_of(const toml::node& node) {
    if (const auto flag = node.value_exact<bool>()) return OptionValue(*flag);
    if (node.is_number()) return OptionValue(*node.value<double>());
    if (const auto text = node.value_exact<std::string>()) return OptionValue(*text);
    if (const toml::array* const array = node.as_array()) {
      std::vector<std::string> list;
      for (const toml::node& element : *array) {
        if (const auto text = element.value_exact<std::string>()) list.push_back(*text);
      }
      if (list.size() == array->size()) return OptionValue(std::move(list));
    }
    fault(node, "expected a number, a text, true, false or a list of texts");
    return std::nullopt;
  }

  /// Adds one setting, which must exist and accept the value.
  void change(const toml::node& node, const std::string& name, const OptionValue& value,
              std::vector<SettingChange>& out) {
    const Setting* const setting = find_setting(name);
    if (!setting) {
      std::vector<std::string_view> alike;
      const std::string stage = name.substr(0, name.find('.') + 1);
      for (const Setting& known : all_settings()) {
        if (known.name.starts_with(stage)) alike.push_back(known.name);
      }
      fault(node, alike.empty()
                      ? fmt::format("found setting '{}'; expected one of scan., degrade., "
                                    "train. or recognize.",
                                    name)
                      : unknown_name(name, alike));
      return;
    }
    StudySettings scratch;
    if (const Result<void> done = setting->set(scratch, value); !done) {
      fault(node, fmt::format("{}: {}", name, done.error().message));
      return;
    }
    out.push_back({name, value});
  }

  /// Adds settings of nested tables: { degrade = { noise = 0.1 } }, usually written { degrade.noise
  /// = 0.1 }.
  void changes(const toml::table& table, const std::string& prefix,
               std::vector<SettingChange>& out) {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (const toml::table* const inner = node.as_table()) {
        changes(*inner, name + ".", out);
      } else if (const std::optional<OptionValue> value = value_of(node)) {
        change(node, name, *value, out);
      }
    }
  }
  void changes_at(const toml::table& table, std::string_view key, std::vector<SettingChange>& out) {
    const toml::node* const node = table.get(key);
    if (!node) return;
    if (const toml::table* const inner = node->as_table()) {
      changes(*inner, "", out);
    } else {
      fault(*node, fmt::format("{}: expected a table of settings", key));
    }
  }

  fs::path resolve(const std::string& path) const {
    return (fs::absolute(file_).parent_path() / path).lexically_normal();
  }

 private:
  fs::path file_;
  std::vector<std::string> faults_;
};

ModelGroup read_models(Reader& reader, const std::string& name, const toml::table& table) {
  reader.allow(table, {"folder", "files", "diameter", "metal", "parts", "families"});
  ModelGroup group;
  group.name = name;
  std::string folder;
  reader.read(table, "folder", folder);
  for (const std::string& file : reader.texts(table, "files")) {
    // NAME=FILE keeps its name.
    const std::size_t equals = file.find('=');
    const std::string own = equals == std::string::npos ? "" : file.substr(0, equals + 1);
    group.files.push_back(
        own + reader.resolve((fs::path(folder) / file.substr(own.size())).string()).string());
  }
  if (group.files.empty() && !folder.empty())
    group.files.push_back(reader.resolve(folder).string());
  reader.read(table, "diameter", 0, 1000, group.options.diameter);
  reader.read(table, "metal", group.options.metal);
  reader.read(table, "parts", 0, kMaxParts, group.num_parts);
  group.families = reader.texts(table, "families");
  const std::vector<std::string> known = known_families();
  for (const std::string& family : group.families) {
    if (std::ranges::find(known, family) == known.end()) {
      reader.fault(table, fmt::format("families: expected some of {}, found '{}'",
                                      fmt::join(known, ", "), family));
    }
  }
  if (group.files.empty() && group.num_parts == 0)
    reader.fault(table, fmt::format("models.{}: expected files, a folder or parts", name));
  return group;
}

SceneGroup read_scenes(Reader& reader, const std::string& name, const toml::table& table,
                       const Study& study) {
  reader.allow(table, {"title", "models", "others", "manifest", "set"});
  SceneGroup group;
  group.name = group.title = name;
  reader.read(table, "title", group.title);
  group.models = reader.places(table, "models", study.models);
  group.others = reader.places(table, "others", study.models);
  std::string manifest;
  reader.read(table, "manifest", manifest);
  if (!manifest.empty()) group.manifest = reader.resolve(manifest);
  reader.changes_at(table, "set", group.changes);
  if (group.models.empty() == manifest.empty())
    reader.fault(table, fmt::format("scenes.{}: expected either models or a manifest", name));
  if (!manifest.empty() && !group.others.empty())
    reader.fault(table, fmt::format("scenes.{}: expected no others beside a manifest", name));
  return group;
}

Variant read_variant(Reader& reader, const toml::table& table) {
  reader.allow(table, {"name", "set"});
  Variant variant;
  reader.read(table, "name", variant.name);
  reader.changes_at(table, "set", variant.changes);
  if (variant.name.empty()) reader.fault(table, "expected the name of the variant");
  return variant;
}

/// The values of one setting.
void read_values(Reader& reader, const toml::table& table, Experiment& experiment) {
  reader.read(table, "vary", experiment.vary);
  const toml::node* const values = table.get("values");
  if (experiment.vary.empty()) {
    if (values) reader.fault(*values, "values: expected `vary` beside it, with the setting's name");
    return;
  }
  if (!values || !values->is_array() || values->as_array()->empty()) {
    reader.fault(table, "vary: expected a list `values` beside it");
    return;
  }
  for (const toml::node& node : *values->as_array()) {
    const std::optional<OptionValue> value = reader.value_of(node);
    if (!value) continue;
    Variant variant;
    variant.name = value_text(*value);
    if (const double* const number = std::get_if<double>(&*value)) variant.number = *number;
    const std::size_t before = reader.faults().size();
    reader.change(node, experiment.vary, *value, variant.changes);
    if (reader.faults().size() == before) experiment.variants.push_back(std::move(variant));
  }
}

Experiment read_experiment(Reader& reader, const toml::table& table, const Study& study) {
  reader.allow(table, {"name", "title", "about", "scenes", "methods", "vary", "values", "variants",
                       "set", "repetitions", "threshold", "curve", "against"});
  Experiment experiment;
  reader.read(table, "name", experiment.name);
  if (experiment.name.empty()) reader.fault(table, "expected the experiment's name");
  experiment.title = experiment.name;
  reader.read(table, "title", experiment.title);
  reader.read(table, "about", experiment.about);
  experiment.scenes = reader.places(table, "scenes", study.scenes);
  if (experiment.scenes.empty())
    reader.fault(table, fmt::format("experiment {}: expected scenes", experiment.name));
  for (const std::string& name : reader.texts(table, "methods")) {
    const std::span<const Choice> known = choices_of<Method>();
    if (const auto found = std::ranges::find(known, name, &Choice::name); found != known.end()) {
      experiment.methods.push_back(static_cast<Method>(found - known.begin()));
    } else {
      reader.fault(*table.get("methods"),
                   fmt::format("methods: expected fused, ppf or trisi, found '{}'", name));
    }
  }
  if (experiment.methods.empty()) experiment.methods.push_back(Method::fused);
  reader.changes_at(table, "set", experiment.changes);
  reader.read(table, "repetitions", 1, 1000, experiment.repetitions);
  reader.choose<Threshold>(table, "threshold",
                           {{"setting", Threshold::setting}, {"best-f1", Threshold::best_f1}},
                           experiment.threshold);
  reader.choose<Curve>(
      table, "curve",
      {{"variants", Curve::variants}, {"occlusion", Curve::occlusion}, {"clutter", Curve::clutter}},
      experiment.curve);

  reader.choose<Against>(table, "against",
                         {{"default", Against::usual}, {"previous", Against::previous}},
                         experiment.against);

  read_values(reader, table, experiment);
  if (const toml::node* const variants = table.get("variants")) {
    const toml::array* const array = variants->as_array();
    if (!array || !experiment.vary.empty() || !array->is_homogeneous<toml::table>()) {
      reader.fault(*variants, "variants: expected tables, and no `vary` beside them");
    } else {
      for (const toml::node& node : *array)
        experiment.variants.push_back(read_variant(reader, *node.as_table()));
    }
  }
  if (experiment.variants.empty()) experiment.variants.push_back({"default", {}, {}});
  return experiment;
}

/// Scenes of a manifest already exist: the settings that generate scenes must not vary.
void check_listed(Reader& reader, const toml::table& where, const SceneGroup& scenes,
                  const Experiment& experiment) {
  if (scenes.manifest.empty()) return;
  std::vector<SettingChange> all = scenes.changes;
  all.insert(all.end(), experiment.changes.begin(), experiment.changes.end());
  for (const Variant& variant : experiment.variants)
    all.insert(all.end(), variant.changes.begin(), variant.changes.end());
  for (const SettingChange& change : all) {
    if (!change.name.starts_with("scan.")) continue;
    reader.fault(where, fmt::format("experiment {}: expected nothing of scan. for scenes of a "
                                    "manifest, found {}",
                                    experiment.name, change.name));
    return;
  }
  if (experiment.repetitions > 1) {
    reader.fault(where, fmt::format("experiment {}: expected one repetition for scenes of a "
                                    "manifest, found {}",
                                    experiment.name, experiment.repetitions));
  }
}

/// Settings that are valid separately may be invalid together.
void check_settings(Reader& reader, const toml::table& where, const Study& study,
                    const Experiment& experiment) {
  for (const std::size_t group : experiment.scenes) {
    check_listed(reader, where, study.scenes[group], experiment);
    for (const Method method : experiment.methods) {
      for (const Variant& variant : experiment.variants) {
        const Result<StudySettings> settings =
            settings_of(study, experiment, study.scenes[group], method, variant);
        const Result<void> valid = settings ? validate(*settings) : Result<void>(settings.error());
        if (!valid) {
          reader.fault(where, fmt::format("experiment {}, {}: {}", experiment.name, variant.name,
                                          valid.error().message));
          return;
        }
      }
    }
  }
}

Result<toml::table> parse(const fs::path& file, std::string_view text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    return Error{ErrorCode::bad_data, fmt::format("{}:{}: {}", file.filename().string(),
                                                  error.source().begin.line, error.description())};
  }
}

Study read_root(Reader& reader, const toml::table& root) {
  reader.allow(root, {"title", "about", "seed", "pictures", "models", "scenes", "experiments"});
  Study study;
  reader.read(root, "title", study.title);
  reader.read(root, "about", study.about);
  reader.read(root, "seed", 0, kMaxSeed, study.seed);
  reader.read(root, "pictures", 0, 100, study.num_pictures);
  for (const auto& [name, table] : reader.tables(root, "models"))
    study.models.push_back(read_models(reader, name, *table));
  for (const auto& [name, table] : reader.tables(root, "scenes"))
    study.scenes.push_back(read_scenes(reader, name, *table, study));
  const toml::node* const experiments = root.get("experiments");
  if (!experiments || !experiments->is_array() ||
      !experiments->as_array()->is_homogeneous<toml::table>()) {
    reader.fault(root, "expected [[experiments]]");
    return study;
  }
  std::set<std::string> names;
  for (const toml::node& node : *experiments->as_array()) {
    Experiment experiment = read_experiment(reader, *node.as_table(), study);
    if (!names.insert(experiment.name).second)
      reader.fault(node, fmt::format("found a second experiment '{}'", experiment.name));
    if (reader.faults().empty()) check_settings(reader, *node.as_table(), study, experiment);
    study.experiments.push_back(std::move(experiment));
  }
  return study;
}

}  // namespace

Result<StudySettings> settings_of(const Study& study, const Experiment& experiment,
                                  const SceneGroup& scenes, Method method, const Variant& variant) {
  StudySettings settings;
  settings.scan.seed = study.seed;
  for (const std::vector<SettingChange>* changes :
       {&scenes.changes, &experiment.changes, &variant.changes}) {
    TRIVET_TRY(change_settings(*changes, settings));
  }
  settings.train.point_pairs = method != Method::trisi;
  settings.train.tri_spin_images = method != Method::ppf;
  settings.recognize.method = method;
  return settings;
}

Result<Study> read_study(const fs::path& file) {
  Result<std::string> text = read_text_file(file, kMaxBytes);
  if (!text) return text.error();
  const Result<toml::table> root = parse(file, *text);
  if (!root) return root.error();
  Reader reader(file);
  Study study = read_root(reader, *root);
  if (!reader.faults().empty())
    return Error{ErrorCode::bad_data, fmt::format("{}", fmt::join(reader.faults(), "\n"))};
  study.text = *std::move(text);
  return study;
}

}  // namespace trivet::apps::study
