#include "apps/service/http/http_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "storage/files/json_text.hpp"
#include "storage/files/numbers.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr double kMaxDeadlineMs = 3.6e6;

bool is_plain(const std::string& id) {
  return !id.empty() && id.size() <= 128 && std::ranges::all_of(id, [](char c) {
    return formats::is_alphanumeric(c) || c == '-' || c == '_' || c == '.';
  });
}

/// Maps sysexits codes to status codes: both describe the same faults.
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
    case ErrorCode::changed:
    case ErrorCode::damaged:
    case ErrorCode::no_memory:
      return 503;
    case ErrorCode::no_space:
      return 507;
  }
  return 500;
}

}  // namespace

HttpResponse json_response(unsigned status, const nlohmann::ordered_json& json) {
  return {status, json_text(json) + "\n"};
}

Result<HttpResponse> json_result(const Result<nlohmann::ordered_json>& json) {
  if (!json) return json.error();
  return json_response(200, *json);
}

HttpResponse error_response(unsigned status, const std::string& reason) {
  return json_response(status, {{"error", reason}});
}

HttpResponse error_response(const Error& error) {
  HttpResponse response = error_response(status_of(error.code), error.message);
  if (error.code == ErrorCode::no_memory) response.headers.emplace_back("Retry-After", "1");
  return response;
}

HttpResponse refusal_response(Refusal refusal) {
  switch (refusal) {
    case Refusal::full: {
      HttpResponse response =
          error_response(503, "as many requests wait as may, or as can be answered in time");
      response.headers.emplace_back("Retry-After", "1");
      return response;
    }
    case Refusal::too_large:
      return error_response(413, "needs more memory than scenes may take; see --memory");
    case Refusal::no_memory:
      return error_response(Error{ErrorCode::no_memory, kOutOfMemory});
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
    case Refusal::too_large:
      return "too_large";
    case Refusal::no_memory:
      return "memory";
    case Refusal::too_late:
      return "deadline";
    case Refusal::gone:
      return "gone";
    case Refusal::closed:
      return "closed";
  }
  return "";
}

HttpResponse method_response(std::string_view expected, const HttpRequest& request) {
  HttpResponse response =
      error_response(405, fmt::format("expected {}, found {}", expected, request.method));
  response.headers.emplace_back("Allow", std::string(expected));
  return response;
}

std::string request_id(const HttpRequest& request) {
  const std::string given = request.header("x-request-id");
  if (is_plain(given)) return given;
  thread_local std::mt19937_64 random{std::random_device{}()};
  return fmt::format("{:016x}", random());
}

std::string trace_parent(const HttpRequest& request) {
  const std::string given = request.header("traceparent");
  static constexpr std::string_view kForm =
      "xx-xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx-xxxxxxxxxxxxxxxx-xx";
  const bool good =
      given.size() == kForm.size() &&
      std::equal(given.begin(), given.end(), kForm.begin(), [](char c, char form) {
        return form == '-' ? c == '-' : (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
      });
  const auto is_zero = [&](std::size_t first, std::size_t count) {
    return given.find_first_not_of('0', first) >= first + count;
  };
  return good && !given.starts_with("ff") && !is_zero(3, 32) && !is_zero(36, 16) ? given : "";
}

Result<std::chrono::steady_clock::time_point> deadline_of(
    const HttpRequest& request, std::chrono::steady_clock::time_point begun,
    std::chrono::milliseconds otherwise) {
  std::chrono::milliseconds deadline = otherwise;
  if (const std::string given = request.header("x-deadline-ms"); !given.empty()) {
    const double value = parse_number(given).value_or(0);
    if (!(value > 0) || value > kMaxDeadlineMs) {
      return Error{ErrorCode::usage,
                   fmt::format("X-Deadline-Ms: expected above 0 to {:.0f}, found '{}'",
                               kMaxDeadlineMs, given)};
    }
    deadline = std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(value)));
  }
  return begun + deadline;
}

}  // namespace trivet::apps::service
