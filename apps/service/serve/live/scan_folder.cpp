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
/// After so many rests without one, and so long, it is told that a file never rests.
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

// Events tell what was renamed, and nothing else: others may be lost (network file systems, a full
// queue), and what was closed need not be whole.
ScanFolder::ScanFolder(fs::path folder, milliseconds rest)
    : folder_(std::move(folder)), rest_(rest), events_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (events_ >= 0) (void)::inotify_add_watch(events_, folder_.c_str(), IN_MOVED_TO);
  std::map<fs::path, FileStamp> files;
  look(files);
  for (const auto& [file, stamp] : files) seen_[file] = {stamp, {}, {}, true, false};
}

ScanFolder::~ScanFolder() {
  if (events_ >= 0) ::close(events_);
}

bool ScanFolder::look(std::map<fs::path, FileStamp>& files) const {
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const fs::path& file = at->path();
    if (!is_cloud_file(file) && !is_depth_file(file)) continue;
    if (const FileStamp stamp = FileStamp::of(file); stamp.size > 0) files.emplace(file, stamp);
  }
  return !error;
}

std::set<std::string> ScanFolder::take_renamed() const {
  std::set<std::string> names;
  alignas(inotify_event) std::array<char, 16384> buffer;
  for (ssize_t n = 0; events_ >= 0 && (n = ::read(events_, buffer.data(), buffer.size())) > 0;) {
    for (std::size_t at = 0; at < static_cast<std::size_t>(n);) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof(event));
      if (event.len > 0) names.emplace(buffer.data() + at + sizeof(event));
      at += sizeof(event) + event.len;
    }
  }
  return names;
}

std::vector<Arrival> ScanFolder::wait() {
  pollfd descriptor{events_, POLLIN, 0};
  if (events_ < 0 || ::poll(&descriptor, 1, static_cast<int>(kPollInterval.count())) < 0)
    std::this_thread::sleep_for(kPollInterval);
  const std::set<std::string> renamed = take_renamed();
  std::map<fs::path, FileStamp> files;
  if (!look(files)) return {};  // it may come back

  const Clock::time_point now = Clock::now();
  std::vector<Arrival> arrivals;
  std::map<fs::path, Seen> seen;
  for (const auto& [file, stamp] : files) {
    const auto before = seen_.find(file);
    const bool is_known = before != seen_.end();
    Seen& it = seen[file] = is_known ? before->second : Seen{stamp, now, now, false, false};
    if (it.stamp != stamp) {
      if (it.is_done) it.waits_since = now;
      it.stamp = stamp;
      it.rests_since = now;
      it.is_done = false;
    }
    if (it.is_done) continue;
    if (now - it.rests_since >= rest_ || renamed.contains(file.filename().string())) {
      it.is_done = true;
      it.is_noted = false;
      arrivals.push_back({file, stamp, true});
    } else if (!it.is_noted && now - it.waits_since >= std::max(kRestless, kMostRests * rest_)) {
      it.is_noted = true;
      arrivals.push_back({file, stamp, false});
    }
  }
  seen_ = std::move(seen);
  std::ranges::sort(arrivals, [](const Arrival& a, const Arrival& b) {
    return std::tie(a.stamp.written, a.file) < std::tie(b.stamp.written, b.file);
  });
  return arrivals;
}

void ScanFolder::expect(const fs::path& file) {
  const auto found = seen_.find(file);
  if (found == seen_.end()) return;
  if (found->second.is_done) found->second.waits_since = Clock::now();
  found->second.rests_since = Clock::now();
  found->second.is_done = false;
}

}  // namespace trivet::apps::service
