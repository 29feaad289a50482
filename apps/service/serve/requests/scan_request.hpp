/// The scans of a request with their options: one scan as the body, or several in a form.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/http_server.hpp"
#include "apps/service/http/query.hpp"
#include "apps/service/serve/requests/recognize_query.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct ScanPart {
  std::string name;        ///< client's file name; its extension gives the format
  std::string_view bytes;  ///< view into the body of the request
  ServedScene scene;
};

/// Views into a body that outlives them.
struct ScanRequest {
  std::shared_ptr<const std::string> body;
  std::vector<ScanPart> scans;  ///< at least one
  RecognizeOptions options;
};

/// A single scan is the whole body: `format` or the content type gives its format, and options are
/// parameters of the target. As multipart/form-data, there are parts "scene", each with a file
/// name, and at most one part "options", an object with the names of the parameters. Its optional
/// "scenes" is a list of one object per scan with the camera, viewpoint and unit that differ.
/// Parameters of the target apply to all scans. Moves the body out of the request.
/// Errors: usage, bad_data.
///
/// target  that of the request, without parameters that are not for the recognition
Result<ScanRequest> parse_scan_request(HttpRequest& request, Target target);

}  // namespace trivet::apps::service
