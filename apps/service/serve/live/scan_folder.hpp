/// Detection of complete scans in a folder that other programs write to.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace trivet::apps::service {

/// A state of a file.
struct FileStamp {
  std::uint64_t inode = 0, size = 0;
  std::int64_t written = 0;  ///< nanoseconds since 1970
  bool operator==(const FileStamp&) const = default;

  /// The state of a regular file that is not empty; zeros for anything else.
  static FileStamp of(const std::filesystem::path& file) noexcept;
};

/// An event for one scan of the folder.
struct Arrival {
  std::filesystem::path file;
  FileStamp stamp;
  bool is_complete = true;  ///< false: it is written again and again, and never was complete
};

/// Files that exist at the start are ignored. A file that appears or changes later is complete once
/// it was renamed into the folder, or once its size and time have been unchanged for the rest time.
/// Slower writers have to rename.
class ScanFolder {
 public:
  ScanFolder(std::filesystem::path folder, std::chrono::milliseconds rest);
  ScanFolder(const ScanFolder&) = delete;
  ScanFolder& operator=(const ScanFolder&) = delete;
  ~ScanFolder();

  /// Files that have become complete since the last call, the one written first before others.
  /// Waits for a moment.
  std::vector<Arrival> wait();
  /// Reports a file again once it is unchanged for the rest time: it was being written.
  void expect(const std::filesystem::path& file);

 private:
  using Clock = std::chrono::steady_clock;
  struct WatchedFile {
    FileStamp stamp;
    Clock::time_point rests_since, waits_since;
    bool is_done = false;   ///< reported as complete, or present at the start
    bool is_noted = false;  ///< reported as never complete
  };

  /// Lists the files of the folder. Returns false if it cannot be read.
  bool list_files(std::map<std::filesystem::path, FileStamp>& files) const;
  /// Names that were renamed into the folder since the last call.
  std::set<std::string> read_renamed() const;

  const std::filesystem::path folder_;
  const std::chrono::milliseconds rest_;
  int events_ = -1;  ///< inotify; none: all files must rest
  std::map<std::filesystem::path, WatchedFile> watched_;
};

}  // namespace trivet::apps::service
