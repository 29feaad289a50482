#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/results/comparison.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/results/write_json.hpp"
#include "engine/common/scaled.hpp"
#include "engine/evaluation/evaluation_meshes.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {
namespace {

struct CompareArguments {
  std::string a, b, library, unit, json;
  double max_rotation = PoseTolerance{}.rotation_deg;
  std::optional<double> max_translation;  ///< in the scenes' unit
};

/// The meshes of the library in the scenes' unit. Errors: those of open_library and meshes_of.
Result<std::vector<EvaluationMesh>> library_meshes(const CompareArguments& arguments) {
  const Result<Library> library = open_library(arguments.library);
  if (!library) return library.error();
  Result<std::vector<EvaluationMesh>> meshes = meshes_of(*library);
  if (!meshes || arguments.unit.empty()) return meshes;
  const double scale = unit_scale(library->header.unit, parse_unit(arguments.unit));
  for (EvaluationMesh& mesh : *meshes) {
    mesh.vertices = engine::scaled_points(mesh.vertices, scale);
    mesh.diameter *= scale;
    mesh.symmetry = engine::scaled(mesh.symmetry, scale);
  }
  return meshes;
}

Result<Comparison> compare(const CompareArguments& arguments) {
  Result<ComparedResult> a = read_compared(arguments.a);
  if (!a) return a.error();
  Result<ComparedResult> b = read_compared(arguments.b);
  if (!b) return b.error();
  if (a->has_truth && b->has_truth)
    return compare_results(std::move(*a), std::move(*b), nullptr, "what finds the same truth");
  if (!arguments.library.empty()) {
    const Result<std::vector<EvaluationMesh>> meshes = library_meshes(arguments);
    if (!meshes) return meshes.error();
    const PoseMatcher matcher(*meshes);
    return compare_results(std::move(*a), std::move(*b), &matcher,
                           "one model within a tenth of its diameter and 12 degrees, at best over "
                           "its symmetries");
  }
  if (!arguments.max_translation) return compare_results(std::move(*a), std::move(*b), nullptr, {});
  const PoseMatcher matcher(PoseTolerance{*arguments.max_translation, arguments.max_rotation});
  return compare_results(
      std::move(*a), std::move(*b), &matcher,
      fmt::format("one model within {:.6g} and {:.6g} degrees, symmetries not known",
                  *arguments.max_translation, arguments.max_rotation));
}

Result<void> write_comparison(const CompareArguments& arguments) {
  const Result<Comparison> comparison = compare(arguments);
  if (!comparison) return comparison.error();
  if (arguments.json != "-") {
    TRIVET_TRY(write_output(comparison_text(*comparison)));
  }
  if (arguments.json.empty()) return {};
  return write_json(arguments.json, comparison_json(*comparison));
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand(
      "compare", "Report what two results over the same scenes found, and which of them alone");
  command
      ->add_option(
          "A", arguments->a,
          "Result of `trivet recognize --json` or `trivet evaluate --json`, or a folder of "
          "them, as the runs of a session")
      ->required();
  command->add_option("B", arguments->b, "Another one, over the same scenes")->required();
  auto* library = command->add_option("--library", arguments->library,
                                      "Poses are the same as `trivet evaluate` has it, by the "
                                      "sizes and symmetries of this library");
  command->add_option("--unit", arguments->unit, "Unit of the scenes; else the library's")
      ->check(CLI::IsMember({"m", "mm"}))
      ->needs(library);
  command
      ->add_option(
          "--max-translation", arguments->max_translation,
          "Without a library: poses are the same whose origins are nearer than this [scene's "
          "unit]")
      ->check(CLI::PositiveNumber)
      ->excludes(library);
  command
      ->add_option("--max-rotation", arguments->max_rotation,
                   "Without a library: and whose rotations differ by less [deg]")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str()
      ->excludes(library);
  command->add_option("--json", arguments->json,
                      "Write the comparison as JSON to this file, - for standard output");
  command->callback([arguments, &context] {
    context.run = [arguments] { return write_comparison(*arguments); };
  });
}

}  // namespace trivet::apps
