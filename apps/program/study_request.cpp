#include "apps/program/study_request.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>

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

Result<void> conduct_study(const StudyArguments& arguments, const Context& context,
                           const study::Share& share, bool reports) {
  const Result<Study> study = read_study(arguments.config);
  if (!study) return study.error();
  const Result<StudyPlan> plan = plan_study(*study);
  if (!plan) return plan.error();
  const StudyFolder folder(arguments.output);
  const auto progress_of = [&](std::string_view verb) {
    return context.console.progress(verb, context.stop);
  };
  const Result<void> run = run_study(*study, *plan, folder, progress_of, share);
  if (!run || !reports) return run;
  const Result<StudyResults> results = evaluate_study(*study, *plan, folder);
  if (!results) return results.error();
  TRIVET_TRY(write_study_table(*study, *results, folder));
  TRIVET_TRY(write_study_page(*study, *results, folder, context.command));
  context.console.wrote_report(folder.path().string());
  return {};
}

void add_study_arguments(CLI::App& command, StudyArguments& arguments) {
  command.footer(describe_settings);
  command.add_option("CONFIG", arguments.config, "What to compare (TOML)")->required();
  command
      .add_option("-o,--output", arguments.output,
                  "Folder for the report, and for all that was computed")
      ->required();
}

}  // namespace trivet::apps
