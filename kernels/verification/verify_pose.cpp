#include "kernels/verification/verify_pose.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "kernels/verification/posed_samples.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {

float Evidence::support() const noexcept {
  const auto measured = static_cast<float>(consistent + oblique + violation + background);
  return measured > 0 ? weight / measured : 0;
}

float Evidence::visible_fraction() const noexcept {
  return visible > 0 ? static_cast<float>(consistent) / static_cast<float>(visible) : 0;
}

float Evidence::violation_fraction() const noexcept {
  const auto judged = static_cast<float>(consistent + oblique + violation + occluded + background);
  return judged > 0 ? static_cast<float>(violation) / judged : 0;
}

float Evidence::contour() const noexcept {
  const std::uint32_t judged = contour_free + contour_crossed;
  constexpr std::uint32_t kFewest = 8;
  return judged >= kFewest ? static_cast<float>(contour_free) / static_cast<float>(judged) : 1;
}

float Evidence::rmse() const noexcept {
  return consistent > 0 ? std::sqrt(squared_residuals / static_cast<float>(consistent)) : 0;
}

float Evidence::score() const noexcept {
  const float agreement = support() * (1 - violation_fraction()) * contour();
  return agreement * std::sqrt(agreement) * std::pow(visible_fraction(), 0.2F);
}

namespace {

// Cosine below which a sample is too oblique to be measured, a degree beyond the 80 of rays
// (kMinRayCosine): its view mask already has the limit of 80 degrees, to the nearest view.
constexpr float kUnmeasurable = 0.15F;
// Cosine used if the scene has no normal: below that of a good fit.
constexpr float kUnknownNormal = 0.8F;
constexpr float kUnreached = std::numeric_limits<float>::infinity();

/// Cosines between the rays and the surface.
TRIVET_SIMD_CLONES
void find_facing(const SampleBlock& block, BlockColumn<float>& facing) noexcept {
  const std::size_t n = block.count;
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    const float x = block.x[i], y = block.y[i], z = block.z[i];
    facing[i] = -(block.normal_x[i] * x + (block.normal_y[i] * y + block.normal_z[i] * z)) /
                std::sqrt(x * x + (y * y + z * z));
  }
}

/// Samples that should be visible, and their measurements.
struct VisibleSamples {
  std::size_t count = 0;
  alignas(64) BlockColumn<std::int32_t> index;  // index in the block
  alignas(64) BlockColumn<std::int32_t> pixel;  // the sample's or a neighbor, whichever fits best
  alignas(64) BlockColumn<float> residual;      // residual there; infinite without a measurement
};

/// The pixel or a neighbor, whichever fits best: half a pixel of error must not look like a hole.
/// Beyond the image's edge, the pixel replaces its neighbor.
TRIVET_SIMD_CLONES
void fit_pixels(const RangeImage& image, const SampleBlock& block, const BlockColumn<float>& facing,
                float tolerance, VisibleSamples& visible) noexcept {
  const float* const depth = image.depth.data();
  const auto width = static_cast<std::int32_t>(image.geometry.width);
  const auto height = static_cast<std::int32_t>(image.geometry.height);
  const std::size_t n = visible.count;
  TRIVET_SIMD_LOOP
  for (std::size_t k = 0; k < n; ++k) {
    const std::int32_t i = visible.index[k], u = block.column[i], v = block.row[i],
                       at = v * width + u;
    const float model_depth = block.z[i], cosine = facing[i];
    const float own_depth = depth[at];
    const float own = own_depth > 0 ? (own_depth - model_depth) * cosine : kUnreached;
    float best = own;
    std::int32_t best_pixel = at;
    const auto consider = [&](std::int32_t beside) {
      const float d = depth[beside];
      const float r = (d - model_depth) * cosine;
      const bool better = (d > 0) & (std::abs(r) < std::abs(best));
      best = better ? r : best;
      best_pixel = better ? beside : best_pixel;
    };
    const std::int32_t left = u > 0, right = u + 1 < width, above = v > 0, below = v + 1 < height;
    consider(at - left);
    consider(at + right);
    consider(at - above * width);
    consider(at + below * width);
    const bool agrees = std::abs(own) <= tolerance;
    visible.residual[k] = agrees ? own : best;
    visible.pixel[k] = agrees ? at : best_pixel;
  }
}

