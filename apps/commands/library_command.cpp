#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <numeric>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/results/standard_output.hpp"
#include "storage/library.hpp"
#include "storage/library/split_library.hpp"

namespace trivet::apps {
namespace {

std::string describe(const Symmetry& symmetry) {
  if (symmetry.trivial()) return "none";
  std::string text;
  if (symmetry.axis) text = "axis";
  if (!symmetry.poses.empty())
    text += fmt::format("{}{} poses", text.empty() ? "" : " + ", symmetry.poses.size());
  return text + (symmetry.declared ? " (declared)" : " (found)");
}

std::string describe_near(const Model& model) {
  return fmt::format("{}{}", model.near_axis ? "axis + " : "", model.near_symmetries.size());
}

/// Tri-Spin-Images of all models together, and how much of the file is theirs.
std::string describe_features(const Library& library) {
  const TriSpinBasis& basis = library.basis;
  const PcaBasis& pca = basis.components;
  if (pca.size() == 0) return "none";
  std::uint64_t bytes = 0;
  for (const DatasetInfo& dataset : library.datasets) {
    if (dataset.path.find("trisi/") != std::string::npos) bytes += dataset.bytes;
  }
  std::size_t number = 0;
  for (const Model& model : library.models) number += model.features.size();
  const double energy = std::accumulate(pca.energies.begin(), pca.energies.end(), 0.0);
  return fmt::format(
      "{} Tri-Spin-Images of radius {} resolutions, {} components with {:.1f} % of the variance, "
      "{} bytes",
      number, basis.support, pca.size(), 100 * energy / pca.all_energy, bytes);
}

Result<void> list(const std::string& file) {
  const Result<Library> library = open_library(file);
  if (!library) return library.error();
  std::string text;
  for (const Model& model : library->models) text += model.name + '\n';
  return write_output(text);
}

Result<void> info(const std::string& file) {
  const Result<Library> library = open_library(file);
  if (!library) return library.error();
  const char* const unit = unit_name(library->header.unit);
  std::string text = fmt::format(
      "file        {}\nsize        {} bytes\nformat      {}.{}\nproducer    {}\nunit        "
      "{}\nparameters  {}\n"
      "models      {}\nfeatures    {}\n\n",
      file, library->file_bytes, kLibraryVersionMajor, library->version_minor,
      library->header.producer, unit, library->header.parameters, library->models.size(),
      describe_features(*library));
  text += fmt::format("{:<32} {:>12} {:>9} {:>9} {:>9} {:>12} {:>10} {:>9} {:>9}  {}\n", "model",
                      fmt::format("diameter[{}]", unit), "vertices", "samples", "points", "pairs",
                      fmt::format("step[{}]", unit), "features", "near", "symmetry");
  for (const Model& model : library->models) {
    text += fmt::format("{:<32} {:>12.5g} {:>9} {:>9} {:>9} {:>12} {:>10.4g} {:>9} {:>9}  {}\n",
                        model.name, model.diameter, model.vertices.size(), model.samples.size(),
                        model.ppf_points.size(), model.ppf.entries.size(),
                        model.ppf.quantization.distance_step, model.features.size(),
                        describe_near(model), describe(model.symmetry));
  }
  return write_output(text);
}

Result<void> split(const std::string& file, std::size_t num_parts, const std::string& folder) {
  const Result<Library> library = open_library(file);
  if (!library) return library.error();
  const auto files = split_library(*library, num_parts, folder);
  if (!files) return files.error();
  std::string text;
  for (const auto& part : *files) text += part.string() + '\n';
  return write_output(text);
}

}  // namespace

void add_library(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("library", "Look into a library file, or split it");
  command->require_subcommand(1);
  auto file = std::make_shared<std::string>();
  CLI::App* list_command = command->add_subcommand("list", "Print the models' names, one a line");
  list_command->add_option("LIBRARY", *file, "Library file")->required();
  list_command->callback([file, &context] { context.run = [file] { return list(*file); }; });
  CLI::App* info_command =
      command->add_subcommand("info", "Print what the file holds, after checking all of it");
  info_command->add_option("LIBRARY", *file, "Library file")->required();
  info_command->callback([file, &context] { context.run = [file] { return info(*file); }; });
  auto num_parts = std::make_shared<std::size_t>(2);
  auto folder = std::make_shared<std::string>();
  CLI::App* split_command = command->add_subcommand(
      "split", "Write parts for several machines (`trivet route`) and print their files");
  split_command->add_option("LIBRARY", *file, "Library file")->required();
  split_command->add_option("-n,--parts", *num_parts, "Parts, of about equal size")
      ->capture_default_str();
  split_command->add_option("-o,--output", *folder, "Folder for them")->required();
  split_command->callback(
      [=, &context] { context.run = [=] { return split(*file, *num_parts, *folder); }; });
}

}  // namespace trivet::apps
