#include "apps/service/serve/routes/session_json.hpp"

#include <utility>

#include "apps/service/serve/requests/reading_query.hpp"

namespace trivet::apps::service {
namespace {

unsigned status_of(SessionFault fault) {
  switch (fault) {
    case SessionFault::invalid:
      return 400;
    case SessionFault::unknown:
      return 404;
    case SessionFault::exists:
    case SessionFault::stale:
      return 409;
    case SessionFault::too_large:
      return 413;
    case SessionFault::full:
      return 507;
    case SessionFault::failed:
      return 500;
  }
  return 500;
}

nlohmann::ordered_json run_json(const std::string& name,
                                const std::map<std::string, SessionAnswer>& answers) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [scan, answer] : answers) {
    nlohmann::ordered_json seconds;
    if (answer.seconds) seconds = *answer.seconds;
    list.push_back({{"scan", scan}, {"found", answer.num_found}, {"seconds", std::move(seconds)}});
  }
  return {{"name", name}, {"answers", std::move(list)}};
}

}  // namespace

nlohmann::ordered_json scan_json(const KeptScan& kept) {
  return {{"name", kept.name},
          {"bytes", kept.num_bytes},
          {"query", reading_query(kept.scan.listed, kept.unit)},
          {"truth", truth_json(kept.scan)},
          {"version", truth_version(kept.scan)}};
}

nlohmann::ordered_json session_json(const SessionContents& contents, std::uint64_t max_bytes) {
  using Json = nlohmann::ordered_json;
  Json scans = Json::array(), runs = Json::array(), faults = Json::array();
  for (const auto& [name, scan] : contents.scans)
    scans.push_back(scan_json({name, contents.files.at(scan.listed.name), contents.unit, scan}));
  for (const auto& [name, answers] : contents.runs) runs.push_back(run_json(name, answers));
  for (const DamagedFile& damaged : contents.damaged)
    faults.push_back({{"file", damaged.file}, {"reason", damaged.reason}});
  return {{"kept", true},
          {"unit", unit_name(contents.unit)},
          {"bytes", {{"used", bytes_on_disk(contents)}, {"allowed", max_bytes}}},
          {"scans", std::move(scans)},
          {"runs", std::move(runs)},
          {"faults", std::move(faults)}};
}

Result<HttpResponse> session_error_response(const SessionError& error) {
  if (error.fault == SessionFault::failed) return error.error;
  nlohmann::ordered_json json{{"error", error.error.message}};
  if (error.kept_scan) json["scan"] = scan_json(*error.kept_scan);
  if (error.kept_answer) {
    json["version"] = error.kept_answer->version;
    json["answer"] = error.kept_answer->document;
  }
  return json_response(status_of(error.fault), json);
}

}  // namespace trivet::apps::service