/// Output for the pixels of consistent samples, if any: indices are offset by the pixels of
/// previous images.
struct PixelList {
  std::vector<std::uint32_t>* pixels;
  std::uint32_t first;
};

/// The limits of agreement.
struct Limits {
  const VerifyOptions& options;
  float min_normal_cosine;
};

/// Evaluate the visible samples of one block.
void judge_samples(const RangeImage& image, const SampleBlock& block, const VisibleSamples& visible,
                   const Limits& limits, Evidence& evidence, const PixelList& explained) {
  const VerifyOptions& options = limits.options;
  // Branches here would be unpredictable: count without any.
  BlockColumn<std::uint32_t> agreeing;
  std::uint32_t num_agreeing = 0, unknown = 0, violation = 0, occluded = 0, on_background = 0;
  const std::span<const std::uint8_t> planes = image.plane;
  for (std::uint32_t k = 0; k < visible.count; ++k) {
    const float r = visible.residual[k];
    const std::uint8_t plane = planes[static_cast<std::size_t>(visible.pixel[k])];
    const bool background = options.is_background(plane), solid = options.is_solid(plane);
    const bool known = r < kUnreached, behind = known & (r > options.tolerance),
               before = r < -options.tolerance, agrees = known & !behind & !before;
    unknown += !known;
    violation += behind | (before & solid);  // nothing penetrates a table
    occluded += before & !solid;
    on_background += agrees & background;
    agreeing[num_agreeing] = k;
    num_agreeing += agrees & !background;
  }
  evidence.unknown += unknown;
  evidence.violation += violation;
  evidence.occluded += occluded;
  evidence.background += on_background;
  for (std::uint32_t a = 0; a < num_agreeing; ++a) {
    const std::uint32_t k = agreeing[a];
    const auto i = static_cast<std::size_t>(visible.index[k]);
    const Eigen::Vector3f normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    const float cosine = normal.dot(image.normals[static_cast<std::size_t>(visible.pixel[k])]);
    if (cosine < limits.min_normal_cosine) {  // also false without a scene normal
      ++evidence.oblique;
      continue;
    }
    ++evidence.consistent;
    const float share = visible.residual[k] / options.tolerance;
    const float agreement = std::isfinite(cosine) ? cosine : kUnknownNormal;
    evidence.weight += (1 - share * share) * agreement;
    evidence.squared_residuals += visible.residual[k] * visible.residual[k];
    if (explained.pixels != nullptr) {
      explained.pixels->push_back(explained.first +
                                  static_cast<std::uint32_t>(block.row[i]) * image.geometry.width +
                                  static_cast<std::uint32_t>(block.column[i]));
    }
  }
}

}  // namespace

Evidence verify_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                     std::size_t num_samples, const Pose& T_scene_model,
                     const VerifyOptions& options, std::vector<std::uint32_t>* explained) {
  Evidence evidence;
  const Limits limits{options, std::cos(options.max_normal_angle_rad)};
  const std::size_t n = std::min(num_samples, samples.points.size());
  PixelList list{explained, 0};
  SampleBlock block;
  BlockColumn<float> facing;
  VisibleSamples visible;
  for (const RangeImage& image : images) {
    const PosedSamples posed(image.geometry, samples, T_scene_model);
    for (std::size_t first = 0; first < n; first += kSampleBlock) {
      posed.place(first, n, block);
      find_facing(block, facing);
      visible.count = 0;
      for (std::size_t i = 0; i < block.count; ++i) {
        const bool faces = posed.is_visible(first + i) & (facing[i] > kUnmeasurable);
        const bool inside = block.column[i] >= 0;
        evidence.outside += faces & !inside;
        visible.index[visible.count] = static_cast<std::int32_t>(i);
        visible.count += faces & inside;
      }
      evidence.visible += static_cast<std::uint32_t>(visible.count);
      fit_pixels(image, block, facing, options.tolerance, visible);
      judge_samples(image, block, visible, limits, evidence, list);
    }
    list.first += static_cast<std::uint32_t>(image.depth.size());
  }
  return evidence;
}

