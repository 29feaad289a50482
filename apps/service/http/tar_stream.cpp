#include "apps/service/http/tar_stream.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>

#include "apps/service/common/file_reader.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint64_t kBlock = 512;
constexpr std::size_t kNameBytes = 100;

std::uint64_t padded(std::uint64_t bytes) { return (bytes + kBlock - 1) / kBlock * kBlock; }

/// POSIX.1-1988, ustar, with the modification time of the file.
std::string header_of(const TarEntry& entry, std::int64_t time) {
  std::array<char, kBlock> block{};
  const auto put = [&](std::size_t offset, const std::string& text) {
    std::ranges::copy(text, block.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  std::string name = entry.name, prefix;
  if (name.size() > kNameBytes) {
    const std::size_t slash = name.rfind('/');
    prefix = name.substr(0, slash);
    name = name.substr(slash + 1);
  }
  put(0, name);
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, fmt::format("{:011o}", entry.bytes));
  put(136, fmt::format("{:011o}", std::max<std::int64_t>(time, 0)));
  put(148, "        ");  // the checksum counts its own field as blanks
  put(156, "0");
  put(257, "ustar");
  put(263, "00");
  put(345, prefix);
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  put(148, fmt::format("{:06o}", sum));
  block[154] = '\0';
  return {block.begin(), block.end()};
}

class TarReader {
 public:
  explicit TarReader(std::vector<TarEntry> entries) : entries_(std::move(entries)) {}

  bool fill(std::span<char> out) {
    while (!out.empty()) {
      if (!text_.empty()) {
        const std::size_t n = std::min(out.size(), text_.size());
        std::copy_n(text_.begin(), n, out.begin());
        text_.erase(0, n);
        out = out.subspan(n);
      } else if (file_.left() > 0) {
        const std::size_t n = file_.read(out);
        if (n == 0) return false;
        out = out.subspan(n);
        if (file_.left() == 0) text_.assign(padding_, '\0');
      } else if (!begin_next()) {
        return false;
      }
    }
    return true;
  }

 private:
  bool begin_next() {
    if (next_ == entries_.size()) {
      text_.assign(2 * kBlock, '\0');
      return true;
    }
    const TarEntry& entry = entries_[next_++];
    struct stat found {};
    if (::stat(entry.file.c_str(), &found) != 0 ||
        static_cast<std::uint64_t>(found.st_size) != entry.bytes) {
      return false;
    }
    text_ = header_of(entry, found.st_mtime);
    file_ = FileReader(entry.file, entry.bytes);
    padding_ = padded(entry.bytes) - entry.bytes;
    return true;
  }

  const std::vector<TarEntry> entries_;
  std::size_t next_ = 0;
  std::string text_;  // sent before the rest of the file
  FileReader file_;
  std::uint64_t padding_ = 0;
};

}  // namespace

HttpStream tar_stream(std::vector<TarEntry> entries) {
  std::uint64_t num_bytes = 2 * kBlock;
  for (const TarEntry& entry : entries) num_bytes += kBlock + padded(entry.bytes);
  return {num_bytes, [reader = std::make_shared<TarReader>(std::move(entries))](
                         std::span<char> out) { return reader->fill(out); }};
}

}  // namespace trivet::apps::service
