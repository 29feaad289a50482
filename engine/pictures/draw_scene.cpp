#include "engine/pictures/draw_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "engine/common/parallel.hpp"
#include "engine/pictures/innermost_pixels.hpp"
#include "engine/pictures/shade.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/render_depth.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;
using engine::innermost_pixels;
using engine::kNoLabel;
using engine::shade;
using kernels::RangeImage;
using kernels::RayScene;

/// Widths of pictures [pixel]. Smaller images are enlarged by an integer factor, larger ones are
/// reduced.
struct Widths {
  std::uint32_t least, most;
  std::uint32_t outlines;  // width of an outline, as this fraction of the picture's width
};
constexpr Widths kFullImage{640, 1024, 320}, kDetail{360, 720, 130};
constexpr float kSurroundings = 1.6F;       // side of a detail, in extents of its models
constexpr std::int64_t kSmallestSide = 24;  // minimum side of a detail [pixel of the scan]
constexpr float kHiddenShare = 0.35F;       // share of a model's color where the scan occludes it
constexpr float kHiddenDepth = 0.03F;       // minimum distance of an occluding scan [diameters]
constexpr float kGrayOfUnknown = 0.35F;     // gray of a measurement without a normal
// Brightness of planes larger than the models: tables, floors, walls.
constexpr float kDimmed = 0.6F;
constexpr std::size_t kRowGrain = 32;
const Vector3f kBackground(22, 25, 31);  // no measurement
const Vector3f kScanColor(226, 228, 232);

Vector3f to_vector(const Color& color) {
  return {static_cast<float>(color.red), static_cast<float>(color.green),
          static_cast<float>(color.blue)};
}

/// A picture under construction.
struct Canvas {
  std::uint32_t width, height;
  Points rgb;  // 0..255

  Canvas(std::uint32_t w, std::uint32_t h) : width(w), height(h), rgb(std::size_t{w} * h) {}
  void blend(std::size_t pixel, const Vector3f& color, float share) {
    rgb.set(pixel, (1 - share) * rgb[pixel] + share * color);
  }
};

