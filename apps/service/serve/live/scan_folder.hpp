/// Which scans of a folder that others write are whole.
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

  /// Of a regular file that is not empty; zeros of anything else.
  static FileStamp of(const std::filesystem::path& file) noexcept;
};

/// What the folder has to tell of one of its scans.
struct Arrival {
  std::filesystem::path file;
  FileStamp stamp;
  bool is_whole = true;  ///< or it is written again and again, and never was
};

/// What lies there at the start is old. What appears or changes later is whole once it was renamed
/// into the folder, or its size and time have rested: a writer that is slower than that has to rename.
class ScanFolder {
 public:
  ScanFolder(std::filesystem::path folder, std::chrono::milliseconds rest);
  ScanFolder(const ScanFolder&) = delete;
  ScanFolder& operator=(const ScanFolder&) = delete;
  ~ScanFolder();

  /// What has become whole since, the one that was written first before others. Waits for a moment.
  std::vector<Arrival> wait();
  /// Tell of a file again when it has rested: it was being written.
  void expect(const std::filesystem::path& file);

 private:
  using Clock = std::chrono::steady_clock;
  struct WatchedFile {
    FileStamp stamp;
    Clock::time_point rests_since, waits_since;
    bool is_done = false;   ///< reported as whole, or old
    bool is_noted = false;  ///< reported as one that never rests
  };

  /// What lies in the folder now. Returns false where it cannot be read.
  bool list_files(std::map<std::filesystem::path, FileStamp>& files) const;
  /// Names that were renamed into the folder since this was last asked.
  std::set<std::string> read_renamed() const;

  const std::filesystem::path folder_;
  const std::chrono::milliseconds rest_;
  int events_ = -1;  ///< inotify; none: all must rest
  std::map<std::filesystem::path, WatchedFile> watched_;
};

}  // namespace trivet::apps::service
