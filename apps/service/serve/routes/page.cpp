#include "apps/service/serve/routes/page.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "apps/service/http/http_messages.hpp"

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

constexpr const char* kNoPage = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Trivet: no page</title>
<h1>The service runs, but has no page</h1>
<p>This program was built without it. In the folder of the sources, build the page, then the program:</p>
<pre>./scripts/build-web
cmake --workflow --preset release</pre>
<p>It needs Node.js 18 or newer, and npm. Start the service again after that.</p>
<p>Programs can use the service as it is: <a href="/v1/openapi.json">what it offers</a>,
<a href="/v1/models">the models it looks for</a>, <a href="/metrics">its counters</a>.</p>
</html>
)";

}  // namespace

HttpResponse no_page_response(const HttpRequest& request) {
  if (request.header("accept").find("text/html") == std::string::npos) {
    return error_response(404,
                          "this program was built without the page: run scripts/build-web and "
                          "build it again");
  }
  return {404,
          kNoPage,
          "text/html; charset=utf-8",
          {{"Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"},
           {"X-Content-Type-Options", "nosniff"},
           {"Cache-Control", "no-cache"}}};
}

const PageFile* find_page_file(std::string_view path) {
  const auto found = std::ranges::find(page_files(), path, &PageFile::path);
  return found == page_files().end() ? nullptr : &*found;
}

}  // namespace trivet::apps::service
