#include <tbb/flow_graph.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <tuple>
#include <utility>

#include "engine/training/model_stages.hpp"
#include "engine/training/provenance.hpp"
#include "engine/training/standard_basis.hpp"
#include "engine/training/training_parts.hpp"
#include "engine/training/training_run.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

namespace flow = tbb::flow;
using engine::ModelInTraining;

/// Maximum number of models in memory. It is large enough to keep the threads busy while some
/// models are read and written, and independent of the library's size.
std::size_t models_in_flight() {
  return std::max<std::size_t>(4, 2 * std::thread::hardware_concurrency());
}

struct Item {
  std::size_t id = 0;  // rising
  TrainingJob job;
  ModelInTraining model;
  std::string source_xxh3;
  std::optional<Error> fault;

  bool goes_on() const { return !fault && !job.check_only; }
};
/// Shared, since two branches of the graph work on it, each on separate members.
using ItemPtr = std::shared_ptr<Item>;

void read_and_survey(const TrainingWork& work, Item& item) {
  const ModelSource& source = work.sources[item.job.source];
  const Result<Cloud> surface = [&]() -> Result<Cloud> {
    const StageTimer timer(item.model.times, "read");
    TRIVET_TRY_ASSIGN(const std::vector<std::byte> bytes,
                      read_file(source.file, ReadOptions{}.max_file_bytes));
    item.source_xxh3 = xxh3_hex(bytes);
    return read_cloud(source.file, {.unit = work.unit, .keep_origin = true});
  }();
  const Result<void> good =
      surface ? engine::survey(*surface, source, work.options, item.model) : surface.error();
  if (!good) item.fault = good.error();
}

}  // namespace

Result<void> train_models(const TrainingWork& work,
                          const std::function<std::optional<TrainingJob>()>& next,
                          const std::function<Result<PackedModels>(JobOutcome)>& done,
                          const std::stop_token& stop) {
  const TriSpinBasis basis = engine::standard_basis(work.options);
  engine::PartWriter parts(engine::parts_folder(work.file),
                           engine::library_header(work.unit, work.options), basis, work.writer);
  const auto source_of = [&](const ItemPtr& item) -> const ModelSource& {
    return work.sources[item->job.source];
  };
  std::optional<Error> failure;  // error of writing
  std::atomic<bool> failed{false};
  std::size_t num_items = 0;
  flow::graph graph;

  // Items that are no longer processed also pass through all nodes.
  flow::input_node<ItemPtr> jobs(graph, [&](tbb::flow_control& control) {
    const auto item = std::make_shared<Item>();
    const std::optional<TrainingJob> job = failed || stop.stop_requested() ? std::nullopt : next();
    if (!job) {
      control.stop();
      return item;
    }
    item->id = num_items++;
    item->job = *job;
    return item;
  });
  flow::limiter_node<ItemPtr> gate(graph, models_in_flight());
  const auto stage = [&](auto&& body) {
    return flow::function_node<ItemPtr, ItemPtr>(graph, flow::unlimited,
                                                 [body](const ItemPtr& item) {
                                                   body(item);
                                                   return item;
                                                 });
  };
  auto survey = stage([&](const ItemPtr& item) { read_and_survey(work, *item); });
  auto symmetries = stage([&](const ItemPtr& item) {
    if (item->goes_on()) engine::find_symmetries(source_of(item), item->model);
  });
  auto pairs = stage([&](const ItemPtr& item) {
    if (item->goes_on()) engine::pair_up(source_of(item), work.options, item->model);
  });
  auto supports = stage([&](const ItemPtr& item) {
    if (item->goes_on()) engine::gather_supports(basis, item->model);
  });
  auto descriptions = stage([&](const ItemPtr& item) {
    if (item->goes_on()) engine::describe(basis, item->model);
  });
  const auto id_of = [](const ItemPtr& item) { return item->id; };
  flow::join_node<std::tuple<ItemPtr, ItemPtr>, flow::key_matching<std::size_t>> both(graph, id_of,
                                                                                      id_of);
  flow::function_node<std::tuple<ItemPtr, ItemPtr>> write(
      graph, flow::serial, [&](const std::tuple<ItemPtr, ItemPtr>& joined) {
        Item& item = *std::get<0>(joined);
        if (item.model.pair_fault) item.fault = item.model.pair_fault;
        if (failed) return flow::continue_msg{};
        const auto fail = [&](const Error& error) {
          failure = error;
          failed = true;
          return flow::continue_msg{};
        };
        JobOutcome outcome{item.job.source, item.fault, {}, {}, {}};
        if (item.goes_on()) {
          const ModelSource& source = work.sources[item.job.source];
          TrainedModel trained = engine::finish(source, std::move(item.model));
          trained.model.source_xxh3 = item.source_xxh3;
          trained.model.fingerprint =
              engine::fingerprint_of(source, item.source_xxh3, work.unit, work.options);
          Result<std::shared_ptr<PackedModel>> packed =
              pack_model(trained.model, work.unit, basis.components.size());
          if (!packed) return fail(packed.error());
          outcome.model = std::move(*packed);
          outcome.times = std::move(trained.stats.times);
          outcome.warnings = std::move(trained.stats.warnings);
        }
        const Result<PackedModels> rest = done(std::move(outcome));
        if (!rest) return fail(rest.error());
        for (const std::shared_ptr<PackedModel>& model : *rest) {
          if (const Result<void> kept = parts.add(*model); !kept) return fail(kept.error());
        }
        return flow::continue_msg{};
      });

  flow::make_edge(jobs, gate);
  flow::make_edge(gate, survey);
  flow::make_edge(survey, symmetries);
  flow::make_edge(symmetries, pairs);
  flow::make_edge(survey, supports);
  flow::make_edge(supports, descriptions);
  flow::make_edge(pairs, flow::input_port<0>(both));
  flow::make_edge(descriptions, flow::input_port<1>(both));
  flow::make_edge(both, write);
  flow::make_edge(write, gate.decrementer());
  jobs.activate();
  graph.wait_for_all();

  const Result<void> closed = parts.close();
  if (failure) return *failure;
  return closed;
}

}  // namespace trivet
