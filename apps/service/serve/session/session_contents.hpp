/// What a session holds.
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
  ManifestScene listed;    ///< how it is read, and its truth
  bool is_marked = false;  ///< its truth is known
};

/// What a recognition found in a scan.
struct SessionAnswer {
  std::size_t num_found = 0;
  std::optional<double> seconds;
  std::set<std::string> models;  ///< that were found
  std::string version;           ///< of the file
};

/// What is damaged in the folder.
struct DamagedFile {
  std::string file, reason;
};

struct SessionContents {
  LengthUnit unit = LengthUnit::meter;
  std::map<std::string, SessionScan> scans;
  std::map<std::string, std::map<std::string, SessionAnswer>> runs;  ///< by run, then by scan
  std::map<std::string, ManifestModel> models;                       ///< whose meshes are kept
  std::map<std::string, std::uint64_t> files;  ///< bytes, by path below the folder
  std::vector<DamagedFile> damaged;
};

/// What the files take of a disk.
std::uint64_t bytes_on_disk(const SessionContents& contents);
/// What one file of so many bytes takes of a disk.
std::uint64_t bytes_on_disk(std::uint64_t bytes);

/// Read an answer about one scan, as `trivet recognize --json` and the service write it. Errors:
/// bad_data.
Result<SessionAnswer> read_answer(std::span<const std::byte> bytes, const std::string& name);

/// The truth as [{"model", "T_scene_model"}], or null where it is not known.
nlohmann::ordered_json truth_json(const SessionScan& scan);

/// A version is the same for the same content.
std::string version_of(std::string_view bytes);
std::string truth_version(const SessionScan& scan);

/// Whether a change that expects these versions may replace this one: `expected` is a list of them;
/// "*" or nothing stands for any.
bool expects_version(std::string_view expected, std::string_view version);

}  // namespace trivet::apps::service
