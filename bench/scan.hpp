/// The scan used by all rows, and the errors of normals and neighbors relative to its truth.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::bench {

/// An organized scan of a room's corner with a ball in it, by a pinhole camera at the origin.
struct Scan {
  PixelGrid grid;
  Points points;          ///< [m], with 1 mm noise in depth
  Normals truth;          // /< normals of the surface without noise, towards the camera
  float footprint_m = 0;  ///< between pixels at 1 m
};

/// The 4 : 3 scan with this width; the same on every call.
const Scan& scan_of_width(std::int64_t width);

/// Radius of neighborhoods of about 40 points at any scan size [m].
float search_radius(const Scan& scan);

/// Root mean square angle between unoriented normals and the truth [degree]; NaN normals are
/// ignored.
double angle_rmse_deg(const Scan& scan, NormalsView normals);

/// Widths for 4,800, 19,200, 76,800, 307,200 and 1,228,800 points: from within the second-level
/// cache to beyond the last-level cache.
inline constexpr std::int64_t kWidths[] = {80, 160, 320, 640, 1280};
inline constexpr std::int64_t kNaiveWidth =
    80;  // /< the quadratic reference takes a second at this width

}  // namespace trivet::bench
