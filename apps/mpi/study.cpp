#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/mpi/commands.hpp"
#include "apps/program/study_request.hpp"
#include "engine/common/progress.hpp"

namespace trivet::apps::mpi {
namespace {

/// Items that a rank gets at a time if there are many: enough for its threads.
constexpr std::size_t kItems = 16;

std::string items_bytes(std::span<const std::size_t> items) {
  return {reinterpret_cast<const char*>(items.data()), items.size_bytes()};
}

std::vector<std::size_t> parse_items(const std::string& bytes) {
  std::vector<std::size_t> items(bytes.size() / sizeof(std::size_t));
  std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<char*>(items.data()));
  return items;
}

/// Distributes items over all ranks, a few at a time if there are many; rank 0 reports the
/// progress.
study::Share shared_among(const Ranks& ranks, const Context& context) {
  return [&](std::span<const std::size_t> items,
             const std::function<Result<void>(std::span<const std::size_t>)>& work) {
    const auto num_ranks = static_cast<std::size_t>(ranks.size());
    const std::size_t step = std::clamp<std::size_t>(items.size() / (4 * num_ranks), 1, kItems);
    const Progress progress = context.console.progress("done", context.stop);
    std::size_t first = 0, num_done = 0;
    const JobBook book{[&]() -> std::optional<std::string> {
                         if (first >= items.size() || context.stop.stop_requested())
                           return std::nullopt;
                         const auto some =
                             items.subspan(first, std::min(step, items.size() - first));
                         first += some.size();
                         return items_bytes(some);
                       },
                       [&](const std::string& outcome) {
                         num_done += std::stoull(outcome);
                         progress(num_done, items.size(), "");
                       }};
    return share_jobs(
        ranks, book,
        [&](const Worker& worker) -> Result<void> {
          while (const std::optional<std::string> job = worker.next()) {
            const std::vector<std::size_t> some = parse_items(*job);
            TRIVET_TRY(work(some));
            worker.done(std::to_string(some.size()));
          }
          return {};
        },
        context.stop);
  };
}

}  // namespace

void add_study(CLI::App& app, const Ranks& ranks, Context& context) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = app.add_subcommand(
      "study",
      "Compare methods and parameters on scenes whose truth is known\n\n"
      "As trivet study: all ranks render, train and recognize what the folder does not hold yet;\n"
      "rank 0 writes tables and report.");
  add_study_arguments(*command, *arguments);
  command->callback([arguments, &ranks, &context] {
    context.run = [arguments, &ranks, &context] {
      Context quiet = context;  // each rank's share is not reported
      quiet.console.quiet = true;
      const Result<void> done =
          conduct_study(*arguments, quiet, shared_among(ranks, context), ranks.is_first());
      if (done && ranks.is_first()) context.console.wrote_report(arguments->output);
      return done;
    };
  });
}

}  // namespace trivet::apps::mpi
