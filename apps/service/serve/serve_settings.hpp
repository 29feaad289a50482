/// All settings of a service.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/service/listen_settings.hpp"
#include "apps/service/serve/library/library_slot.hpp"
#include "apps/service/serve/live/live_scans.hpp"
#include "apps/service/serve/workshop/part_workshop.hpp"
#include "engine/recognition/recognition_service.hpp"

namespace trivet::apps::service {

struct ServeSettings {
  std::string library, calibration, examples, session;
  bool read_only = false;
  std::uint32_t memory_mb = 4096, parallel = 0, max_waiting = 64, max_waiting_mb = 512,
                session_mb = 1024;
  WorkshopSettings workshop;
  LiveSettings live;
  ListenSettings listen;

  ServiceOptions service() const;
  /// A fourth of the memory is the library's, the rest is for scenes at work.
  OpenOptions opening() const { return {calibration, std::max(memory_mb / 4, 16U)}; }
  LibraryFiles files() const { return {library, opening()}; }
};

/// They write to `settings`, which outlives them.
std::vector<Setting> settings_of(ServeSettings& settings);

/// Set what a command line and its file say. Errors: missing_input, io (the file); usage: everything
/// that is wrong, a line each, also what is missing or contradicts itself.
Result<void> read_settings(ServeSettings& settings, const SettingArguments& arguments);

}  // namespace trivet::apps::service
