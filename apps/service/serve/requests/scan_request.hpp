/// The scans of a request with what is asked of them: one as the body, or several in a form.
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
  std::string name;        ///< that the client gave the file; its extension tells the format
  std::string_view bytes;  ///< within the request's body
  ServedScene scene;
};

/// Parts of a body that lives as long as they do.
struct ScanRequest {
  std::shared_ptr<const std::string> body;
  std::vector<ScanPart> scans;  ///< at least one
  RecognizeOptions options;
};

/// As the body alone: `format` tells the format, or the content type; options are parameters of
/// the target. As multipart/form-data: parts "scene", each with a file name, and at most one part
/// "options", an object with the names of the parameters; its "scenes", if there, is a list of one
/// object a scan with the camera, viewpoint and unit that differ. Parameters of the target hold for
/// all. Takes the request's body. Errors: usage, bad_data.
/// target  the request's, without what is not for the recognition
Result<ScanRequest> parse_scan_request(HttpRequest& request, Target target);

}  // namespace trivet::apps::service
