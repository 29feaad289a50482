/// Opens a library together with the score calibrated for a cell.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/loaded_library/recognizer.hpp"
#include "storage/common/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// How a library is opened.
struct OpenOptions {
  std::string calibration;  ///< file with the score of a cell; empty: the default score
  std::uint32_t memory_mb = MemoryBound::kDefault >> 20U;
  bool verify = false;  ///< verify all of it at once, not each model on first use
};

inline constexpr const char* kMemoryHelp =
    "What the library may keep in memory of what scenes needed: pages of its file, and surfaces "
    "that rays are shot at [MB]";

/// Adds --calibration, --memory, --verify. `options` must live as long as the command.
void add_open_options(CLI::App& command, OpenOptions& options);

/// Errors: of open_library or verify_library, and of read_calibration.
Result<Recognizer> open_recognizer(const std::string& library, const OpenOptions& options);

/// The score as shown in results: the name of a calibrated one, else null.
nlohmann::ordered_json calibration_json(const Recognizer& recognizer);

}  // namespace trivet::apps
