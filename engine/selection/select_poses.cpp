#include "engine/selection/select_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/poses/placement.hpp"
#include "engine/selection/pixel_marks.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// A pose that will be refused explains nothing. Poses that are reported by default, or by the
// required score, therefore choose the scene's pixels first, followed by those that are more likely
// correct than wrong.
constexpr float kReported = 0.8F, kLikely = 0.5F;
// Explained pixels are not searched again. Of the detections below this score, too many are wrong
// and would hide correct ones.
constexpr float kSure = 0.95F;

/// Score x area^0.25, or the score alone if poses are chosen without pixels.
float rank_of(const TestedPoses& poses, Row row, const SelectOptions& options) {
  const float score = poses.table.score[row];
  if (!options.by_pixels) return score;
  const ModelInfo& model = poses.library.models[poses.table.model[row]];
  const float area = poses.table.test(row).examination.area * model.diameter * model.diameter;
  return score * std::pow(area, 0.25F);
}

/// A candidate for the choice.
struct Contender {
  Row row = 0;
  float score = 0;
  float rank = 0;  // higher ones choose first
};

bool repeats(const TestedPoses& poses, std::span<const Row> chosen, Row row) {
  const PoseTable& table = poses.table;
  return std::ranges::any_of(chosen, [&](Row other) {
    return table.model[other] == table.model[row] &&
           same_placement(poses.library.models[table.model[row]], table.T_scene_model[other],
                          table.T_scene_model[row]);
  });
}

/// Sort poses that are reported by default, or by the required score, first, followed by those that
/// are more likely correct than wrong. Within each group, sort by falling rank, ties in their
/// order.
void sort_by_choice(std::vector<Contender>& contenders, const SelectOptions& options) {
  const float reported = std::max(options.min_score, kReported);
  const float likely = std::min(options.min_score, kLikely);
  const auto doubts = [&](const Contender& c) {
    return (c.score < reported ? 1 : 0) + (c.score < likely ? 1 : 0);
  };
  std::ranges::stable_sort(contenders, [&](const Contender& a, const Contender& b) {
    return doubts(a) != doubts(b) ? doubts(a) < doubts(b) : a.rank > b.rank;
  });
}

Selection select(const TestedPoses& poses, std::vector<Contender> contenders,
                 const SelectOptions& options) {
  const PoseTable& table = poses.table;
  sort_by_choice(contenders, options);
  const float likely = std::min(options.min_score, kLikely);
  Selection selection;
  PixelMarks marks(poses.scene.images, contenders.size());
  std::map<std::uint32_t, std::uint32_t> instances;  // number per model
  for (std::uint32_t c = 0; c < contenders.size(); ++c) {
    check_stop();
    const auto [row, score, rank] = contenders[c];
    const kernels::ExplainedPixels& pixels = table.test(row).explained;
    const Cover cover = marks.cover_of(pixels);
    const bool explained = options.by_pixels ? cover.share > options.max_overlap
                                             : repeats(poses, selection.chosen, row);
    const auto refuse = [&, row = row](Rejection reason) {
      Refusal refusal{row, reason};
      if (explained && options.by_pixels) {
        refusal.explained_by = contenders[cover.most_by].row;
        refusal.explained_share = cover.most_share;
      }
      selection.refused.push_back(refusal);
    };
    if (score < likely && !(score >= options.doubtful_score.value_or(1))) {
      refuse(Rejection::too_low);
    } else if (explained) {
      refuse(Rejection::explained);
    } else {
      marks.mark(c, pixels);
      if (instances[table.model[row]]++ < options.max_instances) {
        selection.chosen.push_back(row);
      } else {
        refuse(Rejection::too_many);
      }
    }
  }
  const float sure = std::max(options.min_score, kSure);
  selection.explained = marks.marked([&](std::uint32_t c) { return contenders[c].score >= sure; });
  return selection;
}

}  // namespace

Selection select_poses(const TestedPoses& poses, const SelectOptions& options) {
  std::vector<Contender> contenders;
  for (const Row row : poses.rows)
    contenders.push_back({row, poses.table.score[row], rank_of(poses, row, options)});
  return select(poses, std::move(contenders), options);
}

std::vector<Row> choose_unexplained(const TestedPoses& poses, std::span<const Row> standing,
                                    const SelectOptions& options, std::vector<Refusal>& refused) {
  std::vector<Row> stands(standing.begin(), standing.end());
  for (const Refusal& refusal : refused) {
    if (refusal.reason == Rejection::too_many) stands.push_back(refusal.row);
  }
  const auto is_standing = [&](Row row) { return std::ranges::find(stands, row) != stands.end(); };
  const auto is_unexplained = [&](const Refusal& refusal) {
    return refusal.explained_by && poses.table.score[refusal.row] >= options.min_score &&
           !is_standing(*refusal.explained_by);
  };
  std::vector<Contender> contenders;
  for (const Row row : stands)
    contenders.push_back({row, 1, std::numeric_limits<float>::infinity()});
  for (const Refusal& refusal : refused) {
    if (is_unexplained(refusal))
      contenders.push_back(
          {refusal.row, poses.table.score[refusal.row], rank_of(poses, refusal.row, options)});
  }
  if (contenders.size() == stands.size()) return {};
  std::erase_if(refused, is_unexplained);
  const Selection selection = select(poses, std::move(contenders), options);
  for (const Refusal& refusal : selection.refused) {
    if (!is_standing(refusal.row)) refused.push_back(refusal);  // else too_many, as before
  }
  std::vector<Row> chosen;
  for (const Row row : selection.chosen) {
    if (!is_standing(row)) chosen.push_back(row);
  }
  return chosen;
}

std::vector<Row> best_refused(const Library& library, const PoseTable& table,
                              std::span<const Refusal> refused, std::span<const Row> detections,
                              std::uint32_t limit) {
  const auto beneath_its_like = [&](const Refusal& refusal) {
    return refusal.explained_by && table.model[*refusal.explained_by] == table.model[refusal.row];
  };
  std::vector<Refusal> order(refused.begin(), refused.end());
  std::ranges::stable_sort(order, [&](const Refusal& a, const Refusal& b) {
    return beneath_its_like(a) != beneath_its_like(b) ? beneath_its_like(b)
                                                      : table.score[a.row] > table.score[b.row];
  });
  std::vector<std::vector<Pose>> known(library.models.size());
  for (const Row row : detections) {
    std::vector<Pose>& placements = known[table.model[row]];
    const std::vector<Pose>& alternatives = table.ambiguity(row).alternatives;
    placements.push_back(table.T_scene_model[row]);
    placements.insert(placements.end(), alternatives.begin(), alternatives.end());
  }
  std::vector<std::uint32_t> num_selected(library.models.size(), 0);
  std::vector<Row> best;
  for (const Refusal& refusal : order) {
    const std::uint32_t model = table.model[refusal.row];
    const Pose& pose = table.T_scene_model[refusal.row];
    if (num_selected[model] == limit) continue;
    const bool is_known = std::ranges::any_of(known[model], [&](const Pose& placement) {
      return same_placement(library.models[model], placement, pose);
    });
    if (is_known) continue;
    known[model].push_back(pose);
    ++num_selected[model];
    best.push_back(refusal.row);
  }
  return by_falling(table.score, best);
}

}  // namespace trivet::engine
