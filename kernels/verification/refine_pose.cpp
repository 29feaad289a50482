#include "kernels/verification/refine_pose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/common/pose_math.hpp"
#include "kernels/verification/posed_samples.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

using EightFloats [[gnu::vector_size(32)]] = float;
using EightDoubles [[gnu::vector_size(64)]] = double;

/// Contributions of a block's samples inside the image to the normal equations.
struct Pulls {
  std::size_t count = 0;
  alignas(64) BlockColumn<std::int32_t> index;   // index in the block
  alignas(64) BlockColumn<std::int32_t> counts;  // 0: no measurement within the gate
  // Derivative of the residual to rotation and translation (6), the residual, and the square root
  // of the weight.
  alignas(64) BlockColumn<std::array<float, 8>> rows;
};

/// Samples of a block in the scene's frame.
struct MovedBlock {
  alignas(64) BlockColumn<float> x, y, z;

  PointsSpan points(std::size_t count) noexcept {
    return {{x.data(), count}, {y.data(), count}, {z.data(), count}};
  }
};

/// State of one iteration.
struct Stand {
  Eigen::Vector3f pivot;  // rotating about the object keeps the system well conditioned
  float gate, min_cosine;
};

/// Compare samples with the measured points along their viewing rays.
TRIVET_SIMD_CLONES
void measure(const RangeImage& image, const SampleBlock& __restrict block,
             const MovedBlock& __restrict moved, const Stand& stand,
             Pulls& __restrict pulls) noexcept {
  const ImageGeometry& geometry = image.geometry;
  const float* const depth = image.depth.data();
  const auto [scene_x, scene_y, scene_z] = image.normals.view();
  const auto& T = geometry.T_camera_scene.matrix();
  const float xx = T(0, 0), xy = T(1, 0), xz = T(2, 0);  // the inverse rotation for normals
  const float yx = T(0, 1), yy = T(1, 1), yz = T(2, 1);
  const float zx = T(0, 2), zy = T(1, 2), zz = T(2, 2);
  const float fx = geometry.fx, fy = geometry.fy, cx = geometry.cx, cy = geometry.cy;
  const float px = stand.pivot.x(), py = stand.pivot.y(), pz = stand.pivot.z();
  const float gate = stand.gate, min_cosine = stand.min_cosine;
  const auto width = static_cast<std::int32_t>(geometry.width);
  const std::size_t n = pulls.count;
  TRIVET_SIMD_LOOP
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t i = pulls.index[k], u = block.column[i], v = block.row[i];
    const std::int32_t at = v * width + u;
    const float d = depth[at], nx = scene_x[at], ny = scene_y[at], nz = scene_z[at];
    const float cosine = nx * block.normal_x[i] + (ny * block.normal_y[i] + nz * block.normal_z[i]);

    const float ex = block.x[i] - (static_cast<float>(u) - cx) * d / fx;
    const float ey = block.y[i] - (static_cast<float>(v) - cy) * d / fy;
    const float ez = block.z[i] - d;
    const float residual = nx * ex + (ny * ey + nz * ez);
    pulls.counts[k] = (d > 0) & (cosine > min_cosine) & !(std::abs(residual) > gate) &
                      !(ex * ex + (ey * ey + ez * ez) > 9 * gate * gate);

    const float ax = moved.x[i] - px, ay = moved.y[i] - py, az = moved.z[i] - pz;
    const float sx = xx * nx + (xy * ny + xz * nz);
    const float sy = yx * nx + (yy * ny + yz * nz);
    const float sz = zx * nx + (zy * ny + zz * nz);
    const float share = residual / gate;
    pulls.rows[k][0] = ay * sz - az * sy;
    pulls.rows[k][1] = az * sx - ax * sz;
    pulls.rows[k][2] = ax * sy - ay * sx;
    pulls.rows[k][3] = sx;
    pulls.rows[k][4] = sy;
    pulls.rows[k][5] = sz;
    pulls.rows[k][6] = residual;
    pulls.rows[k][7] = 1 - share * share;  // Tukey
  }
}

