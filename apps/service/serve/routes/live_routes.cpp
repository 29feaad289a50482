#include "apps/service/serve/routes/live_routes.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {
namespace {

nlohmann::ordered_json live_scan_json(const LiveScan& scan) {
  nlohmann::ordered_json error;
  if (!scan.error.empty()) error = scan.error;
  return {{"number", scan.number},
          {"name", scan.name},
          {"query", scan.query},
          {"time", scan.time},
          {"seconds", scan.seconds},
          {"detections", scan.num_detections},
          {"error", std::move(error)},
          {"url", fmt::format("/v1/live/{}/scan", scan.number)},
          {"answer", fmt::format("/v1/live/{}/answer", scan.number)}};
}

}  // namespace

Routes LiveRoutes::routes() const {
  using std::bind_front;
  return {
      {"GET", "/v1/live", false, false, Effect::reads, "live_scans",
       bind_front(&LiveRoutes::list_scans, this)},
      {"GET", "/v1/live/", true, false, Effect::reads, "live_scan",
       bind_front(&LiveRoutes::view_scan, this)},
  };
}

void LiveRoutes::list_scans(const CallPtr& call, std::string_view) const {
  if (!scans_) return responder_.reply(call, json_response(200, {{"watched", false}}));
  const std::optional<std::string> given = call->target.parameter("after");
  const std::optional<std::size_t> after = whole_number(given.value_or("0"));
  if (!after) {
    return responder_.reply(
        call, error_response(400, fmt::format("after: expected a number, found '{}'", *given)));
  }
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (const LiveScan& scan : scans_->scans_after(*after)) scans.push_back(live_scan_json(scan));
  responder_.reply(
      call, json_response(
                200, {{"watched", true}, {"epoch", scans_->epoch()}, {"scans", std::move(scans)}}));
}

void LiveRoutes::view_scan(const CallPtr& call, std::string_view rest) const {
  const std::size_t slash = rest.find('/');
  const std::optional<std::size_t> number = whole_number(rest.substr(0, slash));
  const std::string_view what = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (!scans_ || !number || (what != "answer" && what != "scan"))
    return responder_.reply(call,
                            error_response(404, "expected answer or scan of a number of /v1/live"));
  if (what == "answer") {
    const auto answer = scans_->answer(*number);
    if (!answer)
      return responder_.reply(call, error_response(404, "no answer is kept of this scan"));
    return responder_.reply(call, {200, *answer, "application/json", {}});
  }
  const auto file = scans_->file(*number);
  if (!file)
    return responder_.reply(
        call, error_response(404, "this scan is no longer kept, or its file was overwritten"));
  responder_.reply(call, file_response(*file));
}

}  // namespace trivet::apps::service
