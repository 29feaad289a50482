#include "apps/service/serve/live/scan_folder.hpp"

#include <poll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include "storage/formats/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{150};
/// A file that keeps changing for so many rest times, and at least for so long, is reported as never
/// complete.
constexpr int kMostRests = 10;
constexpr milliseconds kRestless{10'000};

}  // namespace

FileStamp FileStamp::of(const fs::path& file) noexcept {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0)
    return {};
  return {status.st_ino, static_cast<std::uint64_t>(status.st_size),
          std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

// Events report renamed files only: others may be lost (network file systems, a full queue), and a
// closed file need not be complete.
ScanFolder::ScanFolder(fs::path folder, milliseconds rest)
    : folder_(std::move(folder)), rest_(rest), events_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (events_ >= 0) (void)::inotify_add_watch(events_, folder_.c_str(), IN_MOVED_TO);
  std::map<fs::path, FileStamp> files;
  list_files(files);
  for (const auto& [file, stamp] : files) watched_[file] = {stamp, {}, {}, true, false};
}

ScanFolder::~ScanFolder() {
  if (events_ >= 0) ::close(events_);
}

bool ScanFolder::list_files(std::map<fs::path, FileStamp>& files) const {
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const fs::path& file = it->path();
    if (!is_cloud_file(file) && !is_depth_file(file)) continue;
    if (const FileStamp stamp = FileStamp::of(file); stamp.size > 0) files.emplace(file, stamp);
  }
  return !error;
}

std::set<std::string> ScanFolder::read_renamed() const {
  std::set<std::string> names;
  alignas(inotify_event) std::array<char, 16384> buffer;
  for (ssize_t n = 0; events_ >= 0 && (n = ::read(events_, buffer.data(), buffer.size())) > 0;) {
    for (std::size_t offset = 0; offset < static_cast<std::size_t>(n);) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + offset, sizeof(event));
      if (event.len > 0) names.emplace(buffer.data() + offset + sizeof(event));
      offset += sizeof(event) + event.len;
    }
  }
  return names;
}

std::vector<Arrival> ScanFolder::wait() {
  pollfd descriptor{events_, POLLIN, 0};
  if (events_ < 0 || ::poll(&descriptor, 1, static_cast<int>(kPollInterval.count())) < 0)
    std::this_thread::sleep_for(kPollInterval);
  const std::set<std::string> renamed = read_renamed();
  std::map<fs::path, FileStamp> files;
  if (!list_files(files)) return {};  // the folder may come back

  const Clock::time_point now = Clock::now();
  std::vector<Arrival> arrivals;
  std::map<fs::path, WatchedFile> watched;
  for (const auto& [file, stamp] : files) {
    const auto before = watched_.find(file);
    const bool is_known = before != watched_.end();
    WatchedFile& entry = watched[file] =
        is_known ? before->second : WatchedFile{stamp, now, now, false, false};
    if (entry.stamp != stamp) {
      if (entry.is_done) entry.waits_since = now;
      entry.stamp = stamp;
      entry.rests_since = now;
      entry.is_done = false;
    }
    if (entry.is_done) continue;
    if (now - entry.rests_since >= rest_ || renamed.contains(file.filename().string())) {
      entry.is_done = true;
      entry.is_noted = false;
      arrivals.push_back({file, stamp, true});
    } else if (!entry.is_noted &&
               now - entry.waits_since >= std::max(kRestless, kMostRests * rest_)) {
      entry.is_noted = true;
      arrivals.push_back({file, stamp, false});
    }
  }
  watched_ = std::move(watched);
  std::ranges::sort(arrivals, [](const Arrival& a, const Arrival& b) {
    return std::tie(a.stamp.written, a.file) < std::tie(b.stamp.written, b.file);
  });
  return arrivals;
}

void ScanFolder::expect(const fs::path& file) {
  const auto found = watched_.find(file);
  if (found == watched_.end()) return;
  if (found->second.is_done) found->second.waits_since = Clock::now();
  found->second.rests_since = Clock::now();
  found->second.is_done = false;
}

}  // namespace trivet::apps::service
