/// The page of the service, and the description of what it offers.
#pragma once

#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class PageRoutes {
 public:
  /// responder  outlives it
  explicit PageRoutes(const Responder& responder) : responder_(responder) {}
  /// The page is at every path that is nobody else's: its route comes last.
  Routes routes() const;

 private:
  void openapi(const CallPtr& call, std::string_view rest) const;
  void page(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
};

}  // namespace trivet::apps::service
