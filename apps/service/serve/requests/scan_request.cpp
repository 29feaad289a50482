#include "apps/service/serve/requests/scan_request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "apps/service/http/json_parameters.hpp"
#include "apps/service/http/multipart.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::size_t kMaxOptionsBytes = 1 << 20;

const std::set<std::string, std::less<>>& known_formats() {
  static const std::set<std::string, std::less<>> formats(cloud_extensions().begin(),
                                                          cloud_extensions().end());
  return formats;
}

/// The format of a body, from the parameter `format` or its content type.
Result<std::string> format_of(const Target& target, const std::string& content_type) {
  if (const std::optional<std::string> format = target.parameter("format")) {
    if (known_formats().contains(*format)) return *format;
    return Error{ErrorCode::usage, fmt::format("format: expected one of {}, found '{}'",
                                               fmt::join(known_formats(), ", "), *format)};
  }
  if (content_type == "image/png") return std::string("png");
  if (content_type == "application/ply" || content_type == "model/ply") return std::string("ply");
  return Error{ErrorCode::usage, fmt::format("expected the parameter format, one of {}, found none",
                                             fmt::join(known_formats(), ", "))};
}

Result<void> check_name(const std::string& name) {
  if (is_cloud_file(name) || is_depth_file(name)) return {};
  return Error{ErrorCode::usage,
               fmt::format("scene '{}': expected a file name that ends with one of {}", name,
                           fmt::join(known_formats(), ", "))};
}

/// Contents of the part "options": for all scans, and for each.
struct FormOptions {
  Parameters all;
  std::vector<Parameters> each;
};

Result<FormOptions> read_options(std::string_view json) {
  if (json.size() > kMaxOptionsBytes) {
    return Error{ErrorCode::bad_data, fmt::format("options: expected at most {} bytes, found {}",
                                                  kMaxOptionsBytes, json.size())};
  }
  FormOptions out;
  const Result<void> done =
      with_json(std::as_bytes(std::span(json)), "options", [&](const JsonNode& root) {
        for (const auto& [name, value] : parameters_of(root.object(), {"scenes"}))
          out.all.emplace_back(name, value);
        if (!root.has("scenes")) return;
        for (const JsonNode& scene : root.at("scenes").elements()) {
          for (const auto& [name, value] : scene.members()) {
            if (name != "camera" && name != "viewpoint" && name != "unit")
              value.refuse("expected camera, viewpoint or unit");
          }
          out.each.push_back(parameters_of(scene));
        }
      });
  if (!done) return done.error();
  return out;
}

Result<ScanRequest> parse_form(const std::string& content_type, Parameters parameters,
                               ScanRequest out) {
  const Result<std::vector<FormPart>> parts = split_form(content_type, *out.body);
  if (!parts) return parts.error();
  FormOptions options;
  bool has_options = false;
  for (const FormPart& part : *parts) {
    if (part.name == "scene") {
      TRIVET_TRY(check_name(part.file_name));
      out.scans.push_back({part.file_name, part.content, {}});
    } else if (part.name == "options" && !has_options) {
      Result<FormOptions> read = read_options(part.content);
      if (!read) return read.error();
      options = std::move(*read);
      has_options = true;
    } else {
      return Error{
          ErrorCode::usage,
          fmt::format("form: expected parts scene and at most one options, found '{}'", part.name)};
    }
  }
  if (out.scans.empty())
    return Error{ErrorCode::usage, "form: expected a part scene at least, found none"};
  if (!options.each.empty() && options.each.size() != out.scans.size()) {
    return Error{ErrorCode::usage, fmt::format("options: scenes: expected {}, as many as parts "
                                               "scene, found {}",
                                               out.scans.size(), options.each.size())};
  }
  parameters.insert(parameters.end(), options.all.begin(), options.all.end());
  Result<RecognizeQuery> query = parse_recognize_query(parameters);
  if (!query) return query.error();
  out.options = std::move(query->options);
  for (std::size_t i = 0; i < out.scans.size(); ++i) {
    out.scans[i].scene = query->scene;
    if (options.each.empty()) continue;
    const Result<RecognizeQuery> own = parse_recognize_query(options.each[i]);
    if (!own) return own.error();
    ServedScene& scene = out.scans[i].scene;
    if (own->scene.camera) scene.camera = own->scene.camera;
    if (own->scene.viewpoint) scene.viewpoint = own->scene.viewpoint;
    if (own->scene.unit) scene.unit = own->scene.unit;
  }
  return out;
}

}  // namespace

Result<ScanRequest> parse_scan_request(HttpRequest& request, Target target) {
  const std::string content_type = request.header("content-type");
  ScanRequest out{std::make_shared<const std::string>(std::move(request.body)), {}, {}};
  if (is_form(content_type))
    return parse_form(content_type, std::move(target.parameters), std::move(out));

  const Result<std::string> format = format_of(target, content_type);
  if (!format) return format.error();
  // A second one remains as an unknown parameter.
  if (const auto given = std::ranges::find(target.parameters, "format",
                                           [](const auto& entry) { return entry.first; });
      given != target.parameters.end()) {
    target.parameters.erase(given);
  }
  Result<RecognizeQuery> query = parse_recognize_query(target.parameters);
  if (!query) return query.error();
  out.options = std::move(query->options);
  out.scans.push_back({"body." + *format, *out.body, query->scene});
  return out;
}

}  // namespace trivet::apps::service
