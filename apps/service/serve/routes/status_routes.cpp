#include "apps/service/serve/routes/status_routes.hpp"

#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {

Routes StatusRoutes::routes() const {
  using std::bind_front;
  return {
      {"GET", "/v2", false, false, Effect::reads, "server",
       bind_front(&StatusRoutes::server, this)},
      {"GET", "/v2/health/live", false, false, Effect::reads, "live",
       bind_front(&StatusRoutes::live, this)},
      {"GET", "/v2/health/ready", false, false, Effect::reads, "ready",
       bind_front(&StatusRoutes::ready, this)},
      {"GET", "/metrics", false, false, Effect::reads, "metrics",
       bind_front(&StatusRoutes::metrics, this)},
  };
}

void StatusRoutes::server(const CallPtr& call, std::string_view) const {
  responder_.reply(
      call,
      json_response(200, {{"name", "trivet"},
                          {"version", TRIVET_VERSION},
                          {"extensions", nlohmann::ordered_json::array(
                                             {"binary_tensor_data", "model_configuration",
                                              "schedule_policy", "sequence", "statistics"})}}));
}

void StatusRoutes::live(const CallPtr& call, std::string_view) const {
  const bool live = !service_.state().is_stuck;
  responder_.reply(call, json_response(live ? 200 : 503, {{"live", live}}));
}

void StatusRoutes::ready(const CallPtr& call, std::string_view) const {
  const bool ready = is_ready_ && !service_.state().is_stuck &&
                     !service_.generation()->recognizer.library().is_changed();
  responder_.reply(call, json_response(ready ? 200 : 503, {{"ready", ready}}));
}

void StatusRoutes::metrics(const CallPtr& call, std::string_view) const {
  const ServiceState state = service_.state();
  const auto generation = service_.generation();
  const Library& library = generation->recognizer.library();
  responder_.reply(
      call, metrics_.response({state.num_waiting, state.num_running, state.num_bytes,
                               num_connections_ ? num_connections_() : 0, library.models.size(),
                               library.file_bytes, library.is_changed() ? 1U : 0U,
                               generation->number, log_.num_dropped()}));
}

}  // namespace trivet::apps::service
