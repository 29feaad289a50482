#include "engine/draw_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/parallel.hpp"
#include "engine/prepare_scene.hpp"
#include "kernels/ray_scene.hpp"
#include "kernels/render_depth.hpp"
#include "kernels/visibility.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;
using kernels::RangeImage;
using kernels::RayScene;

constexpr std::uint32_t kMinWidth =
    640;  // [pixel]; smaller images are drawn with several pixels for one
constexpr std::uint32_t kMaxWidth = 1024;  // larger pictures are shrunk
constexpr float kAmbient = 0.2F;
constexpr float kHiddenShare = 0.35F;    // of a model's colour where the scan is in front
constexpr float kHiddenDepth = 0.03F;    // in front: by so many diameters
constexpr float kGreyOfUnknown = 0.35F;  // measured, but without a normal
constexpr float kDimmed = 0.6F;          // planes larger than the models: tables, floors, walls
constexpr std::size_t kRowGrain = 32;
const Vector3f kBackground(22, 25, 31);  // no measurement
const Vector3f kScanColour(226, 228, 232);

Vector3f to_vector(const Colour& colour) {
  return {static_cast<float>(colour.red), static_cast<float>(colour.green),
          static_cast<float>(colour.blue)};
}

/// Lambert's law, the light above the left shoulder of the camera.
float shade(const Vector3f& normal) {
  static const Vector3f kToLight = Vector3f(-0.35F, -0.55F, -0.76F).normalized();
  return kAmbient + (1 - kAmbient) * std::max(0.0F, normal.dot(kToLight));
}

/// A picture under construction.
struct Canvas {
  std::uint32_t width, height;
  Points rgb;  // 0..255

  Canvas(std::uint32_t w, std::uint32_t h) : width(w), height(h), rgb(std::size_t{w} * h) {}
  void blend(std::size_t pixel, const Vector3f& colour, float share) {
    rgb.set(pixel, (1 - share) * rgb[pixel] + share * colour);
  }
};

/// Shrink by a whole factor, each pixel the mean of those it stands for.
Picture to_picture(const Canvas& canvas) {
  const std::uint32_t factor = (canvas.width + kMaxWidth - 1) / kMaxWidth;
  Picture picture{std::max(1U, canvas.width / factor), std::max(1U, canvas.height / factor), {}};
  picture.rgb.reserve(std::size_t{3} * picture.width * picture.height);
  for (std::uint32_t v = 0; v < picture.height; ++v) {
    for (std::uint32_t u = 0; u < picture.width; ++u) {
      Vector3f sum = Vector3f::Zero();
      float n = 0;
      for (std::uint32_t y = v * factor; y < std::min((v + 1) * factor, canvas.height); ++y) {
        for (std::uint32_t x = u * factor; x < std::min((u + 1) * factor, canvas.width); ++x, ++n) {
          sum += canvas.rgb[std::size_t{y} * canvas.width + x];
        }
      }
      for (const float value : {sum.x() / n, sum.y() / n, sum.z() / n}) {
        picture.rgb.push_back(static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F)));
      }
    }
  }
  return picture;
}

/// The image with the most to be seen.
const RangeImage& fullest_image(const std::vector<RangeImage>& images) {
  const auto measured = [](const RangeImage& image) {
    return static_cast<std::ptrdiff_t>(image.depth.size()) -
           std::count(image.depth.begin(), image.depth.end(), 0.0F);
  };
  return *std::max_element(
      images.begin(), images.end(),
      [&](const RangeImage& a, const RangeImage& b) { return measured(a) < measured(b); });
}

/// The image that a picture is drawn in: that of the scan, each pixel `factor` times as wide and
/// high.
struct Frame {
  const RangeImage& scan;
  std::uint32_t factor;
  kernels::ImageGeometry geometry;

  explicit Frame(const RangeImage& image)
      : scan(image),
        factor((kMinWidth + image.geometry.width - 1) / image.geometry.width),
        geometry(image.geometry) {
    const auto f = static_cast<float>(factor);
    geometry.fx *= f;
    geometry.fy *= f;
    geometry.cx = f * geometry.cx + 0.5F * (f - 1);
    geometry.cy = f * geometry.cy + 0.5F * (f - 1);
    geometry.width *= factor;
    geometry.height *= factor;
  }
  /// Pixel of the scan that one of the picture lies in.
  std::size_t scan_pixel(std::size_t pixel) const noexcept {
    const std::size_t u = pixel % geometry.width, v = pixel / geometry.width;
    return v / factor * scan.geometry.width + u / factor;
  }
};