namespace {

constexpr int kOutlineSide = 96;  // number of cells; a diameter is some 50

/// A coarse image of the model alone, around its center.
struct OutlineGrid {
  float u0 = 0, v0 = 0;  // its corner in the image [pixel]
  float cell = 0;        // [pixel]
  int side = 0;
};

/// The cells of a block's samples, -1 near the grid's border or outside.
struct SampleCells {
  alignas(64) BlockColumn<std::int32_t> column, row;
};

TRIVET_SIMD_CLONES
void find_cells(const ImageGeometry& geometry, const OutlineGrid& grid, const SampleBlock& block,
                SampleCells& cells) noexcept {
  const float fx = geometry.fx, fy = geometry.fy, cx = geometry.cx, cy = geometry.cy;
  const float u0 = grid.u0, v0 = grid.v0, cell = grid.cell;
  const auto last = static_cast<float>(grid.side - 3);
  const std::size_t n = block.count;
  TRIVET_SIMD_LOOP
  for (std::size_t i = 0; i < n; ++i) {
    const float z = block.z[i];
    const float u = (fx * block.x[i] / z + cx - u0) / cell;
    const float v = (fy * block.y[i] / z + cy - v0) / cell;
    const bool inside = (z > 0) & (u >= 3) & (v >= 3) & (u < last) & (v < last);
    cells.column[i] = static_cast<std::int32_t>(inside ? u : -1.0F);
    cells.row[i] = static_cast<std::int32_t>(inside ? v : -1.0F);
  }
}

/// A row of cells, one bit each.
__extension__ using Cells = unsigned __int128;
static_assert(kOutlineSide <= 128);

using Outline = std::array<Cells, kOutlineSide>;

int lowest(Cells cells) noexcept {
  const auto low = static_cast<std::uint64_t>(cells);
  return low != 0 ? std::countr_zero(low)
                  : 64 + std::countr_zero(static_cast<std::uint64_t>(cells >> 64));
}

/// Each sample will cover 3 x 3 cells of 0.8 spacings, which leaves no holes inside the outline and
/// widens it by about one cell.
OutlineGrid grid_around(const Eigen::Vector3f& center, float diameter, float spacing,
                        const ImageGeometry& geometry) noexcept {
  OutlineGrid grid;
  grid.cell = std::max(1.0F, 0.8F * spacing * geometry.fx / center.z());
  const float needed = std::ceil(2 * diameter * geometry.fx / (center.z() * grid.cell));
  grid.side = std::min(kOutlineSide, clamped_integer(needed, 0, kOutlineSide) + 8);
  const float half = grid.cell * static_cast<float>(grid.side) / 2;
  grid.u0 = geometry.fx * center.x() / center.z() + geometry.cx - half;
  grid.v0 = geometry.fy * center.y() / center.z() + geometry.cy - half;
  return grid;
}

/// The cells that contain the first n samples, with the depth of the nearest one in each.
///
/// depth  grid.side^2, infinite without a sample
Outline draw_samples(const PosedSamples& posed, std::size_t n, const ImageGeometry& geometry,
                     const OutlineGrid& grid, std::span<float> depth) noexcept {
  const auto side = static_cast<std::size_t>(grid.side);
  Outline hit{};
  SampleBlock block;
  SampleCells cells;
  BlockColumn<std::uint32_t> drawn;
  for (std::size_t first = 0; first < n; first += kSampleBlock) {
    posed.place(first, n, block);
    find_cells(geometry, grid, block, cells);
    std::size_t num_drawn = 0;
    for (std::size_t i = 0; i < block.count; ++i) {
      drawn[num_drawn] = static_cast<std::uint32_t>(i);
      num_drawn += posed.is_visible(first + i) & (cells.column[i] >= 0);
    }
    for (std::size_t k = 0; k < num_drawn; ++k) {
      const std::size_t i = drawn[k];
      const auto u = static_cast<std::size_t>(cells.column[i]),
                 v = static_cast<std::size_t>(cells.row[i]);
      hit[v] |= Cells{1} << u;
      float& nearest = depth[v * side + u];
      nearest = std::min(nearest, block.z[i]);
    }
  }
  return hit;
}

/// Dilation of each cell to its eight neighbors.
Outline widened(const Outline& hit, std::size_t side) noexcept {
  Outline filled{};
  for (std::size_t v = 1; v + 1 < side; ++v) {
    const Cells column = hit[v - 1] | hit[v] | hit[v + 1];
    filled[v] = column << 1 | column | column >> 1;
  }
  return filled;
}

/// Call visit(u, v, du, dv) for each border cell of an outline that has no other cell of it within
/// two cells in the direction (du, dv).
template <class Visit>
void for_borders(const Outline& filled, std::size_t side, Visit&& visit) {
  for (std::size_t v = 2; v + 2 < side; ++v) {
    const auto border = [&](Cells beside, Cells beyond, int du, int dv) {
      for (Cells cells = filled[v] & ~beside & ~beyond; cells != 0; cells &= cells - 1)
        visit(static_cast<std::size_t>(lowest(cells)), v, du, dv);
    };
    border(filled[v] >> 1, filled[v] >> 2, 1, 0);
    border(filled[v] << 1, filled[v] << 2, -1, 0);
    border(filled[v + 1], filled[v + 2], 0, 1);
    border(filled[v - 1], filled[v - 2], 0, -1);
  }
}

/// The depth of the nearest sample in a cell and its eight neighbors.
float nearest_around(std::span<const float> depth, std::size_t side, std::size_t u,
                     std::size_t v) noexcept {
  float z = kUnreached;
  for (const std::size_t row : {v - 1, v, v + 1}) {
    for (const std::size_t column : {u - 1, u, u + 1}) z = std::min(z, depth[row * side + column]);
  }
  return z;
}

}  // namespace

