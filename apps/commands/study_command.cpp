#include <CLI/CLI.hpp>
#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/program/study_request.hpp"

namespace trivet::apps {

void add_study(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = app.add_subcommand(
      "study",
      "Compare methods and parameters on scenes whose truth is known\n\n"
      "A configuration declares models, scenes and experiments. Scenes are rendered, libraries\n"
      "trained and scenes recognized, each once; what the folder holds already is not computed\n"
      "again, so that a study that was stopped goes on. It ends with index.html, a report with\n"
      "curves, tables and pictures, results.csv and libraries.csv.");
  add_study_arguments(*command, *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] {
      return conduct_study(*arguments, context, study::do_all);
    };
  });
}

}  // namespace trivet::apps
