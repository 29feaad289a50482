// What came of the scans of a watched folder.
#include <fmt/format.h>

#include <optional>
#include <string>

#include "apps/service/http/file_response.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/service_routes.hpp"

namespace trivet::apps::service {

void ServiceRoutes::list_live(const CallPtr& call, std::string_view) {
  if (!commissioning_.live) return reply(call, json_response(200, {{"watched", false}}));
  const std::optional<std::string> given = call->target.parameter("after");
  const std::optional<std::size_t> after = whole_number(given.value_or("0"));
  if (!after) {
    return reply(call,
                 error_response(400, fmt::format("after: expected a number, found '{}'", *given)));
  }
  reply(call, json_response(200, {{"watched", true},
                                  {"epoch", commissioning_.live->epoch()},
                                  {"scans", commissioning_.live->tell(*after)}}));
}

void ServiceRoutes::view_live(const CallPtr& call, std::string_view rest) {
  const std::size_t slash = rest.find('/');
  const std::optional<std::size_t> number = whole_number(rest.substr(0, slash));
  const std::string_view what = slash == std::string_view::npos ? "" : rest.substr(slash + 1);
  if (!commissioning_.live || !number || (what != "answer" && what != "scan"))
    return reply(call, error_response(404, "expected answer or scan of a number of /v1/live"));
  if (what == "answer") {
    const auto answer = commissioning_.live->answer(*number);
    if (!answer) return reply(call, error_response(404, "no answer is kept of this scan"));
    return reply(call, {200, *answer, "application/json", {}});
  }
  const auto file = commissioning_.live->file(*number);
  if (!file)
    return reply(call,
                 error_response(404, "this scan is no longer kept, or its file was overwritten"));
  reply(call, file_response(*file));
}

}  // namespace trivet::apps::service
