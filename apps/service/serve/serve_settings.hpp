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
  /// A quarter of the memory is for the library, the rest for scenes being recognized.
  OpenOptions opening() const { return {calibration, std::max(memory_mb / 4, 16U)}; }
  LibraryFiles files() const { return {library, opening()}; }
};

/// The settings write to `settings`, which outlives them.
std::vector<Setting> settings_of(ServeSettings& settings);

/// Sets the values of a command line and of its settings file.
/// Errors: missing_input, io (the file); usage: every fault, one line each, including missing and
/// contradictory settings.
Result<void> read_settings(ServeSettings& settings, const SettingArguments& arguments);

}  // namespace trivet::apps::service
