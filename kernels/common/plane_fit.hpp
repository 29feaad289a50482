/// Least-squares plane from sums over points relative to a nearby origin.
#pragma once

#include <algorithm>
#include <cmath>

namespace trivet::kernels {

/// Sums over points p, each relative to one origin near them.
struct PlaneSums {
  double n, x, y, z, xx, xy, xz, yy, yz, zz;
};

struct PlaneFit {
  double x, y, z;   ///< unit normal; its sign is arbitrary
  double residual;  ///< root mean square distance of the points to the plane
  bool determined;  ///< false: fewer than 3 points, or all collinear (see fit_plane)
};

/// Fit a plane: its normal is the direction of least spread about the mean.
///
/// Undetermined if the points spread along one line only: the second-largest standard deviation is
/// below about a thousandth of the largest. If the two smallest spreads are equal (a thick rod, a
/// solid ball), the result is one of the directions of least spread.
/// Branch-free, so that loops over it vectorize.
/// Source: Hoppe et al., SIGGRAPH 1992, tangent plane estimation. The smallest eigenvalue is the
/// smallest root of the characteristic polynomial, which Newton's method reaches from 0 upwards.
/// The normal is a column of the adjugate of C - lambda I, whose columns are all multiples of it.
inline PlaneFit fit_plane(const PlaneSums& s) {
  // Covariance about the mean, scaled to trace 1.
  const double inverse_n = 1 / std::max(s.n, 1.0);
  const double mx = s.x * inverse_n, my = s.y * inverse_n, mz = s.z * inverse_n;
  const double vx = s.xx * inverse_n - mx * mx, vy = s.yy * inverse_n - my * my,
               vz = s.zz * inverse_n - mz * mz;
  const double trace = std::max(vx + vy + vz, 1e-200);
  const double scale = 1 / trace;
  const double a = vx * scale, b = vy * scale, c = vz * scale;
  const double d = (s.xy * inverse_n - mx * my) * scale;  // row x, column y
  const double e = (s.xz * inverse_n - mx * mz) * scale;
  const double f = (s.yz * inverse_n - my * mz) * scale;

  // lambda^3 - lambda^2 + c1 lambda - c0 is concave and rises up to its smallest root.
  const double c1 = a * b - d * d + a * c - e * e + b * c - f * f;
  const double c0 = a * (b * c - f * f) - d * (d * c - e * f) + e * (d * f - e * b);
  double lambda = 0;
  for (int step = 0; step < 8; ++step) {
    const double value = ((lambda - 1) * lambda + c1) * lambda - c0;
    const double slope = (3 * lambda - 2) * lambda + c1;
    lambda -= value / std::max(slope, 1e-30);
  }
  lambda = std::clamp(lambda, 0.0, 1.0 / 3);

  // The adjugate is (lambda_1 - lambda)(lambda_2 - lambda) times the projector onto the normal.
  const double p = a - lambda, q = b - lambda, r = c - lambda;
  const double axx = q * r - f * f, ayy = p * r - e * e, azz = p * q - d * d;
  const double axy = e * f - d * r, axz = d * f - e * q, ayz = d * e - f * p;
  const bool use_x = axx >= ayy && axx >= azz;
  const bool use_y = ayy >= azz;
  const double nx = use_x ? axx : use_y ? axy : axz;
  const double ny = use_x ? axy : use_y ? ayy : ayz;
  const double nz = use_x ? axz : use_y ? ayz : azz;
  const double inverse_length = 1 / std::sqrt(std::max(nx * nx + ny * ny + nz * nz, 1e-200));
  return {nx * inverse_length, ny * inverse_length, nz * inverse_length, std::sqrt(lambda * trace),
          s.n >= 3 && axx + ayy + azz > 1e-6};
}

}  // namespace trivet::kernels
