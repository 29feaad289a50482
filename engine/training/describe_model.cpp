#include "engine/training/describe_model.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/keypoints_uniform.hpp"
#include "kernels/spin_images/partial_views.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet::engine {
namespace {

constexpr float kRelativeResolution = 0.0125F;  // of the diameter
constexpr float kNormalClusterRad = 0.52F;
constexpr std::size_t kNumPartialViews = 42;  // of the directions that samples know
constexpr std::size_t kFewestSeen = 100;
// Views that differ in so little of a support give nearly the same image: its distance grows with the
// share of the surface that one of two images lacks, and reaches kLikeImage at some 4 % of what is seen.
constexpr float kLikeSupport = 0.04F;
constexpr float kLikeImage = 0.3F;   // distance of two images of one keypoint that are one
constexpr float kLikeFrame = 0.25F;  // ... and of their frames, about [rad]
// Descriptions of a keypoint: those that most views give. All, some ten, make a library twice
// as large and find no more.
constexpr std::size_t kMostDescriptions = 5;
constexpr std::size_t kMostTried = 16;  // for them: some are alike, or have no certain frame
constexpr std::size_t kGrain = 16;      // keypoints a task

struct Surface {
  Points points;
  Normals normals;
  std::vector<ViewMask> views;  // of each point
};

/// The visible surface at a resolution, with outward normals.
Surface visible_surface(const SurveyedModel& model, float resolution, const ViewMask& directions) {
  const SpreadPoints even = sample_evenly(model, resolution, kNormalClusterRad);
  Surface seen;
  std::vector<ViewMask> masks(even.points.size());
  const float offset = std::max(model.ray_offset, 1e-3F * model.diameter);
  for_chunks(masks.size(), 256, [&](std::size_t first, std::size_t count) {
    kernels::compute_views(model.rays, even.points.view().slice(first, count),
                           even.normals.view().slice(first, count), offset, directions,
                           std::span(masks).subspan(first, count));
  });
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] == ViewMask{}) continue;
    seen.points.push_back(even.points[i]);
    seen.normals.push_back(even.normals[i]);
    seen.views.push_back(masks[i]);
  }
  return seen;
}

/// Of the directions that samples know.
std::size_t partial_view(std::size_t v) {
  return (2 * v + 1) * kernels::kNumViews / (2 * kNumPartialViews);
}

/// Bit 0 of a point's views: all points together, which no view sees. Bit 1 + v: partial view v.
constexpr std::size_t kWhole = 0, kFirstView = 1;

std::vector<kernels::ViewBits> partial_views_of(std::span<const ViewMask> views) {
  std::vector<kernels::ViewBits> bits(views.size(), kernels::ViewBits{1} << kWhole);
  std::array<std::size_t, kernels::kMostPartialViews> num_seen{};
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t v = 0; v < kNumPartialViews; ++v) {
      if (!kernels::is_visible(views[i], partial_view(v))) continue;
      bits[i] |= kernels::ViewBits{1} << (kFirstView + v);
      ++num_seen[kFirstView + v];
    }
  }
  kernels::ViewBits of_use = ~kernels::ViewBits{0};
  for (std::size_t v = kFirstView; v < num_seen.size(); ++v) {
    if (num_seen[v] < kFewestSeen) of_use &= ~(kernels::ViewBits{1} << v);
  }
  if (views.size() < kFewestSeen) of_use = 0;
  for (kernels::ViewBits& some : bits) some &= of_use;
  return bits;
}

/// The surface of a model, ready for describing its keypoints.
struct ViewedSurface {
  ViewedSurface(Surface from, float support_radius)
      : surface(std::move(from)),
        views(partial_views_of(surface.views)),
        radius(support_radius),
        grid(surface.points, kCell * radius) {
    const kernels::VoxelHash fine(surface.points, kShare * radius);
    sharers.num_points = surface.points.size();
    sharers.counts.resize(kernels::kMostPartialViews * sharers.num_points);
    for_chunks(sharers.num_points, 256, [&](std::size_t first, std::size_t count) {
      kernels::count_sharers(fine, views, surface.points.view().slice(first, count), first,
                             kShare * radius, sharers.counts);
    });
  }

  Surface surface;
  std::vector<kernels::ViewBits> views;
  float radius;
  kernels::VoxelHash grid;
  kernels::Sharers sharers;
};

/// Views that see nearly the same of a keypoint's surface.
struct LikeViews {
  std::size_t first = 0;  ///< of the views; it stands for all
  std::size_t number = 0;
};

struct KeypointScratch {
  kernels::ViewedSupport all;
  kernels::Support seen;
  kernels::SpinScratch spin;
  std::vector<LikeViews> groups;
  Descriptions found;
  std::vector<std::size_t> numbers, order;  // of what was found: of views, and most views first
};

