#include "apps/service/serve/serve_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps::service {

ServiceOptions ServeSettings::service() const {
  return {max_waiting, std::size_t{max_waiting_mb} << 20, (std::size_t{memory_mb} << 20) / 4 * 3,
          parallel, wait_for_memory_on_this_thread};
}

std::vector<Setting> settings_of(ServeSettings& settings) {
  ServeSettings& s = settings;
  std::vector<Setting> all{
      text_setting("library", "Library file, made by `trivet train`", s.library),
      text_setting("calibration",
                   "Score as `trivet calibrate` adapted it to these scans, from this file; read "
                   "again with the library",
                   s.calibration),
      number_setting("memory",
                     "Memory, a fourth for what the library keeps of what scenes needed, the rest "
                     "for scenes at work: those that do not fit beside others wait, those that "
                     "never fit get 413 [MB]",
                     s.memory_mb, 64, 1 << 20),
      number_setting("parallel",
                     "Scenes at a time: 1 for the shortest answer of each, 0, one a core, for the "
                     "most answers",
                     s.parallel, 0, 1024),
      number_setting("max-waiting", "Scenes that may wait; more get 503", s.max_waiting, 1,
                     100'000),
      number_setting("max-waiting-mb", "Memory of requests that arrive, wait and run; more get 503",
                     s.max_waiting_mb, 1, kMaxMb),
      text_setting("examples", "Manifest or BOP data set whose scenes the page offers", s.examples),
      text_setting(
          "session",
          "Keep scans, answers and what of them is right in this folder, for who commissions "
          "a cell with the page",
          s.session),
      number_setting("session-mb", "What the session may hold", s.session_mb, 1, kMaxMb),
      text_setting("watch",
                   "Recognize each scan that comes into this folder, for /v1/live and the page",
                   s.live.folder),
      text_setting("watch-query",
                   "Parameters of /v1/recognize for these scans, as "
                   "unit=mm&camera=525,525,319.5,239.5,1",
                   s.live.query),
      number_setting("watch-rest-ms",
                     "A scan that was not renamed into the folder is whole when its size and time "
                     "have not changed for so long",
                     s.live.rest_ms, 1, 3'600'000),
      flag_setting(
          "read-only",
          "Only recognize and show: clients reload and train nothing and write no session; 403",
          s.read_only),
      text_setting("allow-training",
                   "Let clients train parts, and publish, rename and remove models; drafts lie in "
                   "this folder",
                   s.workshop.folder),
      number_setting("training-mb", "Largest file of a part", s.workshop.max_file_mb, 1, kMaxMb),
      number_setting("training-seconds", "Longest training of a part", s.workshop.max_seconds, 1,
                     86'400),
      number_setting("training-models", "Models that the library may have then",
                     s.workshop.max_models, 1, 10'000'000),
  };
  all.front().argument = "LIBRARY";
  for (Setting& one : settings_of(s.listen)) all.push_back(std::move(one));
  return all;
}

namespace {

/// Missing and contradictory settings.
SettingFaults faults_of(const ServeSettings& settings) {
  SettingFaults faults = faults_of(settings.listen, "max-waiting-mb", settings.max_waiting_mb);
  const auto check_file = [&](const char* setting, const std::string& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored))
      faults.push_back(fmt::format("{}: {}: no such file", setting, file));
  };
  if (settings.library.empty()) {
    faults.emplace_back("library: expected a file made by `trivet train`, found none");
  } else {
    check_file("library", settings.library);
  }
  if (!settings.calibration.empty()) check_file("calibration", settings.calibration);
  if (!settings.examples.empty()) check_file("examples", settings.examples);
  if (!settings.live.query.empty() && settings.live.folder.empty())
    faults.emplace_back("watch-query: expected a folder to --watch, found none");
  if (settings.read_only && !settings.workshop.folder.empty())
    faults.emplace_back(
        "read-only: expected no allow-training, which lets clients change the library");
  return faults;
}

}  // namespace

Result<void> read_settings(ServeSettings& settings, const SettingArguments& arguments) {
  Result<SettingFaults> faults = set_values(settings_of(settings), arguments);
  if (!faults) return faults.error();
  for (std::string& fault : faults_of(settings)) faults->push_back(std::move(fault));
  if (faults->empty()) return {};
  return Error{ErrorCode::usage, fmt::format("{}", fmt::join(*faults, "\nerror: "))};
}

}  // namespace trivet::apps::service
