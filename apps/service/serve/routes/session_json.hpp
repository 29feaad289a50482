/// A session as JSON, and its refusals as answers.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/session/session.hpp"

namespace trivet::apps::service {

/// {"name", "bytes", "query", "truth", "version"}
nlohmann::ordered_json scan_json(const KeptScan& kept);

/// {"kept", "unit", "bytes", "scans", "runs", "faults"}
nlohmann::ordered_json session_json(const SessionContents& contents, std::uint64_t max_bytes);

/// The answer to a client whose request the session refuses, with what is there instead of what the
/// client expected. Errors: of what has failed.
Result<HttpResponse> session_error_response(const SessionError& error);

}  // namespace trivet::apps::service
