/// What the service answers to which request.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/serve/http_server.hpp"
#include "apps/serve/metrics.hpp"
#include "engine/recognition_service.hpp"
#include "storage/result.hpp"

namespace trivet::apps {

/// How a scene is to be read.
struct ServedScene {
  std::vector<double> camera;  ///< fx, fy, cx, cy, depth scale (1 if absent); or none
  std::vector<float> viewpoint;
  std::string unit;  ///< m or mm; empty: the library's
};

struct RouteOptions {
  std::chrono::milliseconds default_deadline{10'000};  ///< of a recognition
};

/// POST /v1/recognize; GET /v1/models; POST /v1/library/reload; the Open Inference Protocol:
/// GET /v2, /v2/health/live, /v2/health/ready, /v2/models/NAME[/versions/N][/ready], POST
/// .../infer; GET /metrics. Any member may be called from any thread.
class ServiceRoutes {
 public:
  /// Calls back once the library was read anew, or could not be.
  using Reload = std::function<void(std::function<void(Result<void>)>)>;
  /// All that is given outlives the routes.
  ServiceRoutes(RecognitionService& service, Metrics& metrics, const RouteOptions& options,
                Reload reload)
      : service_(service), metrics_(metrics), options_(options), reload_(std::move(reload)) {}

  void handle(HttpRequest request, HttpAnswer answer);
  void set_ready(bool ready) { is_ready_ = ready; }
  void set_num_connections(std::function<std::size_t()> num) { num_connections_ = std::move(num); }

 private:
  void recognise(HttpRequest request, HttpAnswer answer, const std::string& request_id);
  void infer(HttpRequest request, HttpAnswer answer);
  /// rest  of the path, behind /v2/models/
  void handle_model(std::string rest, HttpRequest request,
                    const std::function<HttpAnswer(const std::string& route)>& finish);
  /// Answer with what `write` makes of the result, or with the refusal or error.
  void submit(ServiceJob job, HttpAnswer answer,
              std::function<HttpResponse(const ServiceAnswer&)> write);
  /// By the header X-Deadline-Ms. Errors: usage.
  Result<ServiceClock::time_point> deadline_of(const HttpRequest& request) const;
  SceneInput input_of(const ServedScene& scene) const;
  HttpResponse models() const;
  HttpResponse metrics() const;

  RecognitionService& service_;
  Metrics& metrics_;
  RouteOptions options_;
  Reload reload_;
  std::function<std::size_t()> num_connections_;
  std::atomic<bool> is_ready_{false};
};

}  // namespace trivet::apps
