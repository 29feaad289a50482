#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/commands/commands.hpp"
#include "apps/study/page.hpp"
#include "apps/study/plan.hpp"
#include "apps/study/results.hpp"
#include "apps/study/run.hpp"
#include "apps/study/settings.hpp"
#include "apps/study/study.hpp"
#include "apps/study/tables.hpp"

namespace trivet::apps {
namespace {

using namespace study;

struct StudyArguments {
  std::string config, output;
};

Result<void> conduct(const StudyArguments& arguments, const Context& context) {
  const Result<Study> study = read_study(arguments.config);
  if (!study) return study.error();
  const Result<StudyPlan> plan = plan_study(*study);
  if (!plan) return plan.error();
  const StudyFolder folder(arguments.output);
  const Result<void> run = run_study(*study, *plan, folder, [&](std::string_view verb) {
    return context.console.progress(verb, context.stop);
  });
  if (!run) return run;
  const Result<StudyResults> results = evaluate_study(*study, *plan, folder);
  if (!results) return results.error();
  if (const Result<void> written = write_study_table(*study, *results, folder); !written)
    return written;
  if (const Result<void> written = write_study_page(*study, *results, folder, context.command);
      !written) {
    return written;
  }
  context.console.wrote_report(folder.path().string());
  return {};
}

std::string describe_settings() {
  std::string text = "Settings, with their defaults:";
  const StudySettings usual;
  for (const Setting& setting : all_settings()) {
    text += fmt::format("\n  {:<32}{} ({})", setting.name, setting.label,
                        value_text(setting.get(usual)));
  }
  return text + "\nThe configurations in docs/study are examples.";
}

}  // namespace

void add_study(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = app.add_subcommand(
      "study",
      "Compare methods and parameters on scenes whose truth is known\n\n"
      "A configuration declares models, scenes and experiments. Scenes are rendered, libraries\n"
      "trained and scenes recognized, each once; what the folder holds already is not computed\n"
      "again, so that a study that was stopped goes on. It ends with index.html, a report with\n"
      "curves, tables and pictures, results.csv and libraries.csv.");
  command->footer(describe_settings);
  command->add_option("CONFIG", arguments->config, "What to compare (TOML)")->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Folder for the report, and for all that was computed")
      ->required();
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return conduct(*arguments, context); };
  });
}

}  // namespace trivet::apps
