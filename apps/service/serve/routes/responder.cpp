#include "apps/service/serve/routes/responder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "apps/service/http/http_messages.hpp"
#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps::service {

void Responder::run(const CallPtr& call, ServiceJob job,
                    std::function<HttpResponse(const ServiceAnswer&)> write,
                    std::function<void(const ServiceAnswer&)> note) const {
  if (job.part_bytes > options_.max_working_bytes) return refuse_large(call, job.part_bytes);
  job.num_bytes += call->num_bytes;
  job.is_gone = [call] { return call->is_overdue() || call->request.is_gone(); };
  const Result<ServiceClock::time_point> deadline =
      deadline_of(call->request, call->begun, options_.default_deadline);
  if (!deadline) return reply(call, error_response(deadline.error()));
  job.deadline = *deadline;
  const auto response = std::make_shared<HttpResponse>();
  job.conclude = [response, write = std::move(write)](const ServiceAnswer& answer) {
    *response = write(answer);
  };
  const std::size_t num_parts = job.num_parts;
  service_.submit(std::move(job), [this, call, response, num_parts,
                                   note = std::move(note)](const ServiceOutcome& outcome) {
    call->is_logged = true;
    if (const Refusal* const refusal = std::get_if<Refusal>(&outcome)) {
      const bool is_late = *refusal == Refusal::gone && call->is_overdue();
      return refuse(call, is_late ? Refusal::too_late : *refusal);
    }
    if (const Error* const error = std::get_if<Error>(&outcome)) {
      call->log_fields["error"] = error->message;
      if (note) note_scenes(call, 0, num_parts);
      return reply(call, error_response(*error));
    }
    const ServiceAnswer& answer = std::get<ServiceAnswer>(outcome);
    call->log_fields["generation"] = answer.generation->number;
    call->log_fields["queue_seconds"] = answer.queue_seconds;
    call->log_fields["work_seconds"] = answer.work_seconds;
    if (note) note(answer);
    reply(call, std::move(*response));
  });
}

void Responder::run_small(const CallPtr& call,
                          std::function<Result<HttpResponse>(const LibraryGeneration&)> work,
                          std::size_t part_bytes) const {
  const auto response = std::make_shared<HttpResponse>();
  ServiceJob job;
  job.part_bytes = part_bytes;
  job.work = [work = std::move(work), response](std::size_t, const LibraryGeneration& generation,
                                                const std::stop_token&) -> Result<void> {
    const FailWithoutMemory scope;
    const Library& library = generation.recognizer.library();
    TRIVET_TRY(library.unchanged());
    Result<HttpResponse> done = work(generation);
    TRIVET_TRY(library.unchanged());
    if (!done) return done.error();
    *response = std::move(*done);
    return {};
  };
  run(call, std::move(job), [response](const ServiceAnswer&) { return std::move(*response); });
}

std::function<void(const Result<void>&)> Responder::reply_generation(const CallPtr& call) const {
  return [this, call](const Result<void>& done) {
    if (done)
      return reply(call, json_response(200, {{"generation", service_.generation()->number}}));
    const bool is_full = done.error().code == ErrorCode::no_space;
    reply(call, is_full ? error_response(done.error()) : error_response(409, done.error().message));
  };
}

void Responder::note_recognition(const CallPtr& call, const ServiceAnswer& answer,
                                 std::span<const SceneResult> results,
                                 std::span<const std::optional<Error>> failures) const {
  std::size_t num_detections = 0;
  for (const SceneResult& result : results) {
    num_detections += result.detections.size();
    for (const auto& [stage, seconds] : result.stats.times.seconds)
      metrics_.observe_stage(stage, seconds);
  }
  metrics_.observe_queue(answer.queue_seconds);
  metrics_.observe_request(call->seconds());
  const auto num_failed = static_cast<std::size_t>(
      std::ranges::count_if(failures, [](const auto& failure) { return failure.has_value(); }));
  note_scenes(call, results.size() - num_failed, num_failed);
  call->log_fields["detections"] = num_detections;
}

void Responder::note_scenes(const CallPtr& call, std::size_t num_recognized,
                            std::size_t num_failed) const {
  metrics_.count_scenes(num_recognized, num_failed);
  call->log_fields["scenes"] = num_recognized;
  call->log_fields["failed_scenes"] = num_failed;
}

void Responder::refuse(const CallPtr& call, Refusal refusal) const {
  metrics_.count_rejection(std::string(reason_of(refusal)));
  call->log_fields["refusal"] = reason_of(refusal);
  reply(call, refusal_response(refusal));
}

void Responder::refuse_large(const CallPtr& call, std::size_t part_bytes) const {
  constexpr std::size_t kMb = 1 << 20;
  metrics_.count_rejection(std::string(reason_of(Refusal::too_large)));
  reply(call, error_response(413, fmt::format("expected scenes that need at most {} MB each, all "
                                              "that scenes may take, found one that may need {} "
                                              "MB by the size that it states; send fewer points, "
                                              "or serve with a larger --memory",
                                              options_.max_working_bytes / kMb,
                                              (part_bytes + kMb - 1) / kMb)));
}

}  // namespace trivet::apps::service
