/// trivet: recognize known rigid objects in 3-D scans.

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

#include "apps/commands/commands.hpp"
#include "apps/help/command_help.hpp"
#include "apps/program/run_app.hpp"

int main(int argc, char** argv) {
  using namespace trivet;
  apps::Context context;
  context.stop = apps::watch_signals();
  CLI::App app{
      "Recognize known rigid objects in 3-D scans.\n"
      "Train a library once, then find its models in scenes:\n\n"
      "  trivet train MODELS/ -o LIBRARY.h5\n"
      "  trivet recognize LIBRARY.h5 SCENE.ply --json -\n"};
  app.set_version_flag("--version", "trivet " TRIVET_VERSION)->group(apps::kAbout);
  apps::add_common_options(app, context);
  apps::add_train(app, context);
  apps::add_recognize(app, context);
  apps::add_evaluate(app, context);
  apps::add_compare(app, context);
  apps::add_scan(app, context);
  apps::add_mesh(app, context);
  apps::add_calibrate(app, context);
  apps::add_fit_score(app, context);
  apps::add_study(app, context);
  apps::add_serve(app, context);
  apps::add_library(app, context);
  apps::add_documents(app);

  if (argc > 1 && std::string_view(argv[1]) == "recognise") {
    context.console.line("trivet recognise is trivet recognize");
    static std::string recognize = "recognize";
    argv[1] = recognize.data();
  }
  return apps::run_app(app, context, argc, argv);
}