/// Sums over samples: row i < 6 of the normal matrix (the first six numbers), and the negative
/// right-hand side in the seventh.
struct NormalEquations {
  std::array<EightDoubles, 7> rows{};
  std::uint32_t associated = 0;
};

TRIVET_SIMD_CLONES
void add(const Pulls& __restrict pulls, NormalEquations& __restrict sums) noexcept {
  std::array<EightDoubles, 7> rows = sums.rows;
  std::uint32_t associated = 0;
  for (std::size_t k = 0; k < pulls.count; ++k) {
    if (pulls.counts[k] == 0) continue;
    EightFloats row;
    __builtin_memcpy(&row, pulls.rows[k].data(), sizeof(row));
    const EightDoubles J = __builtin_convertvector(row, EightDoubles);
    const double weight = J[7] * J[7];
    rows[0] += weight * J[0] * J;
    rows[1] += weight * J[1] * J;
    rows[2] += weight * J[2] * J;
    rows[3] += weight * J[3] * J;
    rows[4] += weight * J[4] * J;
    rows[5] += weight * J[5] * J;
    rows[6] += weight * J[6] * J;
    ++associated;
  }
  sums.rows = rows;
  sums.associated += associated;
}

}  // namespace

Refined refine_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                    const Pose& start, const RefineOptions& options) noexcept {
  Refined refined{start, 0, false};
  Pose& pose = refined.T_scene_model;
  const float shrink = std::pow(options.last_gate / options.first_gate,
                                1.0F / static_cast<float>(std::max(1, options.max_iterations - 1)));
  const float min_cosine = std::cos(options.max_normal_angle_rad);
  const std::size_t n = std::min(options.num_samples, samples.points.size());
  SampleBlock block;
  MovedBlock moved;
  Pulls pulls;
  float gate = options.first_gate;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration, gate *= shrink) {
    const Stand stand{pose * samples.center, gate, min_cosine};
    NormalEquations sums;
    for (const RangeImage& image : images) {
      const PosedSamples posed(image.geometry, samples, pose);
      for (std::size_t first = 0; first < n; first += kSampleBlock) {
        posed.place(first, n, block);
        move_points(pose, samples.points.slice(first, block.count), moved.points(block.count));
        pulls.count = 0;
        for (std::size_t i = 0; i < block.count; ++i) {
          pulls.index[pulls.count] = static_cast<std::int32_t>(i);
          pulls.count +=
              posed.is_visible(first + i) && block.column[i] >= 0 &&
              !is_background_plane(
                  options.plane_is_background,
                  image.plane[static_cast<std::size_t>(block.row[i]) * image.geometry.width +
                              static_cast<std::size_t>(block.column[i])]);
        }
        measure(image, block, moved, stand, pulls);
        add(pulls, sums);
      }
    }
    if (sums.associated < 20) break;
    Eigen::Matrix<double, 6, 6> A;
    Eigen::Matrix<double, 6, 1> b;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) A(i, j) = sums.rows[static_cast<std::size_t>(i)][j];
      b[i] = -sums.rows[6][i];
    }
    // Slight damping constrains directions that the visible surface leaves free, such as sliding on
    // a plane.
    A.topLeftCorner<3, 3>().diagonal().array() +=
        1e-3 * A.topLeftCorner<3, 3>().trace() / 3 + 1e-30;
    A.bottomRightCorner<3, 3>().diagonal().array() +=
        1e-3 * A.bottomRightCorner<3, 3>().trace() / 3 + 1e-30;
    const Eigen::Matrix<double, 6, 1> step = A.ldlt().solve(b);
    if (!step.allFinite()) break;
    pose = small_motion(step.head<3>().cast<float>(), step.tail<3>().cast<float>(), stand.pivot) *
           pose;
    pose.linear() = Eigen::Quaternionf(pose.linear()).normalized().toRotationMatrix();
    refined.iterations = iteration + 1;
  }
  const float translation = (pose * samples.center - start * samples.center).norm();
  const float rotation = rotation_angle(pose.linear(), start.linear());
  if (!(translation <= options.max_translation) || !(rotation <= options.max_rotation_rad)) {
    refined.T_scene_model = start;
    refined.moved_too_far = true;
  }
  return refined;
}

}  // namespace trivet::kernels
