#include "engine/select_detections.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/pose_math.hpp"

namespace trivet::engine {
namespace {

/// The pixels of all images, marked where an accepted detection explains them.
class ExplainedPixels {
 public:
  explicit ExplainedPixels(std::span<const kernels::RangeImage> images) : images_(images) {
    std::size_t n = 0;
    for (const kernels::RangeImage& image : images) {
      first_.push_back(n);
      n += image.depth.size();
    }
    marked_.assign(n, 0);
  }

  float share_marked(std::span<const std::uint32_t> pixels) const {
    std::size_t count = 0;
    for (const std::uint32_t pixel : pixels) count += marked_[pixel];
    return pixels.empty() ? 0 : static_cast<float>(count) / static_cast<float>(pixels.size());
  }

  /// Samples lie `spacing` apart: mark a square of that size around each.
  void mark(std::span<const std::uint32_t> pixels, float spacing) {
    for (const std::uint32_t pixel : pixels) {
      const auto at = static_cast<std::size_t>(
                          std::upper_bound(first_.begin(), first_.end(), pixel) - first_.begin()) -
                      1;
      const kernels::RangeImage& image = images_[at];
      const std::size_t local = pixel - first_[at];
      const float depth = image.depth[local];
      const auto width = static_cast<std::ptrdiff_t>(image.geometry.width);
      const auto height = static_cast<std::ptrdiff_t>(image.geometry.height);
      const auto radius =
          depth > 0 ? static_cast<std::ptrdiff_t>(0.6F * spacing * image.geometry.fx / depth + 0.5F)
                    : 0;
      const std::ptrdiff_t u = static_cast<std::ptrdiff_t>(local) % width,
                           v = static_cast<std::ptrdiff_t>(local) / width;
      for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, v - radius);
           y <= std::min(height - 1, v + radius); ++y) {
        for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, u - radius);
             x <= std::min(width - 1, u + radius); ++x) {
          marked_[first_[at] + static_cast<std::size_t>(y * width + x)] = 1;
        }
      }
    }
  }

 private:
  std::span<const kernels::RangeImage> images_;
  std::vector<std::size_t> first_;
  std::vector<std::uint8_t> marked_;
};

}  // namespace

std::vector<Detection> select_detections(const Library& library, const PreparedScene& scene,
                                         std::vector<Candidate> candidates,
                                         const RecogniseOptions& options, double scene_scale) {
  std::vector<float> rank(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const float spacing = library.models[candidates[c].model].sample_spacing;
    const float area = static_cast<float>(candidates[c].evidence.consistent) * spacing * spacing;
    rank[c] = candidates[c].score * std::pow(area, 0.25F);
  }
  std::vector<std::uint32_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto doubtful = [&](std::uint32_t c) { return candidates[c].score < options.min_score; };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return doubtful(a) != doubtful(b) ? doubtful(b) : rank[a] > rank[b];
  });

  ExplainedPixels pixels(scene.images);
  std::vector<std::uint32_t> instances(library.models.size(), 0);
  std::vector<Detection> detections;
  for (const std::uint32_t c : order) {
    const Candidate& candidate = candidates[c];
    const Model& model = library.models[candidate.model];
    if (doubtful(c) && !(candidate.score >= options.doubtful_score.value_or(1))) continue;
    if (pixels.share_marked(candidate.explained) > options.verify.max_overlap) continue;
    pixels.mark(candidate.explained, model.sample_spacing);
    if (instances[candidate.model]++ >= options.max_instances) continue;  // seen, not asked for

    Detection detection;
    detection.model = model.name;
    detection.score = candidate.score;
    detection.T_scene_model = candidate.T_scene_model;
    detection.T_scene_model.translation() /= static_cast<float>(scene_scale);
    detection.visible_fraction = candidate.evidence.visible_fraction();
    detection.violation = candidate.evidence.violation_fraction();
    detection.contour = candidate.evidence.contour();
    detection.rmse = candidate.evidence.rmse() / static_cast<float>(scene_scale);
    detections.push_back(std::move(detection));
  }
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return detections;
}

}  // namespace trivet::engine
