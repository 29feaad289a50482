#include "engine/selection/select_detections.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// A candidate that will be refused explains nothing: those that are reported by default, or by the
// score that is asked for, have the first choice of the scene's pixels, then those that are right
// rather than wrong.
constexpr float kReported = 0.8F, kLikely = 0.5F;
// What is explained is not searched again. Of the detections below this too many are wrong, and
// hide the right ones.
constexpr float kSure = 0.95F;

/// How much of a candidate is explained already.
struct Cover {
  float share = 0;            // of its pixels, by all accepted candidates
  std::uint32_t most_by = 0;  // the one that explains most of them; with a share above 0
  float most_share = 0;
};

/// The pixels of all images, marked with the accepted candidate that explained them first.
class PixelMarks {
 public:
  PixelMarks(std::span<const ImageSize> images, std::size_t num_candidates)
      : images_(images), counts_(num_candidates + 1, 0) {
    std::size_t n = 0;
    for (const ImageSize& image : images) {
      first_.push_back(n);
      n += std::size_t{image.width} * image.height;
    }
    marks_.assign(n, 0);
  }

  /// Of several that explain as much, the one that comes first in `pixels` counts.
  Cover cover_of(const kernels::ExplainedPixels& explained) {
    std::uint32_t marked = 0, most = 0;
    Cover cover;
    for (const std::uint32_t pixel : explained.pixels) {
      const std::uint32_t by = marks_[pixel];
      if (by == 0) continue;
      ++marked;
      if (++counts_[by] > most) {
        most = counts_[by];
        cover.most_by = by - 1;
      }
    }
    for (const std::uint32_t pixel : explained.pixels) counts_[marks_[pixel]] = 0;
    if (marked == 0) return cover;
    const auto all = static_cast<float>(explained.pixels.size());
    cover.share = static_cast<float>(marked) / all;
    cover.most_share = static_cast<float>(most) / all;
    return cover;
  }

  void mark(std::uint32_t candidate, const kernels::ExplainedPixels& explained) {
    const auto side = static_cast<std::ptrdiff_t>(explained.square);
    const std::ptrdiff_t before = (side - 1) / 2, after = side / 2;
    for (const std::uint32_t pixel : explained.pixels) {
      const auto at = static_cast<std::size_t>(
                          std::upper_bound(first_.begin(), first_.end(), pixel) - first_.begin()) -
                      1;
      const auto local = static_cast<std::ptrdiff_t>(pixel - first_[at]);
      const auto width = static_cast<std::ptrdiff_t>(images_[at].width);
      const auto height = static_cast<std::ptrdiff_t>(images_[at].height);
      const std::ptrdiff_t u = local % width, v = local / width;
      for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, v - before);
           y <= std::min(height - 1, v + after); ++y) {
        for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, u - before);
             x <= std::min(width - 1, u + after); ++x) {
          std::uint32_t& by = marks_[first_[at] + static_cast<std::size_t>(y * width + x)];
          if (by == 0) by = candidate + 1;
        }
      }
    }
  }

  /// One a pixel: 1 where a candidate explained it of which `holds` is true.
  template <class Holds>
  std::vector<std::uint8_t> marked(Holds&& holds) const {
    std::vector<std::uint8_t> out(marks_.size());
    std::transform(marks_.begin(), marks_.end(), out.begin(),
                   [&](std::uint32_t by) { return by != 0 && holds(by - 1) ? 1 : 0; });
    return out;
  }

 private:
  std::span<const ImageSize> images_;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> marks_;   // index of the candidate + 1
  std::vector<std::uint32_t> counts_;  // by mark; all zero between calls
};

/// Score x area^0.25: large surfaces prove more; by poses alone the score.
float rank_of(const Model& model, const Candidate& candidate, const SelectOptions& options) {
  if (!options.by_pixels) return candidate.score;
  const float area = candidate.examination.area * model.diameter * model.diameter;
  return candidate.score * std::pow(area, 0.25F);
}

}  // namespace

Selection select_claims(std::span<const ImageSize> images, std::span<const Claim> claims,
                        const SelectOptions& options, const Repeats& repeats) {
  std::vector<std::uint32_t> order(claims.size());
  std::iota(order.begin(), order.end(), 0U);
  const float reported = std::max(options.min_score, kReported);
  const float likely = std::min(options.min_score, kLikely);
  const auto doubtful = [&](std::uint32_t c) { return claims[c].score < likely; };
  const auto doubts = [&](std::uint32_t c) {
    return (claims[c].score < reported ? 1 : 0) + (doubtful(c) ? 1 : 0);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return doubts(a) != doubts(b) ? doubts(a) < doubts(b) : claims[a].rank > claims[b].rank;
  });

  Selection selection;
  PixelMarks marks(images, claims.size());
  std::map<std::uint32_t, std::uint32_t> instances;  // by model
  for (const std::uint32_t c : order) {
    check_stop();
    const Claim& claim = claims[c];
    const Cover cover = marks.cover_of(*claim.explained);
    const bool explained =
        repeats ? repeats(selection.chosen, c) : cover.share > options.max_overlap;
    const auto refuse = [&](Rejection reason) {
      RejectedCandidate refusal{c, reason};
      if (explained && !repeats) {
        refusal.explained_by = cover.most_by;
        refusal.explained_share = cover.most_share;
      }
      selection.refused.push_back(refusal);
    };
    if (doubtful(c) && !(claim.score >= options.doubtful_score.value_or(1))) {
      refuse(Rejection::too_low);
    } else if (explained) {
      refuse(Rejection::explained);
    } else {
      marks.mark(c, *claim.explained);
      if (instances[claim.model]++ < options.max_instances) {
        selection.chosen.push_back(c);
      } else {
        refuse(Rejection::too_many);
      }
    }
  }
  const float sure = std::max(options.min_score, kSure);
  selection.explained = marks.marked([&](std::uint32_t c) { return claims[c].score >= sure; });
  return selection;
}

