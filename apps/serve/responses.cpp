#include "apps/serve/responses.hpp"

namespace trivet::apps {
namespace {

/// sysexits and HTTP speak of the same faults.
unsigned status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
    case ErrorCode::bad_data:
    case ErrorCode::missing_input:
      return 400;
    case ErrorCode::cannot_create:
    case ErrorCode::io:
    case ErrorCode::resumable:
    case ErrorCode::internal:
      return 500;
  }
  return 500;
}

}  // namespace

HttpResponse json_response(unsigned status, const nlohmann::ordered_json& json) {
  using Json = nlohmann::ordered_json;
  return {status, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

HttpResponse error_response(unsigned status, const std::string& reason) {
  return json_response(status, {{"error", reason}});
}

HttpResponse error_response(const Error& error) {
  return error_response(status_of(error.code), error.message);
}

HttpResponse refusal_response(Refusal refusal) {
  switch (refusal) {
    case Refusal::full: {
      HttpResponse response = error_response(503, "as many requests wait as may");
      response.headers.emplace_back("Retry-After", "1");
      return response;
    }
    case Refusal::too_late:
      return error_response(504, "the deadline passed");
    case Refusal::gone:
      return error_response(499, "the client closed the connection");
    case Refusal::closed:
      return error_response(503, "the service is being shut down");
  }
  return error_response(500, "unknown refusal");
}

std::string_view reason_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::full:
      return "full";
    case Refusal::too_late:
      return "deadline";
    case Refusal::gone:
      return "gone";
    case Refusal::closed:
      return "closed";
  }
  return "";
}

}  // namespace trivet::apps
