#include "apps/service/http/call.hpp"

#include <utility>

#include "apps/service/http/http_messages.hpp"

namespace trivet::apps::service {

Call::Call(HttpRequest what, HttpAnswer whereto)
    : request(std::move(what)),
      answer(std::move(whereto)),
      id(request_id(request)),
      trace(trace_parent(request)),
      num_bytes(request.body.size()) {}

double Call::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

bool Call::is_overdue() const {
  const std::chrono::microseconds timeout = timeout_;
  return timeout.count() > 0 && std::chrono::steady_clock::now() - begun >= timeout;
}

void Call::set_timeout(std::chrono::microseconds timeout) { timeout_ = timeout; }

void Replies::send(const Call& call, HttpResponse response) const {
  metrics_.count_request(call.route, response.status);
  if (call.is_logged || response.status >= 400) log(call, response.status);
  response.headers.emplace_back("X-Request-Id", call.id);
  if (!call.trace.empty()) response.headers.emplace_back("traceparent", call.trace);
  call.answer(std::move(response));
}

void Replies::log(const Call& call, unsigned status) const {
  nlohmann::ordered_json fields{{"request_id", call.id},     {"method", call.request.method},
                                {"route", call.route},       {"code", status},
                                {"seconds", call.seconds()}, {"body_bytes", call.num_bytes}};
  if (!call.trace.empty()) fields["traceparent"] = call.trace;
  fields.update(call.log_fields);
  log_.write(status >= 500 ? "warning" : "info", "request", fields);
}

}  // namespace trivet::apps::service
