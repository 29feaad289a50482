#include "apps/service/serve/routes/recognition_routes.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/serve/requests/recognition_job.hpp"
#include "apps/service/serve/requests/robot_request.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::size_t kDefaultShownPoints = 250'000, kMaxShownPoints = 5'000'000;

/// Options of a request for a scan's points.
struct PointsQuery {
  std::size_t max_points = kDefaultShownPoints;
  bool intensity = false;
};

/// Moves the options for the points out of the parameters. Errors: usage.
Result<PointsQuery> extract_points_query(Target& target) {
  PointsQuery query;
  if (const std::optional<std::string> given = target.parameter("max-points")) {
    query.max_points = whole_number(*given).value_or(0);
    if (query.max_points < 1 || query.max_points > kMaxShownPoints) {
      return Error{ErrorCode::usage, fmt::format("max-points: expected 1 to {}, found '{}'",
                                                 kMaxShownPoints, *given)};
    }
  }
  if (const std::optional<std::string> given = target.parameter("intensity")) {
    query.intensity = *given == "true" || given->empty();
    if (!query.intensity && *given != "false") {
      return Error{ErrorCode::usage,
                   fmt::format("intensity: expected true or false, found '{}'", *given)};
    }
  }
  std::erase_if(target.parameters, [](const auto& entry) {
    return entry.first == "max-points" || entry.first == "intensity";
  });
  return query;
}

/// The points of a scan as floats, up to a limit: sampled evenly over all without a pattern. A
/// point's intensity, if the cloud has it, follows its coordinates.
std::string shown_points(const Cloud& cloud, std::size_t max_points) {
  const Points& points = cloud.points;
  const std::size_t row = (cloud.intensity.empty() ? 3 : 4) * sizeof(float);
  std::string bytes;
  const double share = static_cast<double>(max_points) / static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Fibonacci hashing: the fractional parts of multiples of the golden ratio are evenly spread.
    const double place = static_cast<double>(i * 0x9E37'79B9'7F4A'7C15ULL) * 0x1p-64;
    if (place >= share || bytes.size() >= row * max_points) continue;
    const Eigen::Vector3f p = points[i];
    bytes.append(reinterpret_cast<const char*>(p.data()), 3 * sizeof(float));
    if (!cloud.intensity.empty())
      bytes.append(reinterpret_cast<const char*>(&cloud.intensity[i]), sizeof(float));
  }
  return bytes;
}

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

Result<HttpResponse> points_response(const ScanPart& scan, const PointsQuery& query,
                                     const LibraryGeneration& generation) {
  const Result<Cloud> cloud =
      read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene,
                generation.recognizer.library().header.unit, query.intensity);
  if (!cloud) return cloud.error();
  HttpResponse shown{200,
                     shown_points(*cloud, query.max_points),
                     kBytes,
                     {{"X-Points", std::to_string(cloud->points.size())}}};
  if (!cloud->intensity.empty()) shown.headers.emplace_back("X-Columns", "x,y,z,intensity");
  std::optional<Eigen::Vector3d> viewpoint = scan.scene.viewpoint;
  if (!viewpoint && cloud->viewpoint) viewpoint = cloud->viewpoint->cast<double>() + cloud->offset;
  if (viewpoint) shown.headers.emplace_back("X-Viewpoint", vector_text(*viewpoint));
  if (!cloud->offset.isZero(0)) shown.headers.emplace_back("X-Offset", vector_text(cloud->offset));
  return shown;
}

}  // namespace

Routes RecognitionRoutes::routes() const {
  using std::bind_front;
  return {
      {"POST", "/v1/recognize", false, true, Effect::reads, "recognize",
       bind_front(&RecognitionRoutes::recognize, this)},
      {"POST", "/v1/points", false, true, Effect::reads, "points",
       bind_front(&RecognitionRoutes::points, this)},
      {"POST", "/v1/robot-poses", false, true, Effect::reads, "robot_poses",
       bind_front(&RecognitionRoutes::robot_poses, this)},
  };
}

void RecognitionRoutes::recognize(const CallPtr& call, std::string_view) const {
  Result<ScanRequest> request = parse_scan_request(call->request, call->target);
  if (!request) return responder_.reply(call, error_response(request.error()));
  const auto recognition = std::make_shared<Recognition>(std::move(*request));
  responder_.run(
      call, recognition_job(recognition, metrics_),
      [call, recognition](const ServiceAnswer& answer) {
        const auto json = recognition_json(*recognition, answer, call->id);
        return json ? json_response(200, *json) : error_response(json.error());
      },
      [this, call, recognition](const ServiceAnswer& answer) {
        responder_.note_recognition(call, answer, recognition->results, recognition->failures);
      });
}

void RecognitionRoutes::points(const CallPtr& call, std::string_view) const {
  Target target = call->target;
  const Result<PointsQuery> query = extract_points_query(target);
  if (!query) return responder_.reply(call, error_response(query.error()));
  Result<ScanRequest> request = parse_scan_request(call->request, std::move(target));
  if (!request) return responder_.reply(call, error_response(request.error()));
  if (request->scans.size() != 1)
    return responder_.reply(call, error_response(400, "form: expected one part scene"));
  const ScanPart& scan = request->scans.front();
  const std::size_t part_bytes = scan_bytes(std::as_bytes(std::span(scan.bytes)), scan.name);
  responder_.run_small(
      call,
      [request = std::make_shared<ScanRequest>(*std::move(request)),
       query = *query](const LibraryGeneration& generation) {
        return points_response(request->scans.front(), query, generation);
      },
      part_bytes);
}

void RecognitionRoutes::robot_poses(const CallPtr& call, std::string_view) const {
  responder_.run_small(call, [call](const LibraryGeneration& generation) {
    return json_result(robot_poses_json(call->request.body, generation.recognizer.library()));
  });
}

}  // namespace trivet::apps::service
