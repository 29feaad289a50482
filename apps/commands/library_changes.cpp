#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "apps/commands/in_child.hpp"
#include "apps/commands/library_commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/program/train_request.hpp"
#include "apps/results/standard_output.hpp"
#include "engine/libraries/assemble_library.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/libraries/export_models.hpp"
#include "engine/training/provenance.hpp"
#include "storage/library/import_library.hpp"

namespace trivet::apps {
namespace {

struct ChangeArguments {
  std::string file, name, to, output, json, format = "ply";
  std::vector<std::string> names;
  bool keep_going = false;
};

Progress written(const Context& context) {
  return context.console.progress("wrote", context.stop, true);
}

/// A request with the given models, and the unit and parameters of the library.
Result<TrainRequest> request_to_add(const ChangeArguments& arguments, const Console& console) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  Result<ModelInputs> inputs = collect_models(arguments.names);
  if (!inputs) return inputs.error();
  for (const std::string& note : inputs->notes) console.line(note);
  for (const std::string& words : left_out_words(inputs->left_out)) console.warning(words);
  const Result<LengthUnit> unit = choose_unit(*inputs, {}, library->header.unit);
  if (!unit) return unit.error();
  const Result<TrainOptions> options = engine::parse_parameters(library->header.parameters);
  if (!options) {
    return Error{options.error().code,
                 fmt::format("{}: {}; train all its models again with this version", arguments.file,
                             options.error().message)};
  }
  return TrainRequest{
      std::move(inputs->sources), *unit, *options, arguments.file, false, arguments.keep_going,
      std::move(inputs->left_out)};
}

Result<void> add_models(const ChangeArguments& arguments, const Context& context) {
  const Result<TrainRequest> request = request_to_add(arguments, context.console);
  if (!request) return request.error();
  return train_and_report(*request, arguments.json, context.console, context.stop);
}

Result<void> remove(const ChangeArguments& arguments, const Context& context) {
  return remove_models(arguments.file, arguments.names, written(context));
}

Result<void> rename(const ChangeArguments& arguments, const Context& context) {
  return rename_model(arguments.file, arguments.name, arguments.to, written(context));
}

Result<void> merge(const ChangeArguments& arguments, const Context& context) {
  std::vector<std::filesystem::path> files{arguments.file};
  files.insert(files.end(), arguments.names.begin(), arguments.names.end());
  return merge_libraries(files, arguments.output, written(context));
}

Result<void> export_surfaces(const ChangeArguments& arguments, const Context&) {
  const Result<Library> library = open_library(arguments.file);
  if (!library) return library.error();
  const SurfaceFormat format = arguments.format == "ply"    ? SurfaceFormat::ply
                               : arguments.format == "gltf" ? SurfaceFormat::gltf
                                                            : SurfaceFormat::bop;
  const auto files = export_models(*library, arguments.names, format, arguments.output);
  if (!files) return files.error();
  std::string text;
  for (const auto& file : *files) text += file.string() + '\n';
  return write_output(text);
}

Result<void> unpack(const ChangeArguments& arguments, const Progress& progress) {
  const Result<Library> library = read_repacked_library(arguments.file);
  if (!library) return library.error();
  const Result<FileLock> lock = FileLock::acquire(arguments.output);
  if (!lock) return lock.error();
  return assemble_library(library->header, library->basis, copies_of(*library), *lock, progress);
}

/// HDF5 may crash on a damaged file whose structure has no checksums.
Result<void> import_file(const ChangeArguments& arguments, const Context& context) {
  return in_child(
      [&] {
        return unpack(arguments, {{}, context.stop});
      },
      {ErrorCode::bad_data, arguments.file + ": HDF5 broke down over it: the file is damaged; copy "
                                             "it again or train the library again"});
}

}  // namespace

void add_library_changes(CLI::App& library, Context& context) {
  auto arguments = std::make_shared<ChangeArguments>();
  const auto add = [&](const char* name, const char* help,
                       Result<void> (*work)(const ChangeArguments&, const Context&)) {
    CLI::App* const below = library.add_subcommand(name, help);
    below->add_option("LIBRARY", arguments->file, "Library file")->required();
    below->callback([arguments, work, &context] {
      context.run = [arguments, work, &context] { return work(*arguments, context); };
    });
    return below;
  };
  const auto add_output = [&](CLI::App* command, const char* help) {
    command->add_option("-o,--output", arguments->output, help)->required();
  };
  CLI::App* const add_command = add(
      "add",
      "Train models into the library, with the unit and the parameters that it has\n\n"
      "A model of a name that it has is replaced, if its source is another one; of another file\n"
      "only where NAME=FILE says so.",
      add_models);
  add_command->add_option("MODEL", arguments->names, "Models, as of trivet train")->required();
  add_command->add_flag("--keep-going", arguments->keep_going,
                        "Leave out models that cannot be trained, and write the others");
  add_command->add_option("--json", arguments->json,
                          "Write what was trained as JSON to this file, - for standard output");
  add("remove", "Remove models from the library", remove)
      ->add_option("NAME", arguments->names, "Names of models")
      ->required();
  CLI::App* const rename_command = add("rename", "Give a model another name", rename);
  rename_command->add_option("NAME", arguments->name, "Name of the model")->required();
  rename_command->add_option("NEW", arguments->to, "Name that it gets")->required();
  CLI::App* const merge_command =
      add("merge", "Write the models of several libraries, trained alike, into one", merge);
  merge_command->add_option("OTHER", arguments->names, "Further library files")->required();
  add_output(merge_command, "Library file to write; it appears whole or not at all");
  CLI::App* const export_command = add(
      "export",
      "Write the surfaces of models and print the paths of what trivet train takes\n\n"
      "Those of PLY and glTF are called as their models; BOP numbers them, in millimeters, with\n"
      "their symmetries in models_info.json and their names in manifest.json.",
      export_surfaces);
  export_command->add_option("NAME", arguments->names, "Names of models; none: all");
  export_command
      ->add_option("--as", arguments->format,
                   "What to write: ply, gltf (binary, in meters) or bop (a folder of models)")
      ->check(CLI::IsMember({"ply", "gltf", "bop"}))
      ->capture_default_str();
  add_output(export_command, "Folder for them");
  add_output(add("import",
                 "Import a library that another program rewrote\n\n"
                 "HDF5's tools can chunk, compress and rearrange a file, as h5repack does. Such a "
                 "library\n"
                 "cannot be mapped; this checks it, unpacks it and writes it as trivet train does.",
                 import_file),
             "Library file to write; it appears whole or not at all");
}

}  // namespace trivet::apps
