#include "python/src/train.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "apps/words/train_summary.hpp"
#include "engine/options/presets.hpp"
#include "engine/training/train.hpp"
#include "python/src/arrays.hpp"
#include "python/src/call.hpp"
#include "python/src/options.hpp"
#include "python/src/scene.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::python {
namespace {

/// Returns the document of `trivet train --json`.
std::string train(const std::vector<std::string>& models, const std::string& output,
                  const py::object& unit, bool prune, bool keep_going, const std::string& preset,
                  const py::object& progress, const py::dict& keywords) {
  const auto found = train_presets().find(preset);
  if (found == train_presets().end()) {
    raise({ErrorCode::usage,
           fmt::format("preset: expected fast, balanced or accurate, found '{}'", preset)});
  }
  TrainRequest request;
  request.options = found->second;
  set_options(keywords, request.options);
  apps::ModelInputs inputs = unwrap(apps::collect_models(models));
  unit_from(unit);
  request.unit = unwrap(apps::choose_unit_into(
      output, inputs, unit.is_none() ? std::string() : unit.cast<std::string>(), prune));
  request.left_out = std::move(inputs.left_out);
  request.sources = std::move(inputs.sources);
  request.file = output;
  request.prune = prune;
  request.keep_going = keep_going;

  std::stop_source stop;
  Reports reports(progress, stop);
  const Result<TrainReport> report = interruptibly(
      [&](const std::stop_token& token) {
        return train_library(request, {{{}, token}, reports.to(token), {{}, token}});
      },
      stop);
  reports.rethrow();
  return json_text(apps::train_json(unwrap(report), request));
}

}  // namespace

void add_train(py::module_& module) {
  module.def("_train", &train);
  module.def("_train_options", &describe_options<TrainOptions>);
}

}  // namespace trivet::python
