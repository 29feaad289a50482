/// The routes of the service.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/service/http/access.hpp"
#include "apps/service/serve/routes/example_routes.hpp"
#include "apps/service/serve/routes/inference_routes.hpp"
#include "apps/service/serve/routes/library_routes.hpp"
#include "apps/service/serve/routes/live_routes.hpp"
#include "apps/service/serve/routes/page_routes.hpp"
#include "apps/service/serve/routes/part_routes.hpp"
#include "apps/service/serve/routes/recognition_routes.hpp"
#include "apps/service/serve/routes/session_routes.hpp"
#include "apps/service/serve/routes/status_routes.hpp"

namespace trivet::apps::service {

/// Optional resources of a service. null, empty: not requested.
struct ServiceResources {
  std::vector<Example> examples{};
  ReloadLibrary reload{};
  PartWorkshop* workshop = nullptr;  ///< null: the library is read-only
  const LiveScans* live = nullptr;
  Session* session = nullptr;
};

/// Dispatches each request to the resource whose route matches. All members may be called from any
/// thread.
class ServiceRoutes {
 public:
  /// All arguments given by reference or pointer outlive the routes.
  ServiceRoutes(RecognitionService& service, Metrics& metrics, RequestLog& log,
                const RouteOptions& options, ServiceResources resources);
  ServiceRoutes(const ServiceRoutes&) = delete;
  ServiceRoutes& operator=(const ServiceRoutes&) = delete;

  void handle(HttpRequest request, HttpAnswer answer);
  /// Refuses work before its body is read if no more is accepted.
  std::optional<HttpResponse> admit(std::string_view target, std::size_t body_bytes);
  /// Whether a target needs no token: the liveness check, and the page, which asks for the token.
  static bool is_free(std::string_view target);
  void count_refused(AccessFault fault) { metrics_.count_refused(fault); }
  void set_ready(bool ready) { is_ready_ = ready; }
  void set_num_connections(std::function<std::size_t()> num) {
    status_.set_num_connections(std::move(num));
  }

 private:
  void refuse_change(const CallPtr& call);

  const RecognitionService& service_;
  Metrics& metrics_;
  const RouteOptions options_;
  std::atomic<bool> is_ready_{false};
  const Responder responder_;
  const RecognitionRoutes recognition_;
  LibraryRoutes library_;
  const PartRoutes parts_;
  const LiveRoutes live_;
  const ExampleRoutes examples_;
  const SessionRoutes session_;
  StatusRoutes status_;
  InferenceRoutes inference_;
  const PageRoutes page_;
  Routes routes_;  // routes of all resources
};

}  // namespace trivet::apps::service
