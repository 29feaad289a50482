/// Scans of a cell, what was found in them and what of that is right, kept in a folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/service/http/http_server.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/files/file_lock.hpp"

namespace trivet::apps::service {

/// What a session may be asked for by name: [A-Za-z0-9][A-Za-z0-9._-]{0,63} without "..".
bool is_session_name(std::string_view name) noexcept;

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

/// The folder is one that other commands take:
///
///   scans/NAME.EXT      as they came
///   runs/RUN/NAME.json  answers, as `trivet recognize --json` writes them
///   models/NAME.ply     what errors are measured on
///   scans.json          manifest of all scans: how each is read
///   manifest.json       manifest of those whose truth is told, with it
///   .trivet-session     says that it is a session's: no other folder is written
///
/// It has one unit, that of its first scan. All members may be called from any thread. What cannot
/// be done is an answer that says why; errors are those of the disk: cannot_create, io.
class Session {
 public:
  /// What is damaged in the folder is told by the index and left as it is; damaged listings are
  /// put aside. Errors: cannot_create (no folder, one that is no session's, or another service has
  /// it).
  static Result<std::unique_ptr<Session>> open(const std::filesystem::path& folder,
                                               std::uint64_t max_bytes);

  nlohmann::ordered_json index() const;
  std::size_t num_scans() const;

  Result<HttpResponse> put_scan(const std::string& name, std::string_view bytes,
                                const ScanReading& reading);
  HttpResponse scan(const std::string& name) const;
  /// With its answers and its truth.
  Result<HttpResponse> delete_scan(const std::string& name);
  /// body   {"truth": entries of a manifest, or null where it is not told}
  /// match  the header If-Match: versions of the truth that may be replaced; empty: any. Another
  ///        one is answered by 409, with the scan as it is.
  Result<HttpResponse> put_truth(const std::string& name, const std::string& body,
                                 const std::string& match, const ModelOfName& models);

  /// body   what a recognition of this one scan answered
  /// match  as of put_truth: of the answer that is there, which comes with 409
  Result<HttpResponse> put_answer(const std::string& run, const std::string& scan,
                                  const std::string& body, const std::string& match,
                                  const ModelOfName& models);
  HttpResponse answer(const std::string& run, const std::string& scan) const;
  Result<HttpResponse> delete_run(const std::string& run);

  /// The folder as one tar file.
  HttpResponse archive() const;

 private:
  struct Scan {
    ManifestScene listed;
    bool is_marked = false;  ///< its truth is told
  };
  struct Answer {
    std::size_t num_found = 0;
    std::optional<double> seconds;
    std::set<std::string> models;  ///< that were found
    std::string version;           ///< of the file
  };
  struct Fault {
    std::string file, reason;
  };
  using Scans = std::map<std::string, Scan>;

  Session(std::filesystem::path folder, std::uint64_t max_bytes, FileLock lock)
      : folder_(std::move(folder)), max_bytes_(max_bytes), lock_(std::move(lock)) {}

  /// Errors: bad_data.
  static Result<Answer> read_answer(std::span<const std::byte> bytes, const std::string& name);

  // At the start.
  std::optional<Manifest> take_listing(const char* name);
  void take_scans(const Manifest& scans);
  void take_truth(const Manifest& marked);
  bool is_folder(const std::string& folder);
  void take_files(const std::string& folder);
  void take_runs();
  void take_answer(const std::string& file, const std::string& run, const std::string& scan);

  // Of changes, one at a time.
  bool has_room(const std::string& file, std::uint64_t bytes) const;
  std::uint64_t bytes_used() const;
  /// Pre: there is room.
  Result<void> write(const std::string& file, std::span<const std::byte> bytes);
  Result<void> remove(const std::string& file);
  Result<void> write_listings(const Scans& scans);
  /// Those that the manifest lists.
  std::set<std::string> listed_models(const Scans& scans) const;
  /// Their meshes. Returns an answer where there is no room.
  Result<std::optional<HttpResponse>> write_models(const Scans& scans, const ModelOfName& models);
  HttpResponse refuse_bytes(std::uint64_t bytes) const;
  nlohmann::ordered_json scan_json(const std::string& name, const Scan& scan) const;
  /// 409 where the answer that is there is of a version that `match` does not name.
  std::optional<HttpResponse> refuse_stale_answer(const std::string& run, const std::string& scan,
                                                  const std::string& match) const;

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  const FileLock lock_;
  std::mutex changing_;         // held for the whole of a change
  mutable std::mutex reading_;  // held while what follows is looked at or swapped
  LengthUnit unit_ = LengthUnit::meter;
  Scans scans_;
  std::map<std::string, std::map<std::string, Answer>> runs_;  // by run, then by scan
  std::map<std::string, ManifestModel> models_;                // whose meshes are kept
  std::map<std::string, std::uint64_t> generations_;           // that these are known to be of
  std::map<std::string, std::uint64_t> files_;                 // bytes, by path below the folder
  std::vector<Fault> faults_;
};

}  // namespace trivet::apps::service
