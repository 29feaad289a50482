/// Converts the command line to a training request, and the result to output, for all programs that
/// train.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "apps/options/add_options.hpp"
#include "apps/program/console.hpp"
#include "engine/training/train.hpp"
#include "storage/common/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

struct TrainArguments {
  std::vector<std::string> models;
  std::string output, unit, json;
  bool prune = false, keep_going = false;
  GivenOption preset;
  GivenOptions given;
};

/// The arguments must outlive the parsing.
void add_train_options(CLI::App& command, TrainArguments& arguments);

/// Errors: of reading the lists of models, usage.
Result<TrainRequest> make_request(const TrainArguments& arguments, const Console& console);

TrainProgress train_progress(const Console& console, const std::stop_token& stop);

/// Prints warnings, table and summary, and writes the JSON.
/// Errors: io; bad_data: models were left out.
Result<void> write_train_report(const TrainReport& report, const TrainRequest& request,
                                const std::string& json, const Console& console);

/// Trains in this process, with progress, and prints the result. Errors: of both.
Result<void> train_and_report(const TrainRequest& request, const std::string& json,
                              const Console& console, const std::stop_token& stop);

}  // namespace trivet::apps
