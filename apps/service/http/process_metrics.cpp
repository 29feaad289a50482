#include "apps/service/http/process_metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr double kMicro = 1e-6;

/// Fields of /proc/self/stat after the name of the program.
struct ProcessState {
  double start_seconds = 0;  ///< since the boot of the system
  double virtual_bytes = 0, resident_bytes = 0;
};

std::optional<ProcessState> read_state() {
  std::ifstream file("/proc/self/stat");
  std::string text;
  if (!std::getline(file, text) || text.rfind(')') == std::string::npos) return std::nullopt;
  formats::TextCursor fields(std::string_view(text).substr(text.rfind(')') + 1));
  // proc(5): the name is the second field; the start time is the 22nd, and the sizes follow it.
  constexpr int kNumBetween = 22 - 3;
  for (int i = 0; i < kNumBetween; ++i) fields.word();
  const std::optional<double> start_ticks = parse_number(fields.word()),
                              virtual_bytes = parse_number(fields.word()),
                              resident_pages = parse_number(fields.word());
  if (!start_ticks || !virtual_bytes || !resident_pages) return std::nullopt;
  return ProcessState{*start_ticks / static_cast<double>(::sysconf(_SC_CLK_TCK)), *virtual_bytes,
                      *resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE))};
}

/// Boot time of the system, in seconds of Unix time.
std::optional<double> boot_seconds() {
  std::ifstream file("/proc/stat");
  for (std::string word; file >> word;) {
    if (word == "btime" && file >> word) return parse_number(word);
  }
  return std::nullopt;
}

std::optional<double> num_open_files() {
  std::error_code error;
  std::filesystem::directory_iterator files("/proc/self/fd", error);
  double number = -1;  // the folder itself is open while it is read
  for (; !error && files != std::filesystem::directory_iterator(); files.increment(error)) ++number;
  return error ? std::nullopt : std::optional(number);
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + kMicro * static_cast<double>(time.tv_usec);
}

}  // namespace

std::vector<prometheus::MetricFamily> process_metrics() {
  std::vector<prometheus::MetricFamily> all;
  const auto add = [&](const char* name, const char* help,
                       double value) -> prometheus::MetricFamily& {
    prometheus::ClientMetric metric;
    metric.gauge.value = value;
    return all.emplace_back(
        prometheus::MetricFamily{name, help, prometheus::MetricType::Gauge, {std::move(metric)}});
  };
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) == 0) {
    prometheus::MetricFamily& family =
        add("process_cpu_seconds_total", "Processor time of the program and the system for it.", 0);
    family.type = prometheus::MetricType::Counter;
    family.metric[0].counter.value = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  }
  if (const std::optional<double> number = num_open_files())
    add("process_open_fds", "Open file descriptors.", *number);
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    add("process_max_fds", "File descriptors that may be open.",
        static_cast<double>(limit.rlim_cur));
  }
  if (const std::optional<ProcessState> state = read_state()) {
    add("process_virtual_memory_bytes", "Memory that is mapped.", state->virtual_bytes);
    add("process_resident_memory_bytes", "Memory that is there.", state->resident_bytes);
    if (const std::optional<double> boot = boot_seconds()) {
      add("process_start_time_seconds", "When the process was started, in Unix time.",
          *boot + state->start_seconds);
    }
  }
  return all;
}

}  // namespace trivet::apps::service
