/// How long the stages of a run took.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trivet {

/// Seconds and counts of the stages of one run, in the order in which they first ran.
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

/// Adds the time that it lives to a stage, which it makes room for when it begins: its end allocates
/// nothing.
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