/// Whether a pixel of the scan lies on a plane larger than a model of this diameter.
class Background {
 public:
  Background(const engine::PreparedScene& scene, const RangeImage& image, float diameter)
      : image_(image),
        T_scene_camera_(image.geometry.T_camera_scene.inverse()),
        tolerance_(scene.plane_tolerance) {
    const std::vector<std::uint8_t> large = engine::background_planes(scene, diameter);
    for (std::size_t i = 0; i < large.size(); ++i) {
      if (large[i] != 0) planes_.push_back(scene.planes[i]);
    }
  }
  bool holds(std::size_t pixel) const {
    // By distance alone: a normal that noise has turned would leave a bright speck.
    const Vector3f point =
        T_scene_camera_ * image_.geometry.back_project(pixel, image_.depth[pixel]);
    return std::any_of(planes_.begin(), planes_.end(), [&](const kernels::Plane& plane) {
      return std::abs(plane.normal.dot(point) - plane.offset) < 2 * tolerance_;
    });
  }

 private:
  const RangeImage& image_;
  Pose T_scene_camera_;
  float tolerance_;
  std::vector<kernels::Plane> planes_;
};

Canvas draw_scan(const Frame& frame, const Background& background) {
  Canvas canvas(frame.geometry.width, frame.geometry.height);
  for (std::size_t i = 0; i < canvas.rgb.size(); ++i) {
    const std::size_t pixel = frame.scan_pixel(i);
    if (frame.scan.depth[pixel] == 0) {
      canvas.rgb.set(i, kBackground);
      continue;
    }
    const Vector3f normal = frame.scan.normals[pixel];
    const float light = normal.allFinite() ? shade(normal) : kGreyOfUnknown;
    canvas.rgb.set(i, kScanColour * light * (background.holds(pixel) ? kDimmed : 1));
  }
  return canvas;
}

/// Models rendered into the scan's image.
struct Rendering {
  std::vector<float> depth;
  std::vector<std::uint32_t> overlay;  // index among all overlays; Hit::kNone
};

Result<RayScene> surface_of(const Model& model) {
  if (!model.triangles.empty()) return RayScene::from_mesh(model.vertices, model.triangles);
  return RayScene::from_spheres(model.samples, kernels::kCloudRadius * model.sample_spacing);
}

/// Render those overlays that are filled, or those that are not.
Result<Rendering> render(const kernels::ImageGeometry& geometry, std::span<const Overlay> overlays,
                         double scene_scale, bool filled) {
  std::map<const Model*, RayScene> surfaces;
  std::vector<RayScene::Instance> instances;
  std::vector<std::uint32_t> which;
  for (std::size_t i = 0; i < overlays.size(); ++i) {
    if (overlays[i].filled != filled) continue;
    auto found = surfaces.find(overlays[i].model);
    if (found == surfaces.end()) {
      Result<RayScene> surface = surface_of(*overlays[i].model);
      if (!surface) return surface.error();
      found = surfaces.emplace(overlays[i].model, std::move(*surface)).first;
    }
    Pose pose = overlays[i].T_scene_model;
    pose.translation() *= static_cast<float>(scene_scale);
    instances.push_back({&found->second, geometry.T_camera_scene * pose});
    which.push_back(static_cast<std::uint32_t>(i));
  }
  const Result<RayScene> rays = RayScene::from_instances(instances);
  if (!rays) return rays.error();

  Rendering out;
  out.depth.resize(std::size_t{geometry.width} * geometry.height);
  out.overlay.resize(out.depth.size());
  const Camera camera{static_cast<double>(geometry.fx), static_cast<double>(geometry.fy),
                      static_cast<double>(geometry.cx), static_cast<double>(geometry.cy), 1};
  engine::for_chunks(geometry.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    const std::size_t begin = first * geometry.width, size = count * geometry.width;
    kernels::render_depth(*rays, camera, geometry.width, static_cast<std::uint32_t>(first),
                          std::span(out.depth).subspan(begin, size),
                          std::span(out.overlay).subspan(begin, size));
  });
  for (std::uint32_t& overlay : out.overlay) {
    if (overlay != kernels::Hit::kNone) overlay = which[overlay];
  }
  return out;
}

