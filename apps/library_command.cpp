#include <fmt/format.h>

#include <memory>

#include "apps/commands.hpp"
#include "apps/inputs.hpp"
#include "storage/library.hpp"

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

Result<void> list(const std::string& file) {
  const Result<Library> library = open_library(file);
  if (!library) return library.error();
  for (const Model& model : library->models) fmt::print("{}\n", model.name);
  return {};
}

Result<void> info(const std::string& file) {
  const Result<Library> library = open_library(file);
  if (!library) return library.error();
  const char* const unit = unit_name(library->header.unit);
  fmt::print(
      "file        {}\nsize        {} bytes\nformat      {}.{}\nproducer    {}\nunit        "
      "{}\nparameters  {}\n"
      "models      {}\n\n",
      file, library->file_bytes, kLibraryVersionMajor, library->version_minor,
      library->header.producer, unit, library->header.parameters, library->models.size());
  fmt::print("{:<32} {:>12} {:>9} {:>9} {:>9} {:>12} {:>10} {:>9}  {}\n", "model",
             fmt::format("diameter[{}]", unit), "vertices", "samples", "points", "pairs", "step",
             "near", "symmetry");
  for (const Model& model : library->models) {
    fmt::print("{:<32} {:>12.5g} {:>9} {:>9} {:>9} {:>12} {:>10.4g} {:>9}  {}\n", model.name,
               model.diameter, model.vertices.size(), model.samples.size(), model.ppf_points.size(),
               model.ppf.entries.size(), model.ppf.quantisation.distance_step, describe_near(model),
               describe(model.symmetry));
  }
  return {};
}

}  // namespace

void add_library(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("library", "Look into a library file");
  command->require_subcommand(1);
  auto file = std::make_shared<std::string>();
  CLI::App* list_command = command->add_subcommand("list", "Print the models' names, one a line");
  list_command->add_option("LIBRARY", *file, "Library file")->required();
  list_command->callback([file, &context] { context.run = [file] { return list(*file); }; });
  CLI::App* info_command =
      command->add_subcommand("info", "Print what the file holds, after checking all of it");
  info_command->add_option("LIBRARY", *file, "Library file")->required();
  info_command->callback([file, &context] { context.run = [file] { return info(*file); }; });
}

}  // namespace trivet::apps
