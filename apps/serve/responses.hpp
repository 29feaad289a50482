/// Answers as JSON, and what faults are called in HTTP.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "apps/serve/http_server.hpp"
#include "engine/recognition_service.hpp"
#include "storage/result.hpp"

namespace trivet::apps {

HttpResponse json_response(unsigned status, const nlohmann::ordered_json& json);
/// {"error": reason}; bytes of the reason that are no UTF-8 are replaced.
HttpResponse error_response(unsigned status, const std::string& reason);
/// 400 for what the client can mend, else 500.
HttpResponse error_response(const Error& error);

/// 503 with Retry-After, 504, or 499.
HttpResponse refusal_response(Refusal refusal);
/// One word for metrics and logs.
std::string_view reason_of(Refusal refusal);

}  // namespace trivet::apps
