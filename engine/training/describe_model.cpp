#include "engine/training/describe_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/keypoints_uniform.hpp"
#include "kernels/spin_images/partial_views.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet::engine {
namespace {

constexpr float kRelativeResolution = 0.0125F;  // [diameters]
// kNormalClusterDeg, rounded down, since the bytes of all trained libraries depend on it.
constexpr float kNormalClusterRad = 0.52F;
// Spacing of the supports' points in resolutions. Bins are at least 1.2 wide, and points are
// distributed over four of them. A spacing of 1 finds no more and takes twice the time.
constexpr float kPointSpacing = 2;
constexpr float kModelShare = kPointSpacing * kShare;
constexpr std::size_t kNumPartialViews = 42;  // views among the directions of samples
constexpr std::size_t kFewestVisible = 25;
// Maximum difference of what two similar views see. At 0.04 few views are similar, and five groups
// cover so few of all views that less is found.
constexpr float kLikeSupport = 0.2F;
constexpr float kLikeImage = 0.3F;   // maximum distance of duplicate images of a keypoint
constexpr float kLikeFrame = 0.25F;  // maximum rotation of their frames, approximately [rad]
// Maximum number of descriptions per keypoint, from the views that are most typical. Keeping all,
// about ten, doubles the size of a library and finds no more.
constexpr std::size_t kMostDescriptions = 5;
constexpr std::size_t kGrain = 16;  // keypoints per task

struct Surface {
  Points points;
  Normals normals;
  std::vector<ViewMask> views;  // views of each point
};

/// The visible surface with outward normals.
Surface visible_surface(const SurveyedModel& model, float spacing, const ViewMask& directions) {
  const SpreadPoints even = sample_evenly(model, spacing, kNormalClusterRad);
  Surface visible;
  std::vector<ViewMask> masks(even.points.size());
  const float offset = std::max(model.ray_offset, 1e-3F * model.diameter);
  for_chunks(masks.size(), 256, [&](std::size_t first, std::size_t count) {
    kernels::compute_views(model.rays, even.points.view().slice(first, count),
                           even.normals.view().slice(first, count), offset, directions,
                           std::span(masks).subspan(first, count));
  });
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] == ViewMask{}) continue;
    visible.points.push_back(even.points[i]);
    visible.normals.push_back(even.normals[i]);
    visible.views.push_back(masks[i]);
  }
  return visible;
}

/// Index of a partial view among the directions of samples.
std::size_t partial_view(std::size_t v) {
  return (2 * v + 1) * kernels::kNumViews / (2 * kNumPartialViews);
}

/// Bits of a point's views. Bit 0: all points together, which no view sees. Bit 1 + v: partial view
/// v.
constexpr std::size_t kFullSurface = 0, kFirstView = 1;

std::vector<kernels::ViewBits> partial_views_of(std::span<const ViewMask> views) {
  std::vector<kernels::ViewBits> bits(views.size(), kernels::ViewBits{1} << kFullSurface);
  std::array<std::size_t, kernels::kMostPartialViews> num_visible{};
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t v = 0; v < kNumPartialViews; ++v) {
      if (!kernels::is_visible(views[i], partial_view(v))) continue;
      bits[i] |= kernels::ViewBits{1} << (kFirstView + v);
      ++num_visible[kFirstView + v];
    }
  }
  kernels::ViewBits of_use = ~kernels::ViewBits{0};
  for (std::size_t v = kFirstView; v < num_visible.size(); ++v) {
    if (num_visible[v] < kFewestVisible) of_use &= ~(kernels::ViewBits{1} << v);
  }
  if (views.size() < kFewestVisible) of_use = 0;
  for (kernels::ViewBits& some : bits) some &= of_use;
  return bits;
}

/// The surface of a model, prepared for describing its keypoints.
struct ViewedSurface {
  ViewedSurface(Surface from, float support_radius)
      : surface(std::move(from)),
        views(partial_views_of(surface.views)),
        radius(support_radius),
        grid(surface.points, kCell * radius),
        sharers(surface.points.size(), kModelShare * radius) {
    for (const std::uint32_t i : grid.order()) views_in_order.push_back(views[i]);
    const PointsView points = grid.ordered_points();
    const kernels::VoxelHash fine(points, sharers.radius);
    for_chunks(points.size(), 256, [&](std::size_t first, std::size_t count) {
      kernels::count_sharers(fine, views_in_order, points.slice(first, count), first, sharers);
    });
  }

  Surface surface;
  std::vector<kernels::ViewBits> views;
  float radius;
  kernels::VoxelHash grid;
  // Members in the order of the grid:
  std::vector<kernels::ViewBits> views_in_order;
  kernels::Sharers sharers;
};