/// Reduce by an integer factor; each pixel is the mean of the pixels that it replaces.
Picture to_picture(const Canvas& canvas, std::uint32_t max_width) {
  const std::uint32_t factor = (canvas.width + max_width - 1) / max_width;
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

/// The image with the most measurements.
const RangeImage& fullest_image(const std::vector<RangeImage>& images) {
  const auto measured = [](const RangeImage& image) {
    return static_cast<std::ptrdiff_t>(image.depth.size()) -
           std::count(image.depth.begin(), image.depth.end(), 0.0F);
  };
  return *std::max_element(
      images.begin(), images.end(),
      [&](const RangeImage& a, const RangeImage& b) { return measured(a) < measured(b); });
}

/// Pixels of the scan from (left, top) on. The window may extend beyond the scan.
struct Window {
  std::int64_t left = 0, top = 0;
  std::uint32_t width = 0, height = 0;
};

/// The image of a picture: a window of the scan's image, with each pixel `factor` times as wide and
/// high.
struct Frame {
  static constexpr std::size_t kOutside = static_cast<std::size_t>(-1);
  const RangeImage& scan;
  Window window;
  std::uint32_t factor;
  kernels::ImageGeometry geometry;

  Frame(const RangeImage& image, const Window& part, std::uint32_t min_width)
      : scan(image),
        window(part),
        factor((min_width + part.width - 1) / part.width),
        geometry(image.geometry) {
    const auto f = static_cast<float>(factor);
    geometry.fx *= f;
    geometry.fy *= f;
    geometry.cx = f * (geometry.cx - static_cast<float>(part.left)) + 0.5F * (f - 1);
    geometry.cy = f * (geometry.cy - static_cast<float>(part.top)) + 0.5F * (f - 1);
    geometry.width = part.width * factor;
    geometry.height = part.height * factor;
  }
  /// The pixel of the scan that contains a pixel of the picture, or kOutside.
  std::size_t scan_pixel(std::size_t pixel) const noexcept {
    const auto u = window.left + static_cast<std::int64_t>(pixel % geometry.width / factor);
    const auto v = window.top + static_cast<std::int64_t>(pixel / geometry.width / factor);
    if (u < 0 || v < 0 || u >= static_cast<std::int64_t>(scan.geometry.width) ||
        v >= static_cast<std::int64_t>(scan.geometry.height)) {
      return kOutside;
    }
    return static_cast<std::size_t>(v) * scan.geometry.width + static_cast<std::size_t>(u);
  }
  /// Depth, or 0 without a measurement.
  float measured_depth(std::size_t pixel) const noexcept {
    const std::size_t own = scan_pixel(pixel);
    return own == kOutside ? 0 : scan.depth[own];
  }
};

/// Test whether a pixel of the scan lies on a plane larger than a model of this diameter.
class Background {
 public:
  Background(const engine::PreparedScene& scene, const RangeImage& image, float diameter)
      : image_(image), T_scene_camera_(image.geometry.T_camera_scene.inverse()) {
    const std::vector<std::uint8_t> large = engine::background_planes(scene, diameter);
    for (std::size_t i = 0; i < large.size(); ++i) {
      if (large[i] != 0) planes_.push_back(scene.planes[i]);
    }
  }
  bool holds(std::size_t pixel) const {
    // By distance alone, since a noisy normal would leave a bright speck.
    const Vector3f point =
        T_scene_camera_ * image_.geometry.back_project(pixel, image_.depth[pixel]);
    return std::any_of(planes_.begin(), planes_.end(), [&](const kernels::Plane& plane) {
      return std::abs(plane.normal.dot(point) - plane.offset) < 2 * plane.thickness;
    });
  }

 private:
  const RangeImage& image_;
  Pose T_scene_camera_;
  std::vector<kernels::Plane> planes_;
};

Canvas draw_scan(const Frame& frame, const Background& background) {
  Canvas canvas(frame.geometry.width, frame.geometry.height);
  for (std::size_t i = 0; i < canvas.rgb.size(); ++i) {
    if (frame.measured_depth(i) == 0) {
      canvas.rgb.set(i, kBackground);
      continue;
    }
    const std::size_t pixel = frame.scan_pixel(i);
    const Vector3f normal = frame.scan.normals[pixel];
    const float light = normal.allFinite() ? shade(normal) : kGrayOfUnknown;
    canvas.rgb.set(i, kScanColor * light * (background.holds(pixel) ? kDimmed : 1));
  }
  return canvas;
}

/// Rendering of models into the scan's image.
struct Rendering {
  std::vector<float> depth;
  std::vector<std::uint32_t> overlay;  // index among all overlays, or Hit::kNone
};

Result<RayScene> surface_of(const EvaluationMesh& mesh) {
  if (!mesh.triangles.empty()) return RayScene::from_mesh(mesh.vertices, mesh.triangles);
  // A closed surface has an area of about two squared diameters. The points of a file are
  // distributed less evenly than samples, so larger spheres leave no gaps.
  const double spacing = mesh.diameter * std::sqrt(2 / static_cast<double>(mesh.vertices.size()));
  return RayScene::from_spheres(mesh.vertices,
                                1.5F * kernels::kCloudRadius * static_cast<float>(spacing));
}

using Surfaces = std::map<const EvaluationMesh*, RayScene>;

/// Pose of an overlay in the prepared scene, in its unit.
Pose placed_in(const engine::PreparedScene& scene, const Overlay& overlay) {
  Pose pose = in_cloud_frame(overlay.T_scene_model, scene.offset);
  pose.translation() *= static_cast<float>(scene.scale);
  return pose;
}

/// Render the overlays with these indices.
Result<Rendering> render(const kernels::ImageGeometry& geometry, std::span<const Overlay> overlays,
                         std::span<const std::uint32_t> which, const engine::PreparedScene& scene,
                         Surfaces& surfaces) {
  std::vector<RayScene::Instance> instances;
  for (const std::uint32_t i : which) {
    auto found = surfaces.find(overlays[i].mesh);
    if (found == surfaces.end()) {
      TRIVET_TRY_ASSIGN(RayScene surface, surface_of(*overlays[i].mesh));
      found = surfaces.emplace(overlays[i].mesh, std::move(surface)).first;
    }
    const Pose pose = placed_in(scene, overlays[i]);
    instances.push_back({&found->second, geometry.T_camera_scene * pose});
  }
  TRIVET_TRY_ASSIGN(const RayScene rays, RayScene::from_instances(instances));

  Rendering out;
  out.depth.resize(std::size_t{geometry.width} * geometry.height);
  out.overlay.resize(out.depth.size());
  const Camera camera{static_cast<double>(geometry.fx), static_cast<double>(geometry.fy),
                      static_cast<double>(geometry.cx), static_cast<double>(geometry.cy), 1};
  engine::for_chunks(geometry.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    const std::size_t begin = first * geometry.width, size = count * geometry.width;
    kernels::render_depth(
        rays, camera, geometry.width, static_cast<std::uint32_t>(first),
        {std::span(out.depth).subspan(begin, size), std::span(out.overlay).subspan(begin, size)});
  });
  for (std::uint32_t& overlay : out.overlay) {
    if (overlay != kernels::Hit::kNone) overlay = which[overlay];
  }
  return out;
}

