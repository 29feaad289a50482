/// Routes that recognize scans, show their points, and give detections to robots.
#pragma once

#include "apps/service/serve/requests/metrics.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class RecognitionRoutes {
 public:
  /// Both outlive the object.
  RecognitionRoutes(const Responder& responder, Metrics& metrics)
      : responder_(responder), metrics_(metrics) {}
  Routes routes() const;

 private:
  void recognize(const CallPtr& call, std::string_view rest) const;
  void points(const CallPtr& call, std::string_view rest) const;
  void robot_poses(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  Metrics& metrics_;
};

}  // namespace trivet::apps::service
