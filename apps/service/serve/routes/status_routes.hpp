/// Routes for liveness, readiness and metrics.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>

#include "apps/service/common/request_log.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"
#include "engine/recognition/recognition_service.hpp"

namespace trivet::apps::service {

class StatusRoutes {
 public:
  /// All arguments outlive the object.
  ///
  /// is_ready  whether load balancers may send requests
  StatusRoutes(const Responder& responder, const RecognitionService& service,
               const Metrics& metrics, const RequestLog& log, const std::atomic<bool>& is_ready)
      : responder_(responder),
        service_(service),
        metrics_(metrics),
        log_(log),
        is_ready_(is_ready) {}
  Routes routes() const;
  /// Sets the source of the number of open connections. Call it before any request.
  void set_num_connections(std::function<std::size_t()> num) { num_connections_ = std::move(num); }

 private:
  void server(const CallPtr& call, std::string_view rest) const;
  void live(const CallPtr& call, std::string_view rest) const;
  void ready(const CallPtr& call, std::string_view rest) const;
  void metrics(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  const RecognitionService& service_;
  const Metrics& metrics_;
  const RequestLog& log_;
  const std::atomic<bool>& is_ready_;
  std::function<std::size_t()> num_connections_;
};

}  // namespace trivet::apps::service
