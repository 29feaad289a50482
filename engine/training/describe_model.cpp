#include "engine/training/describe_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/spin_images/keypoints_uniform.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet::engine {
namespace {

constexpr float kRelativeResolution = 0.0125F;  // of the diameter
constexpr float kNormalClusterRad = 0.52F;
constexpr std::size_t kNumPartialViews = 42;  // of the directions that samples know
constexpr std::size_t kFewestSeen = 100;
constexpr float kLikeImage = 0.3F;   // distance of two images of one keypoint that are one
constexpr float kLikeFrame = 0.25F;  // ... and of their frames, about [rad]
// Descriptions of a keypoint: those that most views give. All, some ten, make a library twice
// as large and find no more.
constexpr std::size_t kMostDescriptions = 5;

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

/// Collects descriptions of keypoints, those that differ from the ones of the same keypoint.
class Collection {
 public:
  explicit Collection(std::size_t num_points) : of_point_(num_points) {}

  void add(const Descriptions& some, std::span<const std::uint32_t> points) {
    for (std::size_t k = 0; k < some.size(); ++k) {
      std::vector<std::uint32_t>& known = of_point_[points[k]];
      const auto image = image_of(some, k);
      const auto like = std::ranges::find_if(known, [&](std::uint32_t i) {
        return (some.frames[k] - all_.frames[i]).norm() < kLikeFrame && alike(image, i);
      });
      if (like != known.end()) {
        ++num_views_[*like];
        continue;
      }
      known.push_back(static_cast<std::uint32_t>(all_.size()));
      num_views_.push_back(1);
      append(some, k, all_);
    }
  }

  /// Those of each keypoint that most views gave, in the order in which they came.
  Descriptions take() && {
    std::vector<std::uint32_t> kept;
    for (std::vector<std::uint32_t>& known : of_point_) {
      std::ranges::stable_sort(known, std::ranges::greater(),
                               [&](std::uint32_t i) { return num_views_[i]; });
      known.resize(std::min(known.size(), kMostDescriptions));
      kept.insert(kept.end(), known.begin(), known.end());
    }
    std::ranges::sort(kept);
    Descriptions out;
    for (const std::uint32_t i : kept) append(all_, i, out);
    return out;
  }

 private:
  static std::span<const float> image_of(const Descriptions& from, std::size_t i) {
    return std::span(from.images).subspan(i * kernels::kTriSpinSize, kernels::kTriSpinSize);
  }
  static void append(const Descriptions& from, std::size_t i, Descriptions& to) {
    const auto image = image_of(from, i);
    to.keypoints.push_back(from.keypoints[i]);
    to.frames.push_back(from.frames[i]);
    to.images.insert(to.images.end(), image.begin(), image.end());
  }
  bool alike(std::span<const float> image, std::size_t i) const {
    const float* const other = all_.images.data() + i * kernels::kTriSpinSize;
    float squared = 0;
    for (std::size_t c = 0; c < image.size(); ++c) {
      const float d = image[c] - other[c];
      squared += d * d;
    }
    return squared < kLikeImage * kLikeImage;
  }

  Descriptions all_;
  std::vector<std::uint32_t> num_views_;              // that gave each
  std::vector<std::vector<std::uint32_t>> of_point_;  // descriptions of each
};

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
  const Surface surface = visible_surface(model, resolution, directions);
  Column<std::uint32_t> keypoints;
  kernels::UniformScratch scratch;
  kernels::find_uniform_keypoints(surface.points, options.spacing * resolution, keypoints, scratch);
  std::vector<std::uint8_t> is_keypoint(surface.points.size(), 0);
  for (std::size_t k = 0; k < keypoints.size(); k += options.stride) is_keypoint[keypoints[k]] = 1;

  Collection collection(surface.points.size());
  const auto describe_part = [&](auto&& is_seen) {
    Surface part;
    std::vector<std::uint32_t> local, point_of;  // keypoints, in the part and in the surface
    for (std::uint32_t i = 0; i < surface.points.size(); ++i) {
      if (!is_seen(i)) continue;
      if (is_keypoint[i] != 0) {
        local.push_back(static_cast<std::uint32_t>(part.points.size()));
        point_of.push_back(i);
      }
      part.points.push_back(surface.points[i]);
      part.normals.push_back(surface.normals[i]);
    }
    if (part.points.size() < kFewestSeen) return;
    Descriptions some;
    const std::vector<std::uint32_t> kept = describe_surface(
        part.points, part.normals, local, options.support * resolution, options.limits, some);
    std::vector<std::uint32_t> points;
    for (const std::uint32_t k : kept) points.push_back(point_of[k]);
    collection.add(some, points);
  };
  describe_part([](std::uint32_t) { return true; });
  for (std::size_t v = 0; v < kNumPartialViews; ++v) {
    describe_part(
        [&](std::uint32_t i) { return kernels::is_visible(surface.views[i], partial_view(v)); });
  }
  return std::move(collection).take();
}

}  // namespace trivet::engine
