/// A session as JSON, and its refusals as responses.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/session/session.hpp"

namespace trivet::apps::service {

/// {"name", "bytes", "query", "truth", "version"}
nlohmann::ordered_json scan_json(const KeptScan& kept);

/// {"kept", "unit", "bytes", "scans", "runs", "faults"}
nlohmann::ordered_json session_json(const SessionContents& contents, std::uint64_t max_bytes);

/// The response to a request that the session refuses, with the present state in place of the one
/// that the client expected. Errors: those of the failed operation.
Result<HttpResponse> session_error_response(const SessionError& error);

}  // namespace trivet::apps::service
