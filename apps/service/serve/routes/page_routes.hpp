/// Routes of the page of the service, of its OpenAPI description, and of the words of its answers.
#pragma once

#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class PageRoutes {
 public:
  /// responder  outlives the object
  explicit PageRoutes(const Responder& responder) : responder_(responder) {}
  /// The page answers every path that no other route answers: its route comes last.
  Routes routes() const;

 private:
  void openapi(const CallPtr& call, std::string_view rest) const;
  void words(const CallPtr& call, std::string_view rest) const;
  void page(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
};

}  // namespace trivet::apps::service
