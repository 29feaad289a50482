/// Scans of a cell, what was found in them and what of that is right, kept in a folder.
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

/// How a scan is read: as a manifest says it.
struct ScanReading {
  std::string format;  ///< the extension
  LengthUnit unit = LengthUnit::meter;
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3d> viewpoint;
};

/// A model as errors are measured on it.
struct SessionModel {
  Symmetry symmetry;  ///< in `unit`
  LengthUnit unit = LengthUnit::meter;
  std::uint64_t generation = 0;         ///< of the library that it comes from
  std::function<std::string()> mesh{};  ///< gives the bytes of a PLY file, in `unit`
};
/// None: there is no such model.
using ModelOfName = std::function<std::optional<SessionModel>(const std::string& name)>;

/// The truth of a scan; none: it is not known.
using ScanTruth = std::optional<std::vector<TruthInstance>>;

/// A file of the session, with its path below the folder.
struct SessionFile {
  std::string name;
  std::filesystem::path file;
  std::uint64_t num_bytes = 0;
};

/// An answer's file, opened, and the version that it is of.
struct OpenAnswer {
  FileReader file;
  std::string version;
};

/// The folder is one that other commands take:
///
///   scans/NAME.EXT      as they came
///   runs/RUN/NAME.json  answers, as `trivet recognize --json` writes them
///   models/NAME.ply     what errors are measured on
///   scans.json          manifest of all scans: how each is read
///   manifest.json       manifest of those whose truth is known, with it
///   .trivet-session     says that it is a session's: no other folder is written
///
/// It has one unit, that of its first scan. All members may be called from any thread. They refuse
/// with the faults that they name, and with `failed`: cannot_create, io, no_space of the disk.
class Session {
 public:
  /// Open the session of a folder, or begin one. What is damaged is listed in the contents and left
  /// as it is; damaged listings are renamed. Errors: cannot_create (no folder, one that is no
  /// session's, or another service has it).
  static Result<std::unique_ptr<Session>> open(const std::filesystem::path& folder,
                                               std::uint64_t max_bytes);

  /// Copy what it holds now.
  SessionContents contents() const;
  std::uint64_t max_bytes() const noexcept { return max_bytes_; }

  /// Keep a scan. Faults: invalid, exists, too_large, full.
  SessionResult<KeptScan> put_scan(const std::string& name, std::string_view bytes,
                                   const ScanReading& reading);
  /// Open the file of a scan. Faults: unknown.
  SessionResult<FileReader> scan(const std::string& name) const;
  /// Delete a scan with its answers and its truth. Faults: unknown.
  SessionResult<void> delete_scan(const std::string& name);
  /// Replace the truth of a scan.
  ///
  /// expected  versions of the truth that may be replaced, as of expects_version
  /// Faults: unknown, stale (with the scan as it is), too_large, full.
  SessionResult<KeptScan> put_truth(const std::string& name, const ScanTruth& truth,
                                    const std::string& expected, const ModelOfName& models);

  /// Keep an answer, and return its version.
  ///
  /// text      what a recognition of this one scan answered, as JSON
  /// expected  versions of the answer that may be replaced, as of expects_version
  /// Faults: invalid, unknown, stale (with the answer that is there), too_large, full; failed:
  /// bad_data, too.
  SessionResult<std::string> put_answer(const std::string& run, const std::string& scan,
                                        const std::string& text, const std::string& expected,
                                        const ModelOfName& models);
  /// Open the file of an answer. Faults: unknown.
  SessionResult<OpenAnswer> answer(const std::string& run, const std::string& scan) const;
  /// Delete a run with all its answers. Faults: unknown.
  SessionResult<void> delete_run(const std::string& run);

  /// List all files of the folder that are the session's.
  std::vector<SessionFile> files() const;

 private:
  using Scans = std::map<std::string, SessionScan>;

  Session(std::filesystem::path folder, std::uint64_t max_bytes, FileLock lock);

  // Of changes, one at a time.
  bool has_room(const std::string& file, std::uint64_t bytes) const;
  SessionError refuse_bytes(std::uint64_t bytes) const;
  /// Refuses where the answer that is there is of another version than expected.
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
  /// Write the meshes of the listed models. Faults: too_large, full.
  SessionResult<void> write_models(const Scans& scans, const ModelOfName& models);
  KeptScan kept_scan(const std::string& name, const SessionScan& scan) const;

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  const FileLock lock_;
  std::mutex changing_;         // held for the whole of a change
  mutable std::mutex reading_;  // held while the contents are read or replaced
  SessionContents contents_;
  std::map<std::string, std::uint64_t> generations_;  // that the models are known to be of
};

}  // namespace trivet::apps::service
