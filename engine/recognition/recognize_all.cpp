#include <fmt/format.h>
#include <tbb/flow_graph.h>

#include <chrono>
#include <exception>
#include <memory>
#include <new>

#include "engine/common/parallel.hpp"
#include "engine/recognition/recognize.hpp"
#include "engine/results/stage_times.hpp"
#include "storage/common/stop.hpp"

namespace trivet {
namespace {

namespace flow = tbb::flow;

/// Scenes in memory at once. One is read while another is recognized; more would only add latency.
constexpr std::size_t kScenesInFlight = 2;

struct Finished {
  std::size_t id = 0;
  std::shared_ptr<Result<SceneResult>> result;
};

/// Whether an error concerns one scene only.
bool is_of_one_scene(const Error& error) {
  return error.code != ErrorCode::usage && error.code != ErrorCode::resumable &&
         error.code != ErrorCode::changed;
}

/// Exceptions must not reach the flow graph, since they would end its other scenes too.
Result<SceneResult> read_and_recognize(const Recognizer& recognizer, const SceneInput& input,
                                       const RecognizeOptions& options,
                                       const std::stop_token& stop) try {
  const auto start = std::chrono::steady_clock::now();
  const StopScope scope(&stop);
  const Result<Cloud> cloud = read_scene(input);
  if (!cloud) return cloud.error();
  const double read_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Result<SceneResult> result = recognize(recognizer, *cloud, input, options, stop);
  if (result) {
    StageTimes times;
    times.add("read", read_seconds);
    times.seconds.insert(times.seconds.end(), result->stats.times.seconds.begin(),
                         result->stats.times.seconds.end());
    result->stats.times = std::move(times);
    result->stats.total_seconds += read_seconds;
  }
  return result;
} catch (const Stopped&) {
  return Error{ErrorCode::resumable, "stopped on request"};
} catch (const std::bad_alloc&) {
  return Error{ErrorCode::no_memory, fmt::format("{}: {}", input.file.string(), kOutOfMemory)};
} catch (const std::exception& error) {
  return Error{ErrorCode::internal,
               fmt::format("{}: internal: {}; please report it with the scene and the library",
                           input.file.string(), error.what())};
}

}  // namespace

Result<void> recognize_all(const Recognizer& recognizer, std::span<const SceneInput> scenes,
                           const RecognizeOptions& options, const Progress& progress,
                           const std::function<void(std::size_t index, const SceneResult&)>& emit,
                           const std::function<void(std::size_t index, const Error&)>& fail) {
  TRIVET_TRY(validate(options));
  std::optional<Error> failure;
  std::size_t emitted = 0, next = 0;
  flow::graph graph;
  flow::input_node<std::size_t> jobs(graph, [&](tbb::flow_control& control) {
    if (next == scenes.size() || progress.stop.stop_requested()) {
      control.stop();
      return std::size_t{0};
    }
    return next++;
  });
  flow::limiter_node<std::size_t> gate(graph, kScenesInFlight);
  flow::function_node<std::size_t, Finished> work(graph, flow::unlimited, [&](std::size_t id) {
    return Finished{id, std::make_shared<Result<SceneResult>>(
                            read_and_recognize(recognizer, scenes[id], options, progress.stop))};
  });
  flow::sequencer_node<Finished> in_order(graph,
                                          [](const Finished& finished) { return finished.id; });
  flow::function_node<Finished> deliver(graph, flow::serial, [&](const Finished& finished) {
    if (failure) return flow::continue_msg{};
    const Result<SceneResult>& result = *finished.result;
    const bool is_of_scene = result || is_of_one_scene(result.error());
    if (!result && !(fail && is_of_scene)) {
      failure = result.error();
      return flow::continue_msg{};
    }
    if (result) {
      emit(finished.id, *result);
    } else {
      fail(finished.id, result.error());
    }
    ++emitted;
    progress(emitted, scenes.size(), scenes[finished.id].file.filename().string());
    return flow::continue_msg{};
  });
  flow::make_edge(jobs, gate);
  flow::make_edge(gate, work);
  flow::make_edge(work, in_order);
  flow::make_edge(in_order, deliver);
  flow::make_edge(deliver, gate.decrementer());
  jobs.activate();
  graph.wait_for_all();

  if (failure) return *failure;
  if (emitted < scenes.size()) {
    return Error{ErrorCode::resumable,
                 fmt::format("stopped after {} of {} scenes", emitted, scenes.size())};
  }
  return {};
}

}  // namespace trivet