/// Normal of the rendered surface, toward the camera, from neighboring pixels of the same model.
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

/// Whether a pixel of a model lies within `width` pixels of anything that is not that model.
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

/// Whether the scan occludes the model at this pixel.
bool is_hidden(const Frame& frame, const Rendering& rendering, std::span<const Overlay> overlays,
               std::size_t pixel) {
  const Overlay& overlay = overlays[rendering.overlay[pixel]];
  const float measured = frame.measured_depth(pixel);
  return measured > 0 && measured < rendering.depth[pixel] -
                                        kHiddenDepth * static_cast<float>(overlay.mesh->diameter);
}

void draw_overlays(const Frame& frame, const Rendering& rendering,
                   std::span<const Overlay> overlays, std::uint32_t outlines, Canvas& canvas) {
  const kernels::ImageGeometry& geometry = frame.geometry;
  const std::int64_t outline_width = std::max<std::int64_t>(2, geometry.width / outlines);
  engine::for_chunks(geometry.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first * geometry.width; i < (first + count) * geometry.width; ++i) {
      if (rendering.overlay[i] == kernels::Hit::kNone) continue;
      const Overlay& overlay = overlays[rendering.overlay[i]];
      const bool hidden = is_hidden(frame, rendering, overlays, i);
      if (on_outline(geometry, rendering, i, outline_width)) {
        canvas.blend(i, to_vector(overlay.outline), hidden ? 0.6F : 1.0F);
      } else if (overlay.filled) {
        const Vector3f color =
            to_vector(overlay.surface) * shade(rendered_normal(geometry, rendering, i));
        canvas.blend(i, color, hidden ? kHiddenShare : 1.0F);
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

/// Place the labels of these overlays, which were rendered together, on their visible parts. Pre:
/// their boxes are known.
void place_labels(const Frame& frame, const Rendering& rendering, std::span<const Overlay> overlays,
                  std::span<const std::uint32_t> which, std::vector<DrawnBox>& boxes) {
  std::vector<std::uint32_t> visible = rendering.overlay;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    if (visible[i] != kernels::Hit::kNone && is_hidden(frame, rendering, overlays, i))
      visible[i] = kNoLabel;
  }
  const auto width = static_cast<std::size_t>(frame.geometry.width);
  const std::vector<std::optional<std::size_t>> places =
      innermost_pixels(visible, width, overlays.size());
  for (const std::uint32_t i : which) {
    DrawnBox& box = boxes[i];
    box.label_x = (box.left + box.right) / 2;
    box.label_y = (box.top + box.bottom) / 2;
    if (!places[i]) continue;
    box.label_x =
        (static_cast<float>(*places[i] % width) + 0.5F) / static_cast<float>(frame.geometry.width);
    box.label_y =
        (static_cast<float>(*places[i] / width) + 0.5F) / static_cast<float>(frame.geometry.height);
  }
}

/// The square around the vertices of the overlays in the scan's image; absent if they lie behind
/// the sensor.
std::optional<Window> window_around(const kernels::ImageGeometry& geometry,
                                    std::span<const Overlay> overlays,
                                    const engine::PreparedScene& scene) {
  Eigen::AlignedBox2f box;
  for (const Overlay& overlay : overlays) {
    const Pose T_camera_model = geometry.T_camera_scene * placed_in(scene, overlay);
    for (std::size_t i = 0; i < overlay.mesh->vertices.size(); ++i) {
      const Vector3f p = T_camera_model * overlay.mesh->vertices[i];
      if (!(p.z() > 0)) continue;
      box.extend(Eigen::Vector2f(geometry.fx * p.x() / p.z() + geometry.cx,
                                 geometry.fy * p.y() / p.z() + geometry.cy));
    }
  }
  if (box.isEmpty()) return std::nullopt;
  const auto image = static_cast<float>(std::max(geometry.width, geometry.height));
  const auto side =
      std::max(kSmallestSide,
               static_cast<std::int64_t>(std::min(image, kSurroundings * box.sizes().maxCoeff())));
  const Eigen::Vector2f middle = box.center().cwiseMax(-image).cwiseMin(2 * image);
  return Window{static_cast<std::int64_t>(middle.x()) - side / 2,
                static_cast<std::int64_t>(middle.y()) - side / 2, static_cast<std::uint32_t>(side),
                static_cast<std::uint32_t>(side)};
}

}  // namespace

struct SceneDrawing::State {
  State(engine::PreparedScene scene, float largest_diameter)
      : prepared(std::move(scene)),
        image(fullest_image(prepared.images)),
        background(prepared, image, largest_diameter) {}

  Result<ScenePictures> draw(std::span<const Overlay> overlays, const Window& window,
                             const Widths& widths) {
    const Frame frame(image, window, widths.least);
    ScenePictures out;
    out.boxes.resize(overlays.size());
    Canvas canvas = draw_scan(frame, background);
    out.scan = to_picture(canvas, widths.most);
    const auto add = [&](std::span<const std::uint32_t> which) -> Result<void> {
      TRIVET_TRY_ASSIGN(const Rendering rendering,
                        render(frame.geometry, overlays, which, prepared, surfaces));
      draw_overlays(frame, rendering, overlays, widths.outlines, canvas);
      extend_boxes(frame.geometry, rendering, out.boxes);
      place_labels(frame, rendering, overlays, which, out.boxes);
      return {};
    };
    std::vector<std::uint32_t> filled;
    for (std::uint32_t i = 0; i < overlays.size(); ++i) {
      if (overlays[i].filled) filled.push_back(i);
    }
    TRIVET_TRY(add(filled));
    for (std::uint32_t i = 0; i < overlays.size(); ++i) {
      // One at a time, since outlines of similar poses would interrupt each other.
      if (overlays[i].filled) continue;
      if (const Result<void> done = add({&i, 1}); !done) return done.error();
    }
    out.overlaid = to_picture(canvas, widths.most);
    return out;
  }

  engine::PreparedScene prepared;
  const RangeImage& image;
  Background background;
  Surfaces surfaces;
};

SceneDrawing::SceneDrawing(std::unique_ptr<State> state) : state_(std::move(state)) {}
SceneDrawing::SceneDrawing(SceneDrawing&&) noexcept = default;
SceneDrawing& SceneDrawing::operator=(SceneDrawing&&) noexcept = default;
SceneDrawing::~SceneDrawing() = default;

Result<SceneDrawing> SceneDrawing::prepare(const Cloud& cloud, const SceneInput& input,
                                           float largest_diameter) {
  StageTimes times;
  TRIVET_TRY_ASSIGN(engine::PreparedScene prepared, engine::prepare_scene(cloud, input, times));
  return SceneDrawing(std::make_unique<State>(std::move(prepared), largest_diameter));
}

Result<ScenePictures> SceneDrawing::draw(std::span<const Overlay> overlays) {
  const kernels::ImageGeometry& geometry = state_->image.geometry;
  return state_->draw(overlays, {0, 0, geometry.width, geometry.height}, kFullImage);
}

Result<ScenePictures> SceneDrawing::draw_around(std::span<const Overlay> models,
                                                std::span<const Overlay> overlays) {
  const std::optional<Window> window =
      window_around(state_->image.geometry, models, state_->prepared);
  if (!window) {
    return Error{ErrorCode::bad_data,
                 "expected models in front of the sensor to draw, found none; check the poses"};
  }
  return state_->draw(overlays, *window, kDetail);
}

}  // namespace trivet
