/// Answers to calls, at once or by jobs of the recognition service.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>

#include "apps/service/http/call.hpp"
#include "apps/service/http/http_server.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct RouteOptions {
  std::chrono::milliseconds default_deadline{10'000};  ///< of a recognition
  std::size_t max_waiting_bytes = 0;                   ///< that the service takes
  std::size_t max_working_bytes = 0;                   ///< that scenes at work may need
  bool read_only = false;                              ///< nobody changes anything over HTTP
};

/// All members may be called from any thread.
class Responder {
 public:
  /// All that is given outlives it.
  Responder(RecognitionService& service, Metrics& metrics, RequestLog& log,
            const RouteOptions& options)
      : service_(service), metrics_(metrics), replies_(metrics, log), options_(options) {}

  void reply(const CallPtr& call, HttpResponse response) const {
    replies_.send(*call, std::move(response));
  }

  /// Answer with what `write` makes of the job's answer, or with the refusal or error. `write` is
  /// part of the work, which may be answered for meanwhile: it leaves the call alone. `note` counts
  /// and logs what is answered.
  void run(const CallPtr& call, ServiceJob job,
           std::function<HttpResponse(const ServiceAnswer&)> write,
           std::function<void(const ServiceAnswer&)> note = {}) const;
  /// Run a small job: `work` gives the answer.
  ///
  /// part_bytes  that it needs beside the body
  void run_small(const CallPtr& call,
                 std::function<Result<HttpResponse>(const LibraryGeneration&)> work,
                 std::size_t part_bytes = 0) const;

  /// For a change of the library: answers, once it is done, with the generation that answers then.
  std::function<void(const Result<void>&)> reply_generation(const CallPtr& call) const;

  /// Count a recognition that is answered, and log what it found.
  void note_recognition(const CallPtr& call, const ServiceAnswer& answer,
                        std::span<const SceneResult> results) const;

 private:
  void refuse(const CallPtr& call, Refusal refusal) const;
  void refuse_large(const CallPtr& call, std::size_t part_bytes) const;

  RecognitionService& service_;
  Metrics& metrics_;
  const Replies replies_;
  const RouteOptions options_;
};

}  // namespace trivet::apps::service
