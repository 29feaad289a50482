#include "engine/select_detections.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trivet::engine {
namespace {

/// The pixels of all images, marked where an accepted candidate explains them.
class PixelMarks {
 public:
  explicit PixelMarks(std::span<const kernels::RangeImage> images) : images_(images) {
    std::size_t n = 0;
    for (const kernels::RangeImage& image : images) {
      first_.push_back(n);
      n += image.depth.size();
    }
    marked_.assign(n, 0);
  }

  float share_marked(const kernels::ExplainedPixels& explained) const {
    std::size_t count = 0;
    for (const std::uint32_t pixel : explained.pixels) count += marked_[pixel];
    return explained.pixels.empty()
               ? 0
               : static_cast<float>(count) / static_cast<float>(explained.pixels.size());
  }

  void mark(const kernels::ExplainedPixels& explained) {
    const auto side = static_cast<std::ptrdiff_t>(explained.square);
    const std::ptrdiff_t before = (side - 1) / 2, after = side / 2;
    for (const std::uint32_t pixel : explained.pixels) {
      const auto at = static_cast<std::size_t>(
                          std::upper_bound(first_.begin(), first_.end(), pixel) - first_.begin()) -
                      1;
      const auto local = static_cast<std::ptrdiff_t>(pixel - first_[at]);
      const auto width = static_cast<std::ptrdiff_t>(images_[at].geometry.width);
      const auto height = static_cast<std::ptrdiff_t>(images_[at].geometry.height);
      const std::ptrdiff_t u = local % width, v = local / width;
      for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, v - before);
           y <= std::min(height - 1, v + after); ++y) {
        for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, u - before);
             x <= std::min(width - 1, u + after); ++x) {
          marked_[first_[at] + static_cast<std::size_t>(y * width + x)] = 1;
        }
      }
    }
  }

  const std::vector<std::uint8_t>& marked() const noexcept { return marked_; }

 private:
  std::span<const kernels::RangeImage> images_;
  std::vector<std::size_t> first_;
  std::vector<std::uint8_t> marked_;
};

}  // namespace

Selection select_detections(const Library& library, const PreparedScene& scene,
                            std::span<const Candidate> candidates,
                            const RecogniseOptions& options) {
  std::vector<float> rank(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const float diameter = library.models[candidates[c].model].diameter;
    const float area = candidates[c].examination.area * diameter * diameter;
    rank[c] = candidates[c].score * std::pow(area, 0.25F);
  }
  std::vector<std::uint32_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto doubtful = [&](std::uint32_t c) { return candidates[c].score < options.min_score; };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return doubtful(a) != doubtful(b) ? doubtful(b) : rank[a] > rank[b];
  });

  Selection selection;
  PixelMarks marks(scene.images);
  bool sure = true;
  std::vector<std::uint32_t> instances(library.models.size(), 0);
  for (const std::uint32_t c : order) {
    const Candidate& candidate = candidates[c];
    if (doubtful(c) && sure) {
      selection.explained = marks.marked();
      sure = false;
    }
    if (doubtful(c) && !(candidate.score >= options.doubtful_score.value_or(1))) continue;
    if (marks.share_marked(candidate.explained) > options.verify.max_overlap) continue;
    marks.mark(candidate.explained);
    if (instances[candidate.model]++ >= options.max_instances) continue;  // seen, not asked for
    selection.chosen.push_back(c);
  }
  if (sure) selection.explained = marks.marked();
  return selection;
}

}  // namespace trivet::engine
