/// Shading of surfaces in pictures.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace trivet::engine {

/// Lambert's law with some ambient light; the light is above the left shoulder of the camera.
/// normal  unit, toward the camera, in its frame (x right, y down, z away)
inline float shade(const Eigen::Vector3f& normal) {
  constexpr float kAmbient = 0.2F;
  static const Eigen::Vector3f kToLight = Eigen::Vector3f(-0.35F, -0.55F, -0.76F).normalized();
  return kAmbient + (1 - kAmbient) * std::max(0.0F, normal.dot(kToLight));
}

}  // namespace trivet::engine
