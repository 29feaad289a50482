/// What the service answers to which request.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/call.hpp"
#include "apps/service/serve/inference/statistics.hpp"
#include "apps/service/serve/library/model_views.hpp"
#include "apps/service/serve/live/live_scans.hpp"
#include "apps/service/serve/requests/examples.hpp"
#include "apps/service/serve/requests/metrics.hpp"
#include "apps/service/serve/workshop/part_workshop.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

class Session;

struct RouteOptions {
  std::chrono::milliseconds default_deadline{10'000};  ///< of a recognition
  std::size_t max_waiting_bytes = 0;                   ///< that the service takes
  std::size_t max_working_bytes = 0;                   ///< that scenes at work may need
  bool read_only = false;                              ///< nobody changes anything over HTTP
};

/// What a service does beside recognition, for who commissions a cell; null: it was not asked to.
struct Commissioning {
  PartWorkshop* workshop = nullptr;  ///< without it the library is only read
  const LiveScans* live = nullptr;
  Session* session = nullptr;
};

/// All members may be called from any thread.
class ServiceRoutes {
 public:
  /// Calls back once the library was read anew, or could not be.
  using Reload = std::function<void(std::function<void(Result<void>)>)>;
  /// All that is given outlives the routes.
  ServiceRoutes(RecognitionService& service, Metrics& metrics, RequestLog& log,
                const RouteOptions& options, std::vector<Example> examples, Reload reload,
                Commissioning commissioning = {});

  void handle(HttpRequest request, HttpAnswer answer);
  /// What needs work is refused before its body is read where no more is taken.
  std::optional<HttpResponse> admit(std::string_view target, std::size_t body_bytes);
  /// What needs no token: whether the service lives, and the page, which asks for one.
  static bool is_free(std::string_view target);
  void count_refused(AccessFault fault) { metrics_.count_refused(fault); }
  void set_ready(bool ready) { is_ready_ = ready; }
  void set_num_connections(std::function<std::size_t()> num) { num_connections_ = std::move(num); }

 private:
  struct Route;
  static const std::vector<Route>& routes();

  // Each takes what of the path lies behind that of its route.
  void page(const CallPtr& call, std::string_view rest);
  void recognize(const CallPtr& call, std::string_view rest);
  void points(const CallPtr& call, std::string_view rest);
  void list_models(const CallPtr& call, std::string_view rest);
  void view_model(const CallPtr& call, std::string_view rest);
  void list_parts(const CallPtr& call, std::string_view rest);
  void view_part(const CallPtr& call, std::string_view rest);
  void bring_part(const CallPtr& call, std::string_view rest);
  void declare_part(const CallPtr& call, std::string_view rest);
  void drop_part(const CallPtr& call, std::string_view rest);
  void publish_part(const CallPtr& call, std::string_view rest);
  void remove_model(const CallPtr& call, std::string_view rest);
  void rename_model(const CallPtr& call, std::string_view rest);
  void list_live(const CallPtr& call, std::string_view rest);
  void view_live(const CallPtr& call, std::string_view rest);
  void examples(const CallPtr& call, std::string_view rest);
  void session(const CallPtr& call, std::string_view rest);
  void session_archive(const CallPtr& call, std::string_view rest);
  void session_scan(const CallPtr& call, std::string_view rest);
  void put_session_scan(const CallPtr& call, std::string_view rest);
  void delete_session_scan(const CallPtr& call, std::string_view rest);
  void session_answer(const CallPtr& call, std::string_view rest);
  void put_session_answer(const CallPtr& call, std::string_view rest);
  void delete_session_run(const CallPtr& call, std::string_view rest);
  void score_parts(const CallPtr& call, std::string_view rest);
  void reload(const CallPtr& call, std::string_view rest);
  void openapi(const CallPtr& call, std::string_view rest);
  void live(const CallPtr& call, std::string_view rest);
  void ready(const CallPtr& call, std::string_view rest);
  void server(const CallPtr& call, std::string_view rest);
  void repository(const CallPtr& call, std::string_view rest);
  void inference_statistics(const CallPtr& call, std::string_view rest);
  void inference_model(const CallPtr& call, std::string_view rest);
  void infer(const CallPtr& call, std::string_view rest);
  void metrics(const CallPtr& call, std::string_view rest);

  /// Answer with what `write` makes of the job's answer, or with the refusal or error. `write` is
  /// part of the work, which may be answered for meanwhile: it leaves the call alone. `note` counts
  /// and tells of what is answered.
  void submit(const CallPtr& call, ServiceJob job,
              std::function<HttpResponse(const ServiceAnswer&)> write,
              std::function<void(const ServiceAnswer&)> note = {});
  /// A small job: `work` gives the answer.
  /// part_bytes  that it needs beside the body
  void submit_one(const CallPtr& call,
                  std::function<Result<HttpResponse>(const LibraryGeneration&)> work,
                  std::size_t part_bytes = 0);
  void refuse(const CallPtr& call, Refusal refusal);
  /// Answers with the generation that answers then.
  PartWorkshop::Done tell_generation(const CallPtr& call);
  /// Answers where there is none.
  bool has_session(const CallPtr& call) const;
  void tell_recognition(const CallPtr& call, const ServiceAnswer& found,
                        std::span<const SceneResult> results);
  void reply(const CallPtr& call, HttpResponse response) const {
    replies_.send(*call, std::move(response));
  }

  RecognitionService& service_;
  Metrics& metrics_;
  const RequestLog& log_;
  const Replies replies_;
  const RouteOptions options_;
  const std::vector<Example> examples_;
  const Reload reload_;
  const Commissioning commissioning_;
  Thumbnails thumbnails_;
  InferenceStatistics inferences_;
  std::function<std::size_t()> num_connections_;
  std::atomic<bool> is_ready_{false};
};

}  // namespace trivet::apps::service
