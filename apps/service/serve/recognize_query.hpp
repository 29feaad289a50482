/// What a client may ask of a recognition: the options of `trivet recognize`, and how its scan is
/// to be read.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/service/http/query.hpp"
#include "engine/recognize.hpp"
#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

/// How a scan is to be read.
struct ServedScene {
  std::optional<Camera> camera{};
  std::optional<Eigen::Vector3f> viewpoint{};  ///< of the sensor, in the scan's frame and unit
  std::optional<LengthUnit> unit{};            ///< absent: the library's

  SceneInput input(LengthUnit library_unit) const;
};

struct RecognizeQuery {
  RecognizeOptions options;
  ServedScene scene;
};

/// The options have the names, ranges and faults that they have on the command line. Beside them
/// camera (fx,fy,cx,cy and the depth scale, 1 if absent), viewpoint (x,y,z), unit (m or mm),
/// rejected (poses per model that are told with the reason, 0 to 100) and claims (tell what a
/// router merges by). Errors: usage.
Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters);

/// The names that parse_recognize_query knows, sorted.
std::vector<std::string> recognize_parameter_names();

/// Read a scan of at most 16 million points or pixels. `name` stands for it in messages and tells
/// the format by its extension. Errors: those of read_cloud.
Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene);

}  // namespace trivet::apps::service
