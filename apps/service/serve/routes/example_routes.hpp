/// Routes of the example scans.
#pragma once

#include <utility>
#include <vector>

#include "apps/service/serve/requests/examples.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"

namespace trivet::apps::service {

class ExampleRoutes {
 public:
  /// responder  outlives the object
  ExampleRoutes(const Responder& responder, std::vector<Example> examples)
      : responder_(responder), examples_(std::move(examples)) {}
  Routes routes() const;

 private:
  void view(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  const std::vector<Example> examples_;
};

}  // namespace trivet::apps::service