std::vector<std::uint32_t> take_unexplained(std::span<const ImageSize> images,
                                            std::span<const Claim> claims,
                                            std::span<const std::uint32_t> standing,
                                            const SelectOptions& options,
                                            std::vector<RejectedCandidate>& refused) {
  std::vector<std::uint32_t> which(standing.begin(), standing.end());
  for (const RejectedCandidate& refusal : refused) {
    if (refusal.reason == Rejection::too_many) which.push_back(refusal.candidate);
  }
  const std::size_t num_standing = which.size();
  const auto is_unexplained = [&](const RejectedCandidate& refusal) {
    const auto first = which.begin(), last = first + static_cast<std::ptrdiff_t>(num_standing);
    return refusal.explained_by && claims[refusal.candidate].score >= options.min_score &&
           std::find(first, last, *refusal.explained_by) == last;
  };
  for (const RejectedCandidate& refusal : refused) {
    if (is_unexplained(refusal)) which.push_back(refusal.candidate);
  }
  if (which.size() == num_standing) return {};
  std::erase_if(refused, is_unexplained);
  std::vector<Claim> among;
  for (const std::uint32_t c : which) among.push_back(claims[c]);
  for (Claim& claim : std::span(among).first(num_standing))
    claim = {claim.model, 1, std::numeric_limits<float>::infinity(), claim.explained};
  const Selection selection = select_claims(images, among, options);
  for (RejectedCandidate refusal : selection.refused) {
    if (refusal.candidate < num_standing) continue;  // one too many, as before
    refusal.candidate = which[refusal.candidate];
    if (refusal.explained_by) refusal.explained_by = which[*refusal.explained_by];
    refused.push_back(refusal);
  }
  std::vector<std::uint32_t> taken;
  for (const std::uint32_t k : selection.chosen) {
    if (k >= num_standing) taken.push_back(which[k]);
  }
  return taken;
}

std::vector<ImageSize> sizes_of(const PreparedScene& scene) {
  std::vector<ImageSize> sizes;
  for (const kernels::RangeImage& image : scene.images)
    sizes.push_back({image.geometry.width, image.geometry.height});
  return sizes;
}

std::vector<Claim> claims_of(const Library& library, std::span<const Candidate> candidates,
                             const SelectOptions& options) {
  std::vector<Claim> claims;
  for (const Candidate& candidate : candidates) {
    claims.push_back({candidate.model, candidate.score,
                      rank_of(library.models[candidate.model], candidate, options),
                      &candidate.explained});
  }
  return claims;
}

Selection select_detections(const Library& library, const PreparedScene& scene,
                            std::span<const Candidate> candidates, const SelectOptions& options) {
  Repeats repeats;
  if (!options.by_pixels) {
    repeats = [&](std::span<const std::uint32_t> taken, std::uint32_t c) {
      const Candidate& candidate = candidates[c];
      return std::ranges::any_of(taken, [&](std::uint32_t other) {
        return candidates[other].model == candidate.model &&
               same_placement(library.models[candidate.model], candidates[other].T_scene_model,
                              candidate.T_scene_model);
      });
    };
  }
  return select_claims(sizes_of(scene), claims_of(library, candidates, options), options, repeats);
}

std::vector<RejectedCandidate> best_refused(const Library& library,
                                            std::span<const Candidate> candidates,
                                            std::span<const RejectedCandidate> refused,
                                            std::span<const Candidate> detections,
                                            std::uint32_t limit) {
  const auto score = [&](const RejectedCandidate& refusal) {
    return candidates[refusal.candidate].score;
  };
  const auto beneath_its_like = [&](const RejectedCandidate& refusal) {
    return refusal.explained_by &&
           candidates[*refusal.explained_by].model == candidates[refusal.candidate].model;
  };
  std::vector<RejectedCandidate> order(refused.begin(), refused.end());
  std::stable_sort(order.begin(), order.end(),
                   [&](const RejectedCandidate& a, const RejectedCandidate& b) {
                     return beneath_its_like(a) != beneath_its_like(b) ? beneath_its_like(b)
                                                                       : score(a) > score(b);
                   });
  std::vector<std::vector<Pose>> known(library.models.size());
  for (const Candidate& detection : detections) {
    std::vector<Pose>& poses = known[detection.model];
    poses.push_back(detection.T_scene_model);
    poses.insert(poses.end(), detection.alternatives.begin(), detection.alternatives.end());
  }
  std::vector<std::uint32_t> taken(library.models.size(), 0);
  std::vector<RejectedCandidate> out;
  for (const RejectedCandidate& refusal : order) {
    const Candidate& candidate = candidates[refusal.candidate];
    if (taken[candidate.model] == limit) continue;
    std::vector<Pose>& poses = known[candidate.model];
    const bool repeats = std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
      return same_placement(library.models[candidate.model], pose, candidate.T_scene_model);
    });
    if (repeats) continue;
    poses.push_back(candidate.T_scene_model);
    ++taken[candidate.model];
    out.push_back(refusal);
  }
  std::stable_sort(
      out.begin(), out.end(),
      [&](const RejectedCandidate& a, const RejectedCandidate& b) { return score(a) > score(b); });
  return out;
}

}  // namespace trivet::engine
