/// Helpers that read requests and build responses.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "apps/service/http/http_server.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// The content type of bytes without a more specific type.
inline constexpr const char* kBytes = "application/octet-stream";

HttpResponse json_response(unsigned status, const nlohmann::ordered_json& json);
/// A 200 response with the JSON. Errors: those of the JSON.
Result<HttpResponse> json_result(const Result<nlohmann::ordered_json>& json);
/// The body {"error": reason}. Bytes of the reason that are not UTF-8 are replaced.
HttpResponse error_response(unsigned status, const std::string& reason);
/// 400 for faults that the client can correct, 507 for a full disk, else 500.
HttpResponse error_response(const Error& error);
/// The response to a refused job: 503 with Retry-After, 504, or 499.
HttpResponse refusal_response(Refusal refusal);
/// 405, the response to a request with another method.
HttpResponse method_response(std::string_view expected, const HttpRequest& request);
/// One word for metrics and logs.
std::string_view reason_of(Refusal refusal);

/// X-Request-Id, if it consists of up to 128 letters, digits, '-', '_' and '.'; else a generated
/// id.
std::string request_id(const HttpRequest& request);

/// The traceparent header as defined by W3C Trace Context, 3.2: version, trace, parent and flags in
/// lower-case hexadecimal digits, trace and parent not zero. Empty for any other text.
std::string trace_parent(const HttpRequest& request);

/// The deadline of a request: X-Deadline-Ms, above 0 and up to an hour, counted from its arrival.
/// Errors: usage.
Result<std::chrono::steady_clock::time_point> deadline_of(
    const HttpRequest& request, std::chrono::steady_clock::time_point begun,
    std::chrono::milliseconds otherwise);

}  // namespace trivet::apps::service
