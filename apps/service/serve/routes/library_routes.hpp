/// Routes of the current library and its models.
#pragma once

#include <functional>

#include "apps/service/serve/library/model_views.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Calls back once the library was reloaded or the reload has failed.
using ReloadLibrary = std::function<void(std::function<void(Result<void>)>)>;

class LibraryRoutes {
 public:
  /// responder, service  outlive the object
  LibraryRoutes(const Responder& responder, const RecognitionService& service, ReloadLibrary reload)
      : responder_(responder), service_(service), reload_(std::move(reload)) {}
  Routes routes();

 private:
  void list_models(const CallPtr& call, std::string_view rest) const;
  void view_model(const CallPtr& call, std::string_view rest);
  void score_parts(const CallPtr& call, std::string_view rest) const;
  void reload(const CallPtr& call, std::string_view rest) const;

  const Responder& responder_;
  const RecognitionService& service_;
  const ReloadLibrary reload_;
  Thumbnails thumbnails_;
};

}  // namespace trivet::apps::service
