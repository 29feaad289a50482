#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/commands/commands.hpp"
#include "apps/program/train_request.hpp"

namespace trivet::apps {
namespace {

Result<void> train(const TrainArguments& arguments, const Context& context) {
  const Result<TrainRequest> request = make_request(arguments, context.console);
  if (!request) return request.error();
  return train_and_report(*request, arguments.json, context.console, context.stop);
}

}  // namespace

void add_train(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = app.add_subcommand(
      "train",
      "Train models into one library file\n\n"
      "Models of the file whose sources and parameters are unchanged are reused; the result "
      "is\n"
      "that of training everything again. What is trained is kept in LIBRARY.parts until the file "
      "is\n"
      "written: a run that was stopped or killed is gone on with by the same command.");
  add_train_options(*command, *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return train(*arguments, context); };
  });
}

}  // namespace trivet::apps
