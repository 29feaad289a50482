/// A session: scans of a cell, the results in them and their truth, kept in a folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/common/file_reader.hpp"
#include "apps/service/serve/session/session_contents.hpp"
#include "apps/service/serve/session/session_result.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/files/file_lock.hpp"

namespace trivet::apps::service {

/// How a scan is read, as declared in a manifest.
struct ScanReading {
  std::string format;  ///< file extension
  LengthUnit unit = LengthUnit::meter;
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3d> viewpoint;
};

/// A model for the measurement of errors.
struct SessionModel {
  Symmetry symmetry;  ///< symmetry in `unit`
  LengthUnit unit = LengthUnit::meter;
  std::uint64_t generation = 0;         ///< generation of its library
  std::function<std::string()> mesh{};  ///< returns a PLY file, in `unit`
};
/// Finds a model by its name; none: there is no such model.
using ModelOfName = std::function<std::optional<SessionModel>(const std::string& name)>;

/// The truth of a scan; none: unknown.
using ScanTruth = std::optional<std::vector<TruthInstance>>;

/// A file of the session, with its path below the folder.
struct SessionFile {
  std::string name;
  std::filesystem::path file;
  std::uint64_t num_bytes = 0;
};

/// The opened file of an answer, and its version.
struct OpenAnswer {
  FileReader file;
  std::string version;
};

/// Other commands can read the folder:
///
///   scans/NAME.EXT      as uploaded
///   runs/RUN/NAME.json  answers in the format of `trivet recognize --json`
///   models/NAME.ply     meshes for the measurement of errors
///   scans.json          manifest of all scans: how each is read
///   manifest.json       manifest of those whose truth is known, with the truth
///   .trivet-session     marker of a session: no other folder is written
///
/// A session has one unit, that of its first scan. All members may be called from any thread. Their
/// errors are the faults that they name, and `failed`: cannot_create, io, no_space of the disk.
class Session {
 public:
  /// Opens the session of a folder, or creates one. Damaged files are listed in the contents and
  /// stay as they are; damaged listings are renamed.
  /// Errors: cannot_create (no folder, not a session's folder, or in use by another service).
  static Result<std::unique_ptr<Session>> open(const std::filesystem::path& folder,
                                               std::uint64_t max_bytes);

  /// Copies the current contents.
  SessionContents contents() const;
  std::uint64_t max_bytes() const noexcept { return max_bytes_; }

  /// Stores a scan. Faults: invalid, exists, too_large, full.
  SessionResult<KeptScan> put_scan(const std::string& name, std::string_view bytes,
                                   const ScanReading& reading);
  /// Opens the file of a scan. Faults: unknown.
  SessionResult<FileReader> scan(const std::string& name) const;
  /// Deletes a scan with its answers and its truth. Faults: unknown.
  SessionResult<void> delete_scan(const std::string& name);
  /// Replaces the truth of a scan.
  ///
  /// expected  versions of the truth that may be replaced, as defined by expects_version
  /// Faults: unknown, stale (with the present scan), too_large, full.
  SessionResult<KeptScan> put_truth(const std::string& name, const ScanTruth& truth,
                                    const std::string& expected, const ModelOfName& models);

  /// Stores an answer, and returns its version.
  ///
  /// text      JSON response to the recognition of this one scan
  /// expected  versions of the answer that may be replaced, as defined by expects_version
  /// Faults: invalid, unknown, stale (with the present answer), too_large, full; failed: bad_data,
  /// too.
  SessionResult<std::string> put_answer(const std::string& run, const std::string& scan,
                                        const std::string& text, const std::string& expected,
                                        const ModelOfName& models);
  /// Opens the file of an answer. Faults: unknown.
  SessionResult<OpenAnswer> answer(const std::string& run, const std::string& scan) const;
  /// Deletes a run with all its answers. Faults: unknown.
  SessionResult<void> delete_run(const std::string& run);

  /// Lists all files of the folder that belong to the session.
  std::vector<SessionFile> files() const;

 private:
  using Scans = std::map<std::string, SessionScan>;

  Session(std::filesystem::path folder, std::uint64_t max_bytes, FileLock lock);

  // Used by changes, one at a time.
  bool has_room(const std::string& file, std::uint64_t bytes) const;
  SessionError refuse_bytes(std::uint64_t bytes) const;
  /// Refuses if the present answer has another version than expected.
  SessionResult<void> check_answer_version(const std::string& run, const std::string& scan,
                                           const std::string& expected) const;
  SessionResult<void> check_new_scan(const std::string& name, const std::string& file,
                                     LengthUnit unit) const;
  /// Pre: there is room.
  Result<void> write(const std::string& file, std::span<const std::byte> bytes);
  Result<void> remove(const std::string& file);
  Result<void> write_listings(const Scans& scans);
  /// The models that the manifest lists.
  std::set<std::string> listed_models(const Scans& scans) const;
  /// Writes the meshes of the listed models. Faults: too_large, full.
  SessionResult<void> write_models(const Scans& scans, const ModelOfName& models);
  KeptScan kept_scan(const std::string& name, const SessionScan& scan) const;

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  const FileLock lock_;
  std::mutex changing_;         // locked during a whole change
  mutable std::mutex reading_;  // locked while the contents are read or replaced
  SessionContents contents_;
  std::map<std::string, std::uint64_t> generations_;  // generation of each known model
};

}  // namespace trivet::apps::service