/// Of the rendered surface, from its neighbours in the image that belong to the same model; towards
/// the camera.
Vector3f rendered_normal(const kernels::ImageGeometry& geometry, const Rendering& rendering,
                         std::size_t pixel) {
  const std::size_t u = pixel % geometry.width, v = pixel / geometry.width;
  const auto same = [&](std::size_t other) {
    return rendering.overlay[other] == rendering.overlay[pixel];
  };
  const auto difference = [&](bool before, bool after, std::size_t step) -> Vector3f {
    const std::size_t a = before && same(pixel - step) ? pixel - step : pixel;
    const std::size_t b = after && same(pixel + step) ? pixel + step : pixel;
    return geometry.back_project(b, rendering.depth[b]) -
           geometry.back_project(a, rendering.depth[a]);
  };
  const Vector3f across = difference(u > 0, u + 1 < geometry.width, 1);
  const Vector3f down = difference(v > 0, v + 1 < geometry.height, geometry.width);
  const Vector3f normal = down.cross(across);
  return normal.squaredNorm() > 0 ? normal.normalized() : -Vector3f::UnitZ();
}

/// Whether a pixel of a model lies within `width` pixels of what is not that model.
bool on_outline(const kernels::ImageGeometry& geometry, const Rendering& rendering,
                std::size_t pixel, std::int64_t width) {
  const auto u = static_cast<std::int64_t>(pixel % geometry.width),
             v = static_cast<std::int64_t>(pixel / geometry.width);
  for (std::int64_t y = v - width; y <= v + width; ++y) {
    for (std::int64_t x = u - width; x <= u + width; ++x) {
      if ((x - u) * (x - u) + (y - v) * (y - v) > width * width) continue;
      if (x < 0 || y < 0 || x >= geometry.width || y >= geometry.height) return true;
      if (rendering.overlay[static_cast<std::size_t>(y * geometry.width + x)] !=
          rendering.overlay[pixel])
        return true;
    }
  }
  return false;
}

void draw_overlays(const Frame& frame, const Rendering& rendering,
                   std::span<const Overlay> overlays, Canvas& canvas) {
  const kernels::ImageGeometry& geometry = frame.geometry;
  const std::int64_t outline_width = std::max<std::int64_t>(1, (geometry.width + 200) / 320);
  engine::for_chunks(geometry.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first * geometry.width; i < (first + count) * geometry.width; ++i) {
      if (rendering.overlay[i] == kernels::Hit::kNone) continue;
      const Overlay& overlay = overlays[rendering.overlay[i]];
      const float measured = frame.scan.depth[frame.scan_pixel(i)];
      const bool hidden =
          measured > 0 && measured < rendering.depth[i] - kHiddenDepth * overlay.model->diameter;
      if (on_outline(geometry, rendering, i, outline_width)) {
        canvas.blend(i, to_vector(overlay.outline), hidden ? 0.6F : 1.0F);
      } else if (overlay.filled) {
        const Vector3f colour =
            to_vector(overlay.surface) * shade(rendered_normal(geometry, rendering, i));
        canvas.blend(i, colour, hidden ? kHiddenShare : 1.0F);
      }
    }
  });
}

void extend_boxes(const kernels::ImageGeometry& geometry, const Rendering& rendering,
                  std::vector<DrawnBox>& boxes) {
  for (std::size_t i = 0; i < rendering.overlay.size(); ++i) {
    if (rendering.overlay[i] == kernels::Hit::kNone) continue;
    DrawnBox& box = boxes[rendering.overlay[i]];
    const auto width = static_cast<float>(geometry.width),
               height = static_cast<float>(geometry.height);
    const auto u = static_cast<float>(i % geometry.width),
               v = static_cast<float>(i / geometry.width);
    box.left = std::min(box.left, u / width);
    box.right = std::max(box.right, (u + 1) / width);
    box.top = std::min(box.top, v / height);
    box.bottom = std::max(box.bottom, (v + 1) / height);
  }
}

}  // namespace

Result<ScenePictures> draw_scene(const Cloud& cloud, const SceneInput& input,
                                 std::span<const Overlay> overlays) {
  StageTimes times;
  const Result<engine::PreparedScene> prepared = engine::prepare_scene(cloud, input, times);
  if (!prepared) return prepared.error();
  const Frame frame(fullest_image(prepared->images));
  float largest = 0;
  for (const Overlay& overlay : overlays) largest = std::max(largest, overlay.model->diameter);
  ScenePictures out;
  out.boxes.resize(overlays.size());
  Canvas canvas = draw_scan(frame, Background(*prepared, frame.scan, largest));
  out.scan = to_picture(canvas);
  for (const bool filled : {true, false}) {
    const Result<Rendering> rendering = render(frame.geometry, overlays, input.scale, filled);
    if (!rendering) return rendering.error();
    draw_overlays(frame, *rendering, overlays, canvas);
    extend_boxes(frame.geometry, *rendering, out.boxes);
  }
  out.overlaid = to_picture(canvas);
  return out;
}

}  // namespace trivet
