/// Routes that change the library: upload, training and publication of parts, and removal of
/// models.
#pragma once

#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"
#include "apps/service/serve/workshop/part_workshop.hpp"

namespace trivet::apps::service {

class PartRoutes {
 public:
  /// responder  outlives the object, as does the workshop
  /// workshop   null: the library is read-only
  PartRoutes(const Responder& responder, PartWorkshop* workshop)
      : responder_(responder), workshop_(workshop) {}
  Routes routes() const;

 private:
  void list_parts(const CallPtr& call, std::string_view rest) const;
  void view_part(const CallPtr& call, std::string_view rest) const;
  void bring_part(const CallPtr& call, std::string_view rest) const;
  void declare_part(const CallPtr& call, std::string_view rest) const;
  void drop_part(const CallPtr& call, std::string_view rest) const;
  void publish_part(const CallPtr& call, std::string_view rest) const;
  void remove_model(const CallPtr& call, std::string_view rest) const;
  void rename_model(const CallPtr& call, std::string_view rest) const;
  /// Whether there is a workshop. Sends the response if there is none.
  bool has_workshop(const CallPtr& call) const;

  const Responder& responder_;
  PartWorkshop* const workshop_;
};

}  // namespace trivet::apps::service
