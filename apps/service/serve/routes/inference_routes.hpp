/// Routes of the Open Inference Protocol.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>

#include "apps/service/serve/inference/statistics.hpp"
#include "apps/service/serve/routes/responder.hpp"
#include "apps/service/serve/routes/route.hpp"
#include "engine/recognition/recognition_service.hpp"

namespace trivet::apps::service {

class InferenceRoutes {
 public:
  /// All arguments outlive the object.
  ///
  /// is_ready  whether the library answers
  InferenceRoutes(const Responder& responder, const RecognitionService& service,
                  const std::atomic<bool>& is_ready)
      : responder_(responder), service_(service), is_ready_(is_ready) {}
  Routes routes();

 private:
  void repository(const CallPtr& call, std::string_view rest) const;
  void view_statistics(const CallPtr& call, std::string_view rest) const;
  void view_model(const CallPtr& call, std::string_view rest) const;
  void infer(const CallPtr& call, std::string_view rest);
  void count_failures(const CallPtr& call, std::uint64_t generation);

  const Responder& responder_;
  const RecognitionService& service_;
  const std::atomic<bool>& is_ready_;
  InferenceStatistics statistics_;
};

}  // namespace trivet::apps::service
