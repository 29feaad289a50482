#include "apps/service/serve/requests/metrics.hpp"

#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {
namespace {

/// In the order of the stages of a scene.
constexpr const char* kStages[]{"decode",       "prepare",   "subsample",   "vote",   "match",
                                "cluster",      "preselect", "refine",      "verify", "examine",
                                "alternatives", "select",    "check camera"};

}  // namespace

Metrics::Metrics()
    : rejections_(counters("trivet_rejected_total", "Recognitions not done.")),
      reloads_(counters("trivet_reload_total", "Libraries reloaded.")),
      scenes_(counters("trivet_scenes_total", "Scenes of recognitions that ended, by outcome.")),
      stages_(durations("trivet_stage_duration_seconds", "Of a scene, by stage.")),
      queue_(duration_of(
          durations("trivet_queue_wait_seconds", "Of recognitions, before they begin."), {})) {
  for (const Refusal refusal : {Refusal::full, Refusal::too_large, Refusal::too_late, Refusal::gone,
                                Refusal::closed, Refusal::no_memory})
    rejections_.Add({{"reason", std::string(reason_of(refusal))}});
  for (const char* const result : {"good", "bad"}) reloads_.Add({{"result", result}});
  for (const char* const result : {"recognized", "failed"}) scenes_.Add({{"result", result}});
  for (const char* const stage : kStages) duration_of(stages_, {{"stage", stage}});
}

void Metrics::count_rejection(const std::string& reason) {
  rejections_.Add({{"reason", reason}}).Increment();
}

void Metrics::count_reload(bool good) {
  reloads_.Add({{"result", good ? "good" : "bad"}}).Increment();
}

void Metrics::count_scenes(std::size_t num_recognized, std::size_t num_failed) {
  scenes_.Add({{"result", "recognized"}}).Increment(static_cast<double>(num_recognized));
  scenes_.Add({{"result", "failed"}}).Increment(static_cast<double>(num_failed));
}

void Metrics::observe_queue(double seconds) { queue_.Observe(seconds); }

void Metrics::observe_stage(const std::string& stage, double seconds) {
  duration_of(stages_, {{"stage", stage}}).Observe(seconds);
}

HttpResponse Metrics::response(const Gauges& gauges) const {
  return RequestMetrics::response({
      gauge_now("trivet_queue_depth", "Recognitions that wait.", gauges.waiting),
      gauge_now("trivet_inflight", "Recognitions that run.", gauges.running),
      gauge_now("trivet_queue_bytes", "Of recognitions that wait and run.", gauges.queue_bytes),
      gauge_now("trivet_connections", "Open connections.", gauges.connections),
      gauge_now("trivet_library_models", "Models of the library.", gauges.library_models),
      gauge_now("trivet_library_bytes", "Size of the library's file.", gauges.library_bytes),
      gauge_now("trivet_library_changed",
                "Whether others changed its file in place, so that nothing is answered from it.",
                gauges.library_changed),
      gauge_now("trivet_library_generation", "Of the library that answers, from 1.",
                gauges.generation),
      counter_now("trivet_log_dropped_total", "Lines of the log that nobody read.",
                  gauges.dropped_lines),
  });
}

}  // namespace trivet::apps::service
