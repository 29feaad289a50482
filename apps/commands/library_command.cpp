#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <numeric>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/commands/in_child.hpp"
#include "apps/results/json_output.hpp"
#include "apps/results/library_summary.hpp"
#include "apps/results/standard_output.hpp"
#include "engine/libraries/copy_models.hpp"
#include "engine/libraries/split_library.hpp"
#include "storage/counted.hpp"
#include "storage/library.hpp"
#include "storage/library/import_library.hpp"

namespace trivet::apps {
namespace {

struct LibraryArguments {
  std::string file, json, output;
  std::size_t num_parts = 2;
};

Result<void> list(const LibraryArguments& arguments) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  std::string text;
  for (const Model& model : library->models) text += model.name + '\n';
  return write_output(text);
}

Result<void> info(const LibraryArguments& arguments) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  if (!arguments.json.empty()) return write_json(arguments.json, library_json(*library));
  return write_output(library_text(*library));
}

Result<void> verify(const LibraryArguments& arguments) {
  const Result<Library> library = verify_library(arguments.file);
  if (!library) return library.error();
  return write_output(fmt::format("{}: {} and {} are as they were written\n", arguments.file,
                                  counted(library->models.size(), "model"),
                                  counted(library->index.size(), "level")));
}

Result<void> split(const LibraryArguments& arguments) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  const auto files = split_library(*library, arguments.num_parts, arguments.output);
  if (!files) return files.error();
  std::string text;
  for (const auto& part : *files) text += part.string() + '\n';
  return write_output(text);
}

Result<void> unpack(const LibraryArguments& arguments) {
  const Result<Library> library = read_repacked_library(arguments.file);
  if (!library) return library.error();
  std::vector<std::uint32_t> models(library->models.size());
  std::iota(models.begin(), models.end(), 0U);
  return copy_models(*library, models, arguments.output);
}

/// HDF5 may break down over a damaged file whose structure has no checksums.
Result<void> import_file(const LibraryArguments& arguments) {
  return in_child(
      [&] { return unpack(arguments); },
      {ErrorCode::bad_data, arguments.file + ": HDF5 broke down over it: the file is "
                                             "damaged; copy it again or train it anew"});
}

}  // namespace

void add_library(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("library", "Look into a library file, split it, or take one in again");
  command->require_subcommand(1);
  auto arguments = std::make_shared<LibraryArguments>();
  const auto add = [&](const char* name, const char* help,
                       Result<void> (*work)(const LibraryArguments&)) {
    CLI::App* const below = command->add_subcommand(name, help);
    below->add_option("LIBRARY", arguments->file, "Library file")->required();
    below->callback([arguments, work, &context] {
      context.run = [arguments, work] { return work(*arguments); };
    });
    return below;
  };
  add("list", "Print the models' names, one a line", list);
  add("info", "Print what the file holds", info)
      ->add_option("--json", arguments->json,
                   "Write it as JSON to this file, - for standard output");
  add("verify",
      "Check every byte and every value of the file\n\n"
      "Opening a library checks its structure, and each model when it is first used. This checks\n"
      "all of it: checksums, bounds, and that its directory says what HDF5 finds.",
      verify);
  CLI::App* const split_command = add(
      "split", "Write parts for several machines (`trivet route`) and print their files", split);
  split_command->add_option("-n,--parts", arguments->num_parts, "Parts, of about equal size")
      ->capture_default_str();
  split_command->add_option("-o,--output", arguments->output, "Folder for them")->required();
  add("import",
      "Take in a library that another program stored anew\n\n"
      "HDF5's tools can chunk, compress and rearrange a file, as h5repack does. Such a library\n"
      "cannot be mapped; this checks it, unpacks it and writes it as trivet train does.",
      import_file)
      ->add_option("-o,--output", arguments->output,
                   "Library file to write; it appears whole or not at all")
      ->required();
}

}  // namespace trivet::apps
