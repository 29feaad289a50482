/// Routes of the results of a watched folder.
#pragma once

#include "apps/service/serve/live/live_scans.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class LiveRoutes {
 public:
  /// responder  outlives the object, as do scans
  /// scans      null: no folder is watched
  LiveRoutes(const Responder& responder, const LiveScans* scans)
      : responder_(responder), scans_(scans) {}
  Routes routes() const;

 private:
  void list_scans(const CallPtr& call, std::string_view rest) const;
  void view_scan(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  const LiveScans* const scans_;
};

}  // namespace trivet::apps::service
