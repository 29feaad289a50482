/// Responses to calls, at once or by jobs of the recognition service.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "apps/service/http/call.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct RouteOptions {
  std::chrono::milliseconds default_deadline{10'000};  ///< deadline of a recognition
  std::size_t max_waiting_bytes = 0;  ///< bound of the queue: bytes of waiting requests
  std::size_t max_working_bytes = 0;  ///< bound on the memory of scenes being recognized
  bool read_only = false;             ///< no change over HTTP is allowed
};

/// All members may be called from any thread.
class Responder {
 public:
  /// All arguments outlive the object.
  Responder(RecognitionService& service, Metrics& metrics, RequestLog& log,
            const RouteOptions& options)
      : service_(service), metrics_(metrics), replies_(metrics, log), options_(options) {}

  void reply(const CallPtr& call, HttpResponse response) const {
    replies_.send(*call, std::move(response));
  }

  /// Runs a job, then sends the response that `write` makes of its result, or the refusal or error.
  /// `write` is part of the work, which may still run after a response was sent: it does not touch
  /// the call. `note` counts and logs the response. Jobs with one are recognitions: each part is a
  /// scene, and an error is one of them all.
  void run(const CallPtr& call, ServiceJob job,
           std::function<HttpResponse(const ServiceAnswer&)> write,
           std::function<void(const ServiceAnswer&)> note = {}) const;
  /// Runs a small job: `work` returns the response.
  ///
  /// part_bytes  memory that it needs in addition to the body
  void run_small(const CallPtr& call,
                 std::function<Result<HttpResponse>(const LibraryGeneration&)> work,
                 std::size_t part_bytes = 0) const;

  /// The completion of a change of the library: responds with the generation that answers then.
  std::function<void(const Result<void>&)> reply_generation(const CallPtr& call) const;

  /// Counts an answered recognition and logs its detections.
  ///
  /// failures  errors of single scenes, by scene; empty: none failed
  void note_recognition(const CallPtr& call, const ServiceAnswer& answer,
                        std::span<const SceneResult> results,
                        std::span<const std::optional<Error>> failures = {}) const;

 private:
  void note_scenes(const CallPtr& call, std::size_t num_recognized, std::size_t num_failed) const;
  void refuse(const CallPtr& call, Refusal refusal) const;
  void refuse_large(const CallPtr& call, std::size_t part_bytes) const;

  RecognitionService& service_;
  Metrics& metrics_;
  const Replies replies_;
  const RouteOptions options_;
};

}  // namespace trivet::apps::service