ContourEvidence judge_contour(std::span<const RangeImage> images, const ModelSamples& samples,
                              std::size_t num_samples, const Pose& T_scene_model,
                              const VerifyOptions& options, ContourScratch& scratch) {
  ContourEvidence evidence;
  const std::size_t n = std::min(num_samples, samples.points.size());
  if (n == 0) return evidence;
  const float spacing = samples.spacing * std::sqrt(static_cast<float>(samples.points.size()) /
                                                    static_cast<float>(n));
  const float jump = std::max(2 * options.tolerance, 0.03F * samples.diameter);
  for (const RangeImage& image : images) {
    const ImageGeometry& geometry = image.geometry;
    const PosedSamples posed(geometry, samples, T_scene_model);
    const Eigen::Vector3f center = posed.T_camera_model() * samples.center;
    if (!(center.z() > samples.diameter * 0.1F)) continue;
    const OutlineGrid grid = grid_around(center, samples.diameter, spacing, geometry);
    const auto side = static_cast<std::size_t>(grid.side);
    scratch.depth.assign(side * side, kUnreached);
    const Outline filled = widened(draw_samples(posed, n, geometry, grid, scratch.depth), side);

    // Test the scene one cell beyond each border cell of the outline.
    for_borders(filled, side, [&](std::size_t u, std::size_t v, int du, int dv) {
      const float pu = grid.u0 + (static_cast<float>(static_cast<int>(u) + du) + 0.5F) * grid.cell;
      const float pv = grid.v0 + (static_cast<float>(static_cast<int>(v) + dv) + 0.5F) * grid.cell;
      const float column = pu + 0.5F, row = pv + 0.5F;
      if (!(pu >= 0 && pv >= 0 && column < static_cast<float>(geometry.width) &&
            row < static_cast<float>(geometry.height))) {
        return;
      }
      const float z = nearest_around(scratch.depth, side, u, v);
      const std::size_t pixel =
          static_cast<std::size_t>(row) * geometry.width + static_cast<std::size_t>(column);
      const float d = image.depth[pixel];
      if (d > 0 && d < z - jump) return;  // hidden by something nearer
      if (!(d > 0) || d > z + jump) {
        ++evidence.free;
      } else if (!options.is_background(image.near_plane[pixel])) {
        ++evidence.crossed;
      }
    });
  }
  return evidence;
}

}  // namespace trivet::kernels
