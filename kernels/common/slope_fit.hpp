/// Least-squares plane through heights over a grid, from sums.
#pragma once

namespace trivet::kernels {

/// Sums over n positions (x, y) with heights r.
struct SlopeSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, r = 0, rx = 0, ry = 0;
};

/// The fitted plane r = mean + gx (x - mean x) + gy (y - mean y).
struct SlopeFit {
  double gx, gy;       ///< slopes; not finite if the determinant is 0
  double xx, yy;       ///< sums of squares about the mean position
  double explained;    ///< part of the sum of squares of r about its mean that the slopes explain
  double determinant;  ///< xx yy - xy^2: determinant of the equations for the slopes
};

/// Pre: n > 0.
inline SlopeFit fit_slope(const SlopeSums& s) noexcept {
  const double xx = s.xx - s.x * s.x / s.n, yy = s.yy - s.y * s.y / s.n;
  const double xy = s.xy - s.x * s.y / s.n;
  const double rx = s.rx - s.r * s.x / s.n, ry = s.ry - s.r * s.y / s.n;
  const double determinant = xx * yy - xy * xy;
  const double gx = (rx * yy - ry * xy) / determinant, gy = (ry * xx - rx * xy) / determinant;
  return {gx, gy, xx, yy, gx * rx + gy * ry, determinant};
}

}  // namespace trivet::kernels
