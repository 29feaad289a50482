#include "apps/service/serve/requests/served_scene.hpp"

#include <array>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "storage/formats/declared_size.hpp"
#include "storage/formats/read_cloud.hpp"

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

Option<ServedScene> depth_option() {
  static constexpr std::array<Choice, 2> kKinds{
      {{"z", "along the camera's axis"}, {"ray", "from the camera, along the ray"}}};
  return {
      {.name = "depth",
       .group = kGroup,
       .label = "depth",
       .help = "What the values of a depth image measure",
       .kind = OptionKind::choice,
       .choices = kKinds},
      [](const ServedScene& scene) {
        return OptionValue(std::string(kKinds[static_cast<std::size_t>(scene.image.depth)].name));
      },
      [](ServedScene& scene, const OptionValue& value) {
        scene.image.depth = std::get<std::string>(value) == "ray" ? DepthKind::ray : DepthKind::z;
      }};
}

Option<ServedScene> distortion_option() {
  return {{.name = "distortion",
           .group = kGroup,
           .label = "distortion",
           .help = "Of a depth image, as Brown and Conrady: k1, k2, p1, p2, k3, k4, k5, k6, those "
                   "left out 0; undone when the image is read",
           .unset_help = "none",
           .length = 4,
           .max_length = 8,
           .kind = OptionKind::numbers},
          [](const ServedScene& scene) {
            const LensDistortion& d = scene.image.distortion;
            if (d.none()) return OptionValue(std::vector<double>{});
            return OptionValue(std::vector{d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6});
          },
          [](ServedScene& scene, const OptionValue& value) {
            std::vector<double> c = std::get<std::vector<double>>(value);
            c.resize(8, 0);
            scene.image.distortion = {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]};
          }};
}

Option<ServedScene> image_size_option() {
  return {{.name = "image-size",
           .group = kGroup,
           .label = "image size",
           .help = "Width and height that the camera is of [pixels]; a depth image of another size "
                   "is refused",
           .unset_help = "that of the image",
           .range = {.low = 1, .high = 1e6},
           .length = 2,
           .kind = OptionKind::numbers},
          [](const ServedScene& scene) {
            if (scene.image.width == 0) return OptionValue(std::vector<double>{});
            return OptionValue(std::vector<double>{static_cast<double>(scene.image.width),
                                                   static_cast<double>(scene.image.height)});
          },
          [](ServedScene& scene, const OptionValue& value) {
            const auto& size = std::get<std::vector<double>>(value);
            scene.image.width = size.empty() ? 0 : static_cast<std::uint32_t>(size[0]);
            scene.image.height = size.empty() ? 0 : static_cast<std::uint32_t>(size[1]);
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
  static const std::array kOptions{camera_option(),     depth_option(),     distortion_option(),
                                   image_size_option(), viewpoint_option(), unit_option()};
  return kOptions;
}

}  // namespace trivet

namespace trivet::apps::service {
namespace {

// A small body may contain a large image, or decompress to a large file.
constexpr std::uint64_t kMaxScanPoints = 16'000'000, kMaxScanBytes = 512ULL << 20;

// Peak resident memory of `trivet --threads 1 recognize` per point, in excess of that without a
// scene and of the file: 88 bytes for depth images of 1, 4 and 16 million pixels, however many are
// valid, 89 and 80 for 1 and 4 million scattered points, 84 and 88 per vertex or face of meshes of
// 3 and 12 million.
constexpr std::uint64_t kBytesPerPoint = 100, kSceneBytes = 16ULL << 20;

ReadOptions read_options() {
  return {
      .max_file_bytes = kMaxScanBytes, .max_points = kMaxScanPoints, .max_pixels = kMaxScanPoints};
}

}  // namespace

std::size_t scene_bytes(std::uint64_t num_points) {
  return kSceneBytes + kBytesPerPoint * num_points;
}

std::size_t scan_bytes(std::span<const std::byte> bytes, const std::string& name) {
  const DeclaredSize size = declared_size(bytes, name, read_options());
  return scene_bytes(size.num_points) + size.unpacked_bytes;
}

SceneInput ServedScene::input(LengthUnit library_unit) const {
  SceneInput out;
  out.viewpoint = viewpoint;
  if (unit) out.scale = unit_scale(*unit, library_unit);
  return out;
}

Result<void> ServedScene::complete_camera() {
  if (camera) {
    camera->depth = image.depth;
    camera->distortion = image.distortion;
    camera->width = image.width;
    camera->height = image.height;
    return {};
  }
  if (image == Camera{}) return {};
  return Error{ErrorCode::usage,
               "depth, distortion, image-size: expected the camera beside them, found none"};
}

Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene, LengthUnit library_unit, bool intensity) {
  ReadOptions options = read_options();
  options.camera = scene.camera;
  options.unit = scene.unit.value_or(library_unit);
  options.intensity = intensity;
  return read_cloud(bytes, name, options);
}

}  // namespace trivet::apps::service
