#include "kernels/verification/object_scale.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/verification/ray_crop.hpp"

namespace trivet::kernels {
namespace {

using Vector8 = ObjectEquations::Vector8;

constexpr float kCoarsePixel = 0.3F;  // cosine below which half a pixel exceeds the noise
constexpr int kBlock = 16;            // [pixel]; errors of real cameras are correlated over 8
// Special values of a residual.
constexpr float kEdge =
    std::numeric_limits<float>::infinity();  // the model ends, or is not visible
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The geometry of an image with a focal scale applied.
ImageGeometry scaled(ImageGeometry geometry, double log_focal) {
  const auto factor = static_cast<float>(std::exp(log_focal));
  geometry.fx *= factor;
  geometry.fy *= factor;
  return geometry;
}

/// The part of a box within `reach` of the image. The ball of a diverging pose next to the camera
/// may cover millions of pixels.
PixelBox within_image(const PixelBox& box, const ImageGeometry& g, int reach) {
  const auto beside = static_cast<float>(reach);
  return {std::max(box.u0, -beside), std::max(box.v0, -beside),
          std::min(box.u1, static_cast<float>(g.width) + beside),
          std::min(box.v1, static_cast<float>(g.height) + beside)};
}

/// Residual of the measurement along a ray from the model's surface, perpendicular to it.
float residual_at(const RangeImage& image, const ExpectedPoint& expected, float depth_factor,
                  float gate) {
  const auto [u, v, z, along] = expected;
  const ImageGeometry& g = image.geometry;
  if (!std::isfinite(z) || u < 0 || v < 0 || u >= static_cast<int>(g.width) ||
      v >= static_cast<int>(g.height))
    return kEdge;
  const float d = image.depth[static_cast<std::size_t>(v) * g.width + static_cast<std::size_t>(u)];
  if (!(d > 0)) return kUnknown;
  const float r = (d * depth_factor - z) * along;
  return std::abs(r) < gate ? r : kEdge;
}

bool is_near_edge(const RayCrop& crop, const Column<float>& residuals, int i, int j, int reach) {
  if (i < reach || j < reach || i + reach >= crop.width || j + reach >= crop.height) return true;
  for (int y = j - reach; y <= j + reach; ++y) {
    for (int x = i - reach; x <= i + reach; ++x) {
      if (residuals[crop.at(x, y)] == kEdge) return true;
    }
  }
  return false;
}

/// Derivative of a residual at the point `met` of a surface with the normal `n`.
Vector8 derivative(const Eigen::Vector3d& met, const Eigen::Vector3d& center,
                   const Eigen::Vector3d& n) {
  Vector8 J;
  J << n.cross(met - center), -n, -(n.x() * met.x() + n.y() * met.y()), n.dot(met);
  return J;
}

}  // namespace

void gather_object(const RangeImage& image, const ObjectInView& object, const LogScales& scales,
                   const ScaleOptions& options, ScaleScratch& s, ObjectEquations& out) {
  out = {};
  const Pose& T_camera_model = object.T_camera_model;
  const ImageGeometry g = scaled(image.geometry, scales.focal);
  const auto depth_factor = static_cast<float>(std::exp(scales.depth));
  const Eigen::Vector3f center = T_camera_model * object.samples.center;
  const std::optional<PixelBox> box = project_ball(g, center, 0.5F * ball_diameter(object.samples));
  if (!box) return;
  const RayCrop crop(within_image(*box, g, options.edge_pixels), 1);
  out.num_rays = crop.size();
  shoot_rays(g, crop, object.surface, T_camera_model, s.directions, s.hits);
  const Column<float>& depths = s.hits.depths;
  Normals& normals = s.hits.normals;

  // Rotate normals to the camera's frame and orient them to its side.
  const Eigen::Matrix3f R = T_camera_model.linear();
  s.residuals.resize(crop.size());
  for (int j = 0; j < crop.height; ++j) {
    for (int i = 0; i < crop.width; ++i) {
      const std::size_t at = crop.at(i, j);
      if (!std::isfinite(depths[at])) {
        s.residuals[at] = kEdge;
        continue;
      }
      const Eigen::Vector3f ray = ray_through(g, crop.u(i), crop.v(j));
      const Eigen::Vector3f normal = (R * normals[at]).normalized();
      const float along = std::abs(normal.dot(ray));
      normals.set(at, normal.dot(ray) > 0 ? Eigen::Vector3f(-normal) : normal);
      s.residuals[at] =
          residual_at(image, {crop.u(i), crop.v(j), depths[at], along}, depth_factor, options.gate);
      if (s.residuals[at] != kEdge && !(along > kCoarsePixel * ray.norm()))
        s.residuals[at] = kUnknown;
    }
  }

  const int reach = (options.edge_pixels + crop.stride - 1) / crop.stride;
  const int blocks_wide = crop.width * crop.stride / kBlock + 1;
  const int blocks_high = crop.height * crop.stride / kBlock + 1;
  out.blocks.assign(static_cast<std::size_t>(blocks_wide * blocks_high), Vector8::Zero());
  const auto sigma = static_cast<double>(options.sigma);
  for (int j = 0; j < crop.height; ++j) {
    for (int i = 0; i < crop.width; ++i) {
      const std::size_t at = crop.at(i, j);
      if (!std::isfinite(s.residuals[at]) || is_near_edge(crop, s.residuals, i, j, reach)) continue;
      const Eigen::Vector3f met = depths[at] * ray_through(g, crop.u(i), crop.v(j));
      const Vector8 J =
          derivative(met.cast<double>(), center.cast<double>(), normals[at].cast<double>());
      const double r = -static_cast<double>(s.residuals[at]);  // the residual beyond the surface is
                                                               // opposite to the normal
      const double share = r / static_cast<double>(options.gate);
      const double root = (1 - share * share) / sigma;
      const Vector8 pull = -root * root * r * J;
      out.information.noalias() += root * root * J * J.transpose();
      out.pull += pull;
      out.blocks[static_cast<std::size_t>(j * crop.stride / kBlock * blocks_wide +
                                          i * crop.stride / kBlock)] += pull;
      ++out.num_used;
    }
  }
}

}  // namespace trivet::kernels
