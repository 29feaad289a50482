#include <fmt/format.h>
#include <tbb/flow_graph.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "engine/common/parallel.hpp"
#include "engine/libraries/index_features.hpp"
#include "engine/train.hpp"
#include "storage/file.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

namespace flow = tbb::flow;

/// Models in memory at once: enough to hide reading and writing behind training, however large the
/// library.
constexpr std::size_t kModelsInFlight = 4;

struct Job {
  std::size_t id = 0;
  const ModelSource* source = nullptr;
};

struct Finished {
  std::size_t id = 0;
  std::shared_ptr<Result<TrainedModel>> trained;
};

Result<TrainedModel> read_and_train(const ModelSource& source, LengthUnit unit,
                                    const TrainOptions& options, const TriSpinBasis& basis) {
  StageTimes times;
  std::string hash;
  const Result<Cloud> surface = [&]() -> Result<Cloud> {
    const StageTimer timer(times, "read");
    Result<MappedFile> bytes = MappedFile::open(source.file, ReadOptions{}.max_file_bytes);
    if (!bytes) return bytes.error();
    hash = xxh3_hex(bytes->bytes());
    return read_cloud(source.file, {.unit = unit, .keep_origin = true});
  }();
  if (!surface) return surface.error();
  Result<TrainedModel> trained = train_model(*surface, source, options, basis);
  if (!trained) return trained;
  trained->model.source_xxh3 = hash;
  times.seconds.insert(times.seconds.end(), trained->stats.times.seconds.begin(),
                       trained->stats.times.seconds.end());
  trained->stats.times = std::move(times);
  return trained;
}

/// Why models cannot be trained, of each that cannot; none are missed but those that only pairs or
/// features tell. In the order of the sources.
std::vector<Error> find_faults(std::span<const ModelSource* const> sources, LengthUnit unit,
                               TrainOptions options, const std::stop_token& stop) {
  options.point_pairs = options.tri_spin_images = false;
  std::vector<std::optional<Error>> found(sources.size());
  engine::for_each_index(sources.size(), [&](std::size_t k) {
    if (stop.stop_requested()) return;
    const Result<TrainedModel> trained = read_and_train(*sources[k], unit, options, {});
    if (!trained) found[k] = trained.error();
  });
  std::vector<Error> faults;
  for (const std::optional<Error>& fault : found) {
    if (fault) faults.push_back(*fault);
  }
  return faults;
}

Error join_faults(std::span<const Error> faults, std::size_t num_models) {
  if (faults.size() == 1) return faults[0];
  Error joined{faults[0].code, fmt::format("{} of {} models cannot be trained; nothing was written",
                                           faults.size(), num_models)};
  for (const Error& fault : faults) joined.message += "\n" + fault.message;
  return joined;
}

/// All options, whatever their values: {"methods": ["ppf", "trisi"], "relative-step": 0.04, ...}.
std::string parameters_json(const TrainOptions& options) {
  nlohmann::ordered_json json;
  for (const Option<TrainOptions>& option : options_of<TrainOptions>()) {
    std::visit([&](const auto& value) { json[std::string(option.info.name)] = value; },
               option.get(options));
  }
  return json.dump();
}

}  // namespace

Result<LibraryStats> train_library(std::span<const ModelSource> sources, LengthUnit unit,
                                   const TrainOptions& options, const std::filesystem::path& file,
                                   const Progress& progress) {
  if (const Result<void> valid = validate(options); !valid) return valid.error();
  const auto start = std::chrono::steady_clock::now();
  Result<LibraryWriter> writer =
      LibraryWriter::create(file, {unit, "trivet " TRIVET_VERSION, parameters_json(options)});
  if (!writer) return writer.error();

  // By name, so that the file does not depend on the order of the command line.
  std::vector<const ModelSource*> order(sources.size());
  std::transform(sources.begin(), sources.end(), order.begin(),
                 [](const ModelSource& source) { return &source; });
  std::stable_sort(order.begin(), order.end(),
                   [](const ModelSource* a, const ModelSource* b) { return a->name < b->name; });

  TriSpinBasis basis;
  if (options.tri_spin_images) {
    std::vector<ModelSource> by_name;
    for (const ModelSource* source : order) by_name.push_back(*source);
    Result<TriSpinBasis> found = find_basis(by_name, unit, options, progress.stop);
    if (!found) {
      std::vector<Error> faults = find_faults(order, unit, options, progress.stop);
      if (faults.empty()) faults.push_back(found.error());
      return join_faults(faults, order.size());
    }
    basis = std::move(*found);
    if (basis.components.size() > 0) {
      if (const Result<void> added = writer->add(basis); !added) return added.error();
    }
  }

  LibraryStats stats;
  std::optional<Error> failure, fault;  // of writing, of a model
  std::atomic<bool> failed{false};
  flow::graph graph;
  std::size_t next = 0;
  flow::input_node<Job> jobs(graph, [&](tbb::flow_control& control) {
    if (next == order.size() || failed || progress.stop.stop_requested()) {
      control.stop();
      return Job{};
    }
    const Job job{next, order[next]};
    ++next;
    return job;
  });
  flow::limiter_node<Job> gate(graph, kModelsInFlight);
  flow::function_node<Job, Finished> train(graph, flow::unlimited, [&](const Job& job) {
    return Finished{job.id, std::make_shared<Result<TrainedModel>>(
                                read_and_train(*job.source, unit, options, basis))};
  });
  flow::sequencer_node<Finished> in_order(graph,
                                          [](const Finished& finished) { return finished.id; });
  flow::function_node<Finished> write(graph, flow::serial, [&](const Finished& finished) {
    if (failed) return flow::continue_msg{};
    Result<TrainedModel>& trained = *finished.trained;
    if (!trained) {
      fault = trained.error();
      failed = true;
    } else if (const Result<void> added = writer->add(trained->model); !added) {
      failure = added.error();
      failed = true;
    } else {
      stats.models.emplace_back(trained->model.name, std::move(trained->stats));
      progress(finished.id + 1, order.size(), trained->model.name);
    }
    return flow::continue_msg{};
  });
  flow::make_edge(jobs, gate);
  flow::make_edge(gate, train);
  flow::make_edge(train, in_order);
  flow::make_edge(in_order, write);
  flow::make_edge(write, gate.decrementer());
  jobs.activate();
  graph.wait_for_all();

  if (failure) return *failure;
  if (fault) {
    const auto later = std::span(std::as_const(order)).subspan(stats.models.size() + 1);
    std::vector<Error> faults = find_faults(later, unit, options, progress.stop);
    faults.insert(faults.begin(), *fault);
    return join_faults(faults, order.size());
  }
  if (stats.models.size() < order.size()) {
    return Error{ErrorCode::resumable,
                 fmt::format("{}: stopped after {} of {} models; nothing was written",
                             file.string(), stats.models.size(), order.size())};
  }
  if (const Result<void> indexed = engine::add_index(*writer); !indexed) return indexed.error();
  if (const Result<void> published = writer->publish(); !published) return published.error();
  stats.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return stats;
}

}  // namespace trivet
