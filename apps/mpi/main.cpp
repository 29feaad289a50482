/// trivet-mpi: train libraries and recognize scenes with many processes, on one machine or many.

#include <CLI/CLI.hpp>

#include "apps/help/command_help.hpp"
#include "apps/mpi/commands.hpp"
#include "apps/mpi/ranks.hpp"
#include "apps/program/run_app.hpp"

int main(int argc, char** argv) {
  using namespace trivet;
  apps::Context context;
  context.stop = apps::watch_signals();  // before MPI starts threads
  const apps::mpi::Ranks ranks(argc, argv);
  context.console.quiet = !ranks.is_first();
  CLI::App app{
      "Train libraries and recognize scenes with many processes.\n"
      "Started by mpirun or srun; all processes see the same files:\n\n"
      "  mpirun -n 4 trivet-mpi train MODELS/ -o LIBRARY.h5\n"
      "  mpirun -n 4 trivet-mpi recognize LIBRARY.h5 SCENES/ --json FOUND.json\n"};
  app.set_version_flag("--version", "trivet-mpi " TRIVET_VERSION)->group(apps::kAbout);
  apps::add_common_options(app, context);
  apps::mpi::add_train(app, ranks, context);
  apps::mpi::add_recognize(app, ranks, context);
  apps::mpi::add_study(app, ranks, context);
  const int code = apps::run_app(app, context, argc, argv);
  if (code != 0) ranks.end_all(code);
  return code;
}
