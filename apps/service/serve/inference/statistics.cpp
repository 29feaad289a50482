#include "apps/service/serve/inference/statistics.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t now_ms() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
}

}  // namespace

void InferenceStatistics::Sum::add(double seconds) {
  ++count;
  time +=
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
}

Json InferenceStatistics::Sum::json() const { return {{"count", count}, {"ns", time.count()}}; }

InferenceStatistics::Sums* InferenceStatistics::sums_of(std::uint64_t generation) {
  if (generation < sums_.generation) return nullptr;
  if (generation > sums_.generation) {
    sums_ = {};
    sums_.generation = generation;
  }
  return &sums_;
}

void InferenceStatistics::count_success(std::uint64_t generation, const InferenceSeconds& seconds) {
  const std::lock_guard lock(mutex_);
  Sums* const sums = sums_of(generation);
  if (!sums) return;
  sums->last_ms = now_ms();
  sums->success.add(seconds.total);
  sums->queue.add(seconds.queue);
  sums->input.add(seconds.input);
  sums->infer.add(seconds.infer);
  sums->output.add(seconds.output);
}

void InferenceStatistics::count_failure(std::uint64_t generation, double seconds) {
  const std::lock_guard lock(mutex_);
  Sums* const sums = sums_of(generation);
  if (sums) sums->fail.add(seconds);
}

Json InferenceStatistics::json(const std::string& model, std::uint64_t generation) const {
  const std::lock_guard lock(mutex_);
  const Sums sums = sums_.generation == generation ? sums_ : Sums{};
  const Sum never;
  Json one{{"name", model},
           {"version", std::to_string(generation)},
           {"last_inference", sums.last_ms},
           {"inference_count", sums.success.count},
           {"execution_count", sums.success.count},
           {"inference_stats",
            {{"success", sums.success.json()},
             {"fail", sums.fail.json()},
             {"queue", sums.queue.json()},
             {"compute_input", sums.input.json()},
             {"compute_infer", sums.infer.json()},
             {"compute_output", sums.output.json()},
             {"cache_hit", never.json()},
             {"cache_miss", never.json()}}},
           {"batch_stats", Json::array()}};
  return {{"model_stats", Json::array({std::move(one)})}};
}

}  // namespace trivet::apps::service
