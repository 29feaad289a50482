#include "apps/service/serve/service_routes.hpp"

#include <fmt/format.h>

#include <iterator>
#include <memory>
#include <string>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/routes/page.hpp"

namespace trivet::apps::service {
namespace {

/// All routes in their order. The first that matches a request answers it.
Routes joined(std::vector<Routes> resources) {
  Routes all;
  for (Routes& routes : resources) std::ranges::move(routes, std::back_inserter(all));
  return all;
}

/// The path of a target, without decoding.
std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

}  // namespace

ServiceRoutes::ServiceRoutes(RecognitionService& service, Metrics& metrics, RequestLog& log,
                             const RouteOptions& options, ServiceResources resources)
    : service_(service),
      metrics_(metrics),
      options_(options),
      responder_(service, metrics, log, options),
      recognition_(responder_, metrics),
      library_(responder_, service, std::move(resources.reload)),
      parts_(responder_, resources.workshop),
      live_(responder_, resources.live),
      examples_(responder_, std::move(resources.examples)),
      session_(responder_, resources.session),
      status_(responder_, service, metrics, log, is_ready_),
      inference_(responder_, service, is_ready_),
      page_(responder_),
      routes_(joined({recognition_.routes(), library_.routes(), parts_.routes(), live_.routes(),
                      examples_.routes(), session_.routes(), status_.routes(), inference_.routes(),
                      page_.routes()})) {
  for (const Route& route : routes_) {
    const std::string name(route.name);
    if (route.is_work) {
      metrics_.expect_requests(name, kCodesOfWork);
    } else {
      metrics_.expect_requests(name, kUsualCodes);
    }
  }
  metrics_.expect_requests("other", kCodesOfOthers);
}

void ServiceRoutes::handle(HttpRequest request, HttpAnswer answer) {
  const auto call = std::make_shared<Call>(std::move(request), std::move(answer));
  Result<Target> target = parse_target(call->request.target);
  if (!target) return responder_.reply(call, error_response(target.error()));
  call->target = std::move(*target);
  const std::string& path = call->target.path;
  std::string other_methods;
  for (const Route& route : routes_) {
    if (route.is_prefix ? !path.starts_with(route.path) : path != route.path) continue;
    if (route.method != call->request.method) {
      if (route.path == "/") continue;
      if (!other_methods.empty()) other_methods += ", ";
      other_methods += route.method;
      continue;
    }
    if (!other_methods.empty() && route.path == "/") break;
    call->route = route.name;
    if (route.effect == Effect::changes && options_.read_only) return refuse_change(call);
    return route.handle(call, std::string_view(path).substr(route.path.size()));
  }
  if (other_methods.empty()) return responder_.reply(call, error_response(404, "no such path"));
  responder_.reply(call, method_response(other_methods, call->request));
}

void ServiceRoutes::refuse_change(const CallPtr& call) {
  count_refused(AccessFault::read_only);
  call->log_fields["refusal"] = name_of(AccessFault::read_only);
  responder_.reply(call, error_response(403,
                                        "expected a service without --read-only: this one "
                                        "recognizes, and changes nothing"));
}

bool ServiceRoutes::is_free(std::string_view target) {
  const std::string_view path = path_of(target);
  return path == "/v2/health/live" || path == "/v2/health/ready" || path == "/" ||
         (path.starts_with('/') && find_page_file(path.substr(1)));
}

std::optional<HttpResponse> ServiceRoutes::admit(std::string_view target, std::size_t body_bytes) {
  const std::string_view path = path_of(target);
  for (const Route& route : routes_) {
    if (!route.is_work || !path.starts_with(route.path)) continue;
    if (body_bytes > options_.max_waiting_bytes) {
      return error_response(413, fmt::format("expected a body of at most {} bytes, found {}",
                                             options_.max_waiting_bytes, body_bytes));
    }
    if (!service_.is_full(body_bytes)) return std::nullopt;
    metrics_.count_rejection(std::string(reason_of(Refusal::full)));
    metrics_.count_request(std::string(route.name), 503);
    return refusal_response(Refusal::full);
  }
  return std::nullopt;
}

}  // namespace trivet::apps::service
