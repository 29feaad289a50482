#include "apps/service/serve/served_scene.hpp"

#include <array>

#include "apps/inputs/inputs.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

using apps::parse_unit;
using apps::service::ServedScene;

constexpr std::string_view kGroup = "How the scan is read";

Option<ServedScene> camera_option() {
  return {
      {.name = "camera",
       .group = kGroup,
       .label = "camera",
       .help = "fx, fy, cx, cy [pixels] and the length of a depth step, 1 if absent; needed for "
               "depth images",
       .length = 4,
       .max_length = 5,
       .kind = OptionKind::numbers},
      [](const ServedScene& scene) {
        if (!scene.camera) return OptionValue(std::vector<double>{});
        const Camera& c = *scene.camera;
        return OptionValue(std::vector<double>{c.fx, c.fy, c.cx, c.cy, c.depth_scale});
      },
      [](ServedScene& scene, const OptionValue& value) {
        const auto& c = std::get<std::vector<double>>(value);
        scene.camera.reset();
        if (!c.empty()) scene.camera = Camera{c[0], c[1], c[2], c[3], c.size() > 4 ? c[4] : 1};
      }};
}

Option<ServedScene> viewpoint_option() {
  return {{.name = "viewpoint",
           .group = kGroup,
           .label = "viewpoint",
           .help = "Position of the sensor in the scan's frame and unit",
           .unset_help = "as the file says, else the origin",
           .length = 3,
           .kind = OptionKind::numbers},
          [](const ServedScene& scene) {
            std::vector<double> numbers;
            if (const auto& v = scene.viewpoint) numbers.assign(v->begin(), v->end());
            return OptionValue(numbers);
          },
          [](ServedScene& scene, const OptionValue& value) {
            const auto& v = std::get<std::vector<double>>(value);
            scene.viewpoint.reset();
            if (!v.empty()) scene.viewpoint = Eigen::Vector3d(v[0], v[1], v[2]);
          }};
}

Option<ServedScene> unit_option() {
  static constexpr std::array<Choice, 2> kUnits{{{"m"}, {"mm"}}};
  return {{.name = "unit",
           .group = kGroup,
           .label = "unit",
           .help = "Unit of the scan's coordinates",
           .unset_help = "the library's",
           .kind = OptionKind::choice,
           .choices = kUnits},
          [](const ServedScene& scene) {
            return OptionValue(scene.unit ? unit_name(*scene.unit) : "auto");
          },
          [](ServedScene& scene, const OptionValue& value) {
            scene.unit = parse_unit(std::get<std::string>(value));
          }};
}

}  // namespace

template <>
std::span<const Option<ServedScene>> options_of<ServedScene>() {
  static const std::array kOptions{camera_option(), viewpoint_option(), unit_option()};
  return kOptions;
}

}  // namespace trivet

namespace trivet::apps::service {
namespace {

// A small body may hold a large image, or unpack to a large file.
constexpr std::uint64_t kMaxScanPoints = 16'000'000, kMaxScanBytes = 512ULL << 20;

}  // namespace

SceneInput ServedScene::input(LengthUnit library_unit) const {
  SceneInput out;
  out.viewpoint = viewpoint;
  if (unit) out.scale = unit_scale(*unit, library_unit);
  return out;
}

Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene, LengthUnit library_unit, bool intensity) {
  return read_cloud(bytes, name,
                    {.camera = scene.camera,
                     .unit = scene.unit.value_or(library_unit),
                     .intensity = intensity,
                     .max_file_bytes = kMaxScanBytes,
                     .max_points = kMaxScanPoints,
                     .max_pixels = kMaxScanPoints});
}

}  // namespace trivet::apps::service
