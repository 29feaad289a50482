/// Duration of the stages of a run.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trivet {

/// Seconds and counts per stage of one run, in the order in which the stages first ran.
struct StageTimes {
  std::vector<std::pair<std::string, double>> seconds;

  void add(std::string_view stage, double value) {
    for (auto& [name, sum] : seconds) {
      if (name == stage) {
        sum += value;
        return;
      }
    }
    seconds.emplace_back(stage, value);
  }
  void add(const StageTimes& others) {
    for (const auto& [stage, value] : others.seconds) add(stage, value);
  }
};

/// Adds its lifetime to a stage. It creates the stage's entry when it begins, so that its end
/// allocates nothing.
class StageTimer {
 public:
  StageTimer(StageTimes& times, std::string_view stage)
      : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {
    times_.add(stage_, 0);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() {
    times_.add(stage_,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }

 private:
  StageTimes& times_;
  std::string_view stage_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace trivet
