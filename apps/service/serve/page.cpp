#include "apps/service/serve/page.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

namespace trivet::apps::service {

/// Defined by what cmake/embed.cmake writes.
std::span<const std::pair<std::string_view, std::string_view>> embedded_page();

namespace {

std::string_view content_type(std::string_view path) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".json", "application/json"},
  }};
  const auto* const found =
      std::ranges::find_if(kTypes, [&](const auto& type) { return path.ends_with(type.first); });
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

const std::vector<PageFile>& page_files() {
  static const std::vector<PageFile> files = [] {
    std::vector<PageFile> out;
    for (const auto& [path, bytes] : embedded_page())
      out.push_back({path, content_type(path), bytes});
    return out;
  }();
  return files;
}

}  // namespace

const PageFile* find_page_file(std::string_view path) {
  const auto found = std::ranges::find(page_files(), path, &PageFile::path);
  return found == page_files().end() ? nullptr : &*found;
}

}  // namespace trivet::apps::service