struct KeypointScratch {
  kernels::ViewedSupport all;
  kernels::LikeViews views;
  kernels::Support visible;
  kernels::SpinScratch spin;
  std::array<float, kernels::kTriSpinSize> image;
};

bool alike(std::span<const float> a, std::span<const float> b) {
  const auto of = [](std::span<const float> image) {
    return Eigen::Map<const Eigen::Array<float, kernels::kTriSpinSize, 1>>(image.data());
  };
  return (of(a) - of(b)).square().sum() < kLikeImage * kLikeImage;
}

/// Whether this is nearly a duplicate of one of the descriptions from `first` on.
bool is_known(const Descriptions& known, std::size_t first, const Eigen::Matrix3f& frame,
              std::span<const float> image) {
  for (std::size_t i = first; i < known.size(); ++i) {
    if ((frame - known.frames[i]).norm() < kLikeFrame && alike(image, known.image(i))) return true;
  }
  return false;
}

/// Append the most frequent appearances of a keypoint: the most typical view of each group of
/// similar views, the largest group first, where its frame is sufficiently certain.
void describe_keypoint(const ViewedSurface& model, std::uint32_t point,
                       const kernels::FrameLimits& limits, KeypointScratch& scratch,
                       Descriptions& out) {
  kernels::gather_viewed_support(model.grid, model.views_in_order, model.surface.points[point],
                                 model.radius, scratch.all);
  kernels::ViewBits left = model.views[point];
  kernels::compare_views(scratch.all, left, kLikeSupport, scratch.views);
  const std::size_t before = out.size();
  while (left != 0 && out.size() < before + kMostDescriptions) {
    const std::size_t view = kernels::most_typical(scratch.views, left);
    left &= ~scratch.views.alike[view];
    kernels::extract_view(model.grid, scratch.all, view, model.sharers, scratch.visible);
    const Eigen::Matrix3f frame =
        kernels::describe_support(scratch.visible, model.surface.normals[point], model.radius,
                                  limits, scratch.image, scratch.spin)
            .axes;
    if (frame.isZero() || is_known(out, before, frame, scratch.image)) continue;
    out.keypoints.push_back(model.surface.points[point]);
    out.frames.push_back(frame);
    out.images.insert(out.images.end(), scratch.image.begin(), scratch.image.end());
  }
}

}  // namespace

float resolution_for(float diameter, std::uint32_t half_octaves) noexcept {
  const float own = std::round(2 * std::log2(kRelativeResolution * diameter));
  return std::exp2((own + static_cast<float>(half_octaves)) / 2);
}

struct ModelDescriber::State {
  DescribeOptions options;
  ViewedSurface surface;
  std::vector<std::uint32_t> keypoints;
  PerThread<KeypointScratch> scratch;
};

ModelDescriber::ModelDescriber(const SurveyedModel& model, const DescribeOptions& options) {
  const float resolution = resolution_for(model.diameter, options.half_octaves);
  ViewMask directions{};
  for (std::size_t v = 0; v < kNumPartialViews; ++v)
    directions[partial_view(v) / 64] |= std::uint64_t{1} << (partial_view(v) % 64);
  state_ = std::unique_ptr<State>(
      new State{options,
                ViewedSurface(visible_surface(model, kPointSpacing * resolution, directions),
                              options.support * resolution),
                {},
                {}});
  Column<std::uint32_t> keypoints;
  kernels::UniformScratch scratch;
  kernels::find_uniform_keypoints(state_->surface.surface.points, options.spacing * resolution,
                                  keypoints, scratch);
  for (std::size_t k = 0; k < keypoints.size(); k += options.stride)
    state_->keypoints.push_back(keypoints[k]);
}

ModelDescriber::ModelDescriber(ModelDescriber&&) noexcept = default;
ModelDescriber& ModelDescriber::operator=(ModelDescriber&&) noexcept = default;
ModelDescriber::~ModelDescriber() = default;

std::size_t ModelDescriber::num_chunks() const noexcept {
  return (state_->keypoints.size() + kGrain - 1) / kGrain;
}

void ModelDescriber::describe(std::size_t chunk, Descriptions& out) const {
  const std::size_t end = std::min(state_->keypoints.size(), (chunk + 1) * kGrain);
  for (std::size_t k = chunk * kGrain; k < end; ++k) {
    describe_keypoint(state_->surface, state_->keypoints[k], state_->options.limits,
                      state_->scratch.local(), out);
  }
}

Descriptions describe_model(const SurveyedModel& model, const DescribeOptions& options) {
  const ModelDescriber describer(model, options);
  Descriptions all;
  for (std::size_t c = 0; c < describer.num_chunks(); ++c) describer.describe(c, all);
  return all;
}

}  // namespace trivet::engine
