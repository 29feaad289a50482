#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "apps/commands/library_commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/results/write_json.hpp"
#include "apps/words/library_summary.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/loaded_library/find_families.hpp"
#include "storage/common/counted.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {
namespace {

struct ViewArguments {
  std::string file, other, json;
  std::optional<float> deviation;
};

Result<void> list(const ViewArguments& arguments) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  std::string text;
  for (const ModelInfo& model : library->models) text += model.name + '\n';
  return write_output(text);
}

Result<void> info(const ViewArguments& arguments) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  if (!arguments.json.empty()) return write_json(arguments.json, library_json(*library));
  return write_output(library_text(*library));
}

Result<void> verify(const ViewArguments& arguments) {
  const Result<Library> library = verify_library(arguments.file);
  if (!library) return library.error();
  return write_output(fmt::format("{}: {} and {} are as they were written\n", arguments.file,
                                  counted(library->models.size(), "model"),
                                  counted(library->index.size(), "level")));
}

std::string difference_text(const LibraryDifference& difference) {
  std::string text;
  const auto list = [&](std::string_view change, const std::vector<std::string>& names) {
    for (const std::string& name : names) text += fmt::format("{:<8} {}\n", change, name);
  };
  if (!difference.same_parameters) text += "unit or training parameters differ\n";
  list("added", difference.added);
  list("removed", difference.removed);
  list("changed", difference.changed);
  for (const auto& [before, after] : difference.renamed)
    text += fmt::format("{:<8} {} to {}\n", "renamed", before, after);
  return text +
         fmt::format("{} the same\n", counted(difference.num_same, "model is", "models are"));
}

nlohmann::ordered_json difference_json(const LibraryDifference& difference) {
  nlohmann::ordered_json renamed = nlohmann::ordered_json::array();
  for (const auto& [before, after] : difference.renamed)
    renamed.push_back({{"from", before}, {"to", after}});
  return {{"same_parameters", difference.same_parameters},
          {"added", difference.added},
          {"removed", difference.removed},
          {"changed", difference.changed},
          {"renamed", std::move(renamed)},
          {"same", difference.num_same}};
}

Result<void> diff(const ViewArguments& arguments) {
  const Result<Library> before = open_library(arguments.file);
  if (!before) return before.error();
  const Result<Library> after = open_library(arguments.other);
  if (!after) return after.error();
  const LibraryDifference difference = compare_libraries(*before, *after);
  if (!arguments.json.empty()) return write_json(arguments.json, difference_json(difference));
  return write_output(difference_text(difference));
}

std::string place_words(const Eigen::Vector3f& place) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", place.x(), place.y(), place.z());
}

std::string families_text(const Library& library, std::span<const Family> families) {
  if (families.empty()) return "No two models are near copies of each other\n";
  std::string text;
  const auto name = [&](std::uint32_t model) { return library.models[model].name; };
  for (const Family& family : families) {
    for (const std::uint32_t model : family.models)
      text += (model == family.models.front() ? "" : ", ") + name(model);
    text += '\n';
    for (const FamilyPair& pair : family.pairs) {
      text +=
          fmt::format("  {} and {} differ by up to {:.3g} {} around {} of {}\n", name(pair.first),
                      name(pair.second), pair.difference.deviation, unit_name(library.header.unit),
                      place_words(pair.difference.center), name(pair.first));
    }
  }
  return text;
}

nlohmann::ordered_json families_json(const Library& library, std::span<const Family> families) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const auto name = [&](std::uint32_t model) { return library.models[model].name; };
  for (const Family& family : families) {
    nlohmann::ordered_json models = nlohmann::ordered_json::array(),
                           pairs = nlohmann::ordered_json::array();
    for (const std::uint32_t model : family.models) models.push_back(name(model));
    for (const FamilyPair& pair : family.pairs) {
      const kernels::SurfaceDifference& d = pair.difference;
      pairs.push_back({{"first", name(pair.first)},
                       {"second", name(pair.second)},
                       {"agreeing", pair.agreeing},
                       {"deviation", d.deviation},
                       {"center", {d.center.x(), d.center.y(), d.center.z()}},
                       {"size", d.size}});
    }
    json.push_back({{"models", std::move(models)}, {"pairs", std::move(pairs)}});
  }
  return {{"unit", unit_name(library.header.unit)}, {"families", std::move(json)}};
}

Result<void> families(const ViewArguments& arguments) {
  Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  const Recognizer recognizer(*std::move(library));
  const Result<std::vector<Family>> found = find_families(recognizer, arguments.deviation);
  if (!found) return found.error();
  if (!arguments.json.empty())
    return write_json(arguments.json, families_json(recognizer.library(), *found));
  return write_output(families_text(recognizer.library(), *found));
}

}  // namespace

void add_library_views(CLI::App& library, Context& context) {
  auto arguments = std::make_shared<ViewArguments>();
  const auto add = [&](const char* name, const char* help,
                       Result<void> (*work)(const ViewArguments&)) {
    CLI::App* const below = library.add_subcommand(name, help);
    below->add_option("LIBRARY", arguments->file, "Library file")->required();
    below->callback([arguments, work, &context] {
      context.run = [arguments, work] { return work(*arguments); };
    });
    return below;
  };
  const auto add_json = [&](CLI::App* command) {
    command->add_option("--json", arguments->json,
                        "Write it as JSON to this file, - for standard output");
  };
  add("list", "Print the models' names, one a line", list);
  add_json(add("info", "Print what the file holds", info));
  add("verify",
      "Check every byte and every value of the file\n\n"
      "Opening a library checks its structure, and each model when it is first used. This checks\n"
      "all of it: checksums, bounds, and that its directory says what HDF5 finds.",
      verify);
  CLI::App* const families_command = add(
      "families",
      "Print which models are near copies of each other, and where they differ\n\n"
      "Nine tenths of their surfaces coincide, to 0.8 % of the diameter, so a scan may not tell\n"
      "them apart. Families are linked by such pairs.",
      families);
  families_command
      ->add_option(
          "--deviation", arguments->deviation,
          "Largest distance of the surfaces of a pair, in the library's unit; by default any")
      ->check(CLI::NonNegativeNumber);
  add_json(families_command);
  CLI::App* const diff_command = add(
      "diff",
      "Print which models were added, removed, renamed or changed from one library to another\n\n"
      "Models are the same where they were trained from the same bytes with the same\n"
      "parameters.",
      diff);
  diff_command->add_option("OTHER", arguments->other, "Library file to compare with it")
      ->required();
  add_json(diff_command);
}

}  // namespace trivet::apps
