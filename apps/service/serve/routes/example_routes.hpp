/// Scans that the page offers to those who have none at hand.
#pragma once

#include <utility>
#include <vector>

#include "apps/service/serve/requests/examples.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class ExampleRoutes {
 public:
  /// responder  outlives it
  ExampleRoutes(const Responder& responder, std::vector<Example> examples)
      : responder_(responder), examples_(std::move(examples)) {}
  Routes routes() const;

 private:
  void view(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  const std::vector<Example> examples_;
};

}  // namespace trivet::apps::service
