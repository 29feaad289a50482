/// The contents of a session.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/length_unit.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::apps::service {

struct SessionScan {
  ManifestScene listed;    ///< how the scan is read, and its truth
  bool is_marked = false;  ///< the truth is known
};

/// The result of a recognition in a scan.
struct SessionAnswer {
  std::size_t num_found = 0;
  std::optional<double> seconds;
  std::set<std::string> models;  ///< models that were found
  std::string version;           ///< version of the file
};

/// A damaged file of the folder.
struct DamagedFile {
  std::string file, reason;
};

struct SessionContents {
  LengthUnit unit = LengthUnit::meter;
  std::map<std::string, SessionScan> scans;
  std::map<std::string, std::map<std::string, SessionAnswer>> runs;  ///< keyed by run, then by scan
  std::map<std::string, ManifestModel> models;  ///< models whose meshes are stored
  std::map<std::string, std::uint64_t> files;   ///< size in bytes, keyed by path below the folder
  std::vector<DamagedFile> damaged;
};

/// The space on a disk that the files occupy.
std::uint64_t bytes_on_disk(const SessionContents& contents);
/// The space on a disk that one file of this size occupies.
std::uint64_t bytes_on_disk(std::uint64_t bytes);

/// Reads an answer about one scan, as written by `trivet recognize --json` and the service.
/// Errors: bad_data.
Result<SessionAnswer> read_answer(std::span<const std::byte> bytes, const std::string& name);

/// The truth as [{"model", "T_scene_model"}], or null if unknown.
nlohmann::ordered_json truth_json(const SessionScan& scan);

/// A version that is the same for the same content.
std::string version_of(std::string_view bytes);
std::string truth_version(const SessionScan& scan);

/// Whether a change that expects these versions may replace the given one: `expected` is a list of
/// versions; "*" or an empty text stands for any.
bool expects_version(std::string_view expected, std::string_view version);

}  // namespace trivet::apps::service