/// Join the views of a keypoint, those of most views first; of as many in the order of views.
void join_views(const kernels::ViewedSupport& all, kernels::ViewBits views,
                std::vector<LikeViews>& groups) {
  groups.clear();
  for (; views != 0; views &= views - 1) {
    const auto v = static_cast<std::size_t>(std::countr_zero(views));
    const auto like = std::ranges::find_if(groups, [&](const LikeViews& group) {
      const std::size_t differing =
          kernels::count_differences(all.seen_by(v), all.seen_by(group.first));
      return static_cast<float>(differing) <= kLikeSupport * static_cast<float>(all.size);
    });
    if (like == groups.end()) {
      groups.push_back({v, 1});
    } else {
      ++like->number;
    }
  }
  std::ranges::stable_sort(groups, std::ranges::greater(), &LikeViews::number);
}

bool alike(std::span<const float> a, std::span<const float> b) {
  float squared = 0;
  for (std::size_t c = 0; c < a.size(); ++c) squared += (a[c] - b[c]) * (a[c] - b[c]);
  return squared < kLikeImage * kLikeImage;
}

void append(const Descriptions& from, std::size_t i, Descriptions& to) {
  const auto image = from.image(i);
  to.keypoints.push_back(from.keypoints[i]);
  to.frames.push_back(from.frames[i]);
  to.images.insert(to.images.end(), image.begin(), image.end());
}

/// What the groups of views see of a keypoint, those apart that are not alike; how many views have
/// each is added up.
void describe_groups(const ViewedSurface& model, std::uint32_t point,
                     const kernels::FrameLimits& limits, KeypointScratch& scratch) {
  Descriptions& found = scratch.found;
  found = {};
  scratch.numbers.clear();
  for (std::size_t g = 0; g < scratch.groups.size() && g < kMostTried; ++g) {
    const LikeViews& group = scratch.groups[g];
    kernels::take_view(scratch.all, group.first, model.sharers.of_view(group.first),
                       kShare * model.radius, scratch.seen);
    found.images.resize((found.size() + 1) * kernels::kTriSpinSize);
    const auto image = std::span(found.images).last<kernels::kTriSpinSize>();
    const Eigen::Matrix3f frame =
        kernels::describe_support(scratch.seen, model.surface.normals[point], model.radius, limits,
                                  image, scratch.spin)
            .axes;
    if (frame.isZero()) continue;
    std::size_t like = 0;
    while (like < found.size() &&
           ((frame - found.frames[like]).norm() >= kLikeFrame || !alike(image, found.image(like))))
      ++like;
    if (like < found.size()) {
      scratch.numbers[like] += group.number;
      continue;
    }
    scratch.numbers.push_back(group.number);
    found.keypoints.push_back(model.surface.points[point]);
    found.frames.push_back(frame);
  }
  found.images.resize(found.size() * kernels::kTriSpinSize);
}

/// Append what most views see of a keypoint, where their frames are certain enough.
void describe_keypoint(const ViewedSurface& model, std::uint32_t point,
                       const kernels::FrameLimits& limits, KeypointScratch& scratch,
                       Descriptions& out) {
  kernels::gather_viewed_support(model.grid, model.views, model.surface.points[point], model.radius,
                                 scratch.all);
  join_views(scratch.all, model.views[point], scratch.groups);
  describe_groups(model, point, limits, scratch);
  std::vector<std::size_t>& order = scratch.order;
  order.resize(scratch.found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t i) { return scratch.numbers[i]; });
  order.resize(std::min(order.size(), kMostDescriptions));
  for (const std::size_t i : order) append(scratch.found, i, out);
}

}  // namespace

float resolution_for(float diameter, std::uint32_t half_octaves) noexcept {
  const float own = std::round(2 * std::log2(kRelativeResolution * diameter));
  return std::exp2((own + static_cast<float>(half_octaves)) / 2);
}

Descriptions describe_model(const SurveyedModel& model, const DescribeOptions& options) {
  const float resolution = resolution_for(model.diameter, options.half_octaves);
  ViewMask directions{};
  for (std::size_t v = 0; v < kNumPartialViews; ++v)
    directions[partial_view(v) / 64] |= std::uint64_t{1} << (partial_view(v) % 64);
  const ViewedSurface surface(visible_surface(model, resolution, directions),
                              options.support * resolution);
  Column<std::uint32_t> keypoints;
  kernels::UniformScratch scratch;
  kernels::find_uniform_keypoints(surface.surface.points, options.spacing * resolution, keypoints,
                                  scratch);
  const std::size_t num_described = (keypoints.size() + options.stride - 1) / options.stride;
  std::vector<Descriptions> chunks((num_described + kGrain - 1) / kGrain);
  PerThread<KeypointScratch> per_thread;
  for_each_index(chunks.size(), [&](std::size_t c) {
    const std::size_t end = std::min(num_described, (c + 1) * kGrain);
    for (std::size_t k = c * kGrain; k < end; ++k)
      describe_keypoint(surface, keypoints[k * options.stride], options.limits, per_thread.local(),
                        chunks[c]);
  });
  Descriptions all;
  for (const Descriptions& some : chunks) {
    for (std::size_t i = 0; i < some.size(); ++i) append(some, i, all);
  }
  return all;
}

}  // namespace trivet::engine
