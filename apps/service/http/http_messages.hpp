/// What the service reads from requests and answers with.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "apps/service/http/http_server.hpp"
#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// The content type of bytes that have no other.
inline constexpr const char* kBytes = "application/octet-stream";

HttpResponse json_response(unsigned status, const nlohmann::ordered_json& json);
/// 200 with the JSON. Errors: those of the JSON.
Result<HttpResponse> json_result(const Result<nlohmann::ordered_json>& json);
/// {"error": reason}; bytes of the reason that are no UTF-8 are replaced.
HttpResponse error_response(unsigned status, const std::string& reason);
/// 400 for what the client can mend, 507 where the disk is full, else 500.
HttpResponse error_response(const Error& error);
/// 503 with Retry-After, 504, or 499.
HttpResponse refusal_response(Refusal refusal);
/// 405 to a request of another method.
HttpResponse method_response(std::string_view expected, const HttpRequest& request);
/// One word for metrics and logs.
std::string_view reason_of(Refusal refusal);

/// X-Request-Id, if it is up to 128 letters, digits, '-', '_' and '.'; else one of our own.
std::string request_id(const HttpRequest& request);

/// The header traceparent as W3C Trace Context, 3.2, has it: version, trace, parent and flags in
/// lower-case hexadecimal digits, trace and parent not zero; empty where it is anything else.
std::string trace_parent(const HttpRequest& request);

/// When a request must be answered: X-Deadline-Ms, above 0 to an hour, from now. Errors: usage.
Result<std::chrono::steady_clock::time_point> deadline_of(const HttpRequest& request,
                                                          std::chrono::milliseconds otherwise);

}  // namespace trivet::apps::service
