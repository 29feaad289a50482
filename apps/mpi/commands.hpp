/// The subcommands of trivet-mpi: those of trivet, distributed over processes.
#pragma once

#include "apps/mpi/ranks.hpp"
#include "apps/program/context.hpp"

namespace trivet::apps::mpi {

void add_train(CLI::App& app, const Ranks& ranks, Context& context);
void add_recognize(CLI::App& app, const Ranks& ranks, Context& context);
void add_study(CLI::App& app, const Ranks& ranks, Context& context);

}  // namespace trivet::apps::mpi
