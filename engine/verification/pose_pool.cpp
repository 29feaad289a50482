#include "engine/verification/pose_pool.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/common/check_models.hpp"
#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

struct PooledPose {
  const ModelStages* stages = nullptr;
  CoarsePose pose;
};
using PooledPoses = std::vector<PooledPose>;

/// Indices by falling value, ties by index.
std::vector<std::uint32_t> order_by(float CoarsePose::*value, const PooledPoses& poses) {
  std::vector<std::uint32_t> order(poses.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return poses[a].pose.*value > poses[b].pose.*value;
  });
  return order;
}

/// Take the best out of a pool; these and the rest keep their order.
PooledPoses take_best(float CoarsePose::*value, std::size_t limit, PooledPoses& pool) {
  if (pool.size() <= limit) return std::exchange(pool, {});
  std::vector<std::uint8_t> is_taken(pool.size(), 0);
  const std::vector<std::uint32_t> order = order_by(value, pool);
  for (std::size_t k = 0; k < limit; ++k) is_taken[order[k]] = 1;
  PooledPoses taken, rest;
  for (std::size_t k = 0; k < pool.size(); ++k)
    (is_taken[k] != 0 ? taken : rest).push_back(std::move(pool[k]));
  pool = std::move(rest);
  return taken;
}

/// Leave of each model's poses those that choose(stages, poses) gives, by model.
template <class Choose>
void choose_of_each(PooledPoses& poses, Choose&& choose) {
  std::map<std::uint32_t, std::pair<const ModelStages*, std::vector<CoarsePose>>> by_model;
  for (PooledPose& pooled : poses) {
    auto& [stages, of_model] = by_model[pooled.stages->index()];
    stages = pooled.stages;
    of_model.push_back(std::move(pooled.pose));
  }
  std::vector<std::pair<const ModelStages*, std::vector<CoarsePose>>*> all;
  for (auto& [index, of_model] : by_model) all.push_back(&of_model);
  for_each_index(all.size(), [&](std::size_t k) {
    auto& [stages, of_model] = *all[k];
    of_model = choose(*stages, of_model);
  });
  poses.clear();
  for (auto* const of_model : all) {
    for (CoarsePose& pose : of_model->second) poses.push_back({of_model->first, std::move(pose)});
  }
}

}  // namespace

struct PosePool::State {
  const Recognizer& recognizer;
  const PreparedScene& scene;
  const SettleOptions& options;
  StageTimes& times;
  PlaceWatch* watch;
  std::map<std::uint32_t, std::unique_ptr<const ModelStages>> stages{};  // by model
  PooledPoses seen{};  // all that were in the running, as they looked first
  PooledPoses waiting{};
  std::size_t num_looked_at = 0, num_refined = 0, num_examined = 0;

  /// Make what tests the poses of these models. Errors: bad_data (a model's samples are damaged).
  Result<void> prepare(std::span<const std::uint32_t> models) {
    std::vector<std::uint32_t> fresh;
    for (const std::uint32_t m : models) {
      if (stages.try_emplace(m).second) fresh.push_back(m);
    }
    const Result<void> good = check_models(recognizer.library(), fresh, ModelPart::samples);
    if (!good) return good;
    for (const std::uint32_t m : fresh)
      stages[m] = std::make_unique<const ModelStages>(recognizer, m, scene, options);
    return {};
  }

  /// Call body(stages, pose) for each.
  template <class Body>
  void for_each_pose(PooledPoses& poses, Body&& body) const {
    for_each_index(poses.size(), [&](std::size_t k) { body(*poses[k].stages, poses[k].pose); });
  }

  /// Nonzero for poses on marked pixels.
  std::vector<std::uint8_t> marked(const PooledPoses& poses,
                                   std::span<const std::uint8_t> pixels) const {
    std::vector<std::uint8_t> out(poses.size(), 0);
    if (pixels.empty()) return out;
    for_each_index(poses.size(), [&](std::size_t k) {
      out[k] = poses[k].stages->is_marked(poses[k].pose, pixels) ? 1 : 0;
    });
    return out;
  }

  void tell(PoseStage stage, const PooledPoses& poses) const {
    if (watch == nullptr) return;
    for (const auto& [of, pose] : poses)
      watch->note(stage, of->index(), pose.T_scene_model,
                  stage == PoseStage::looked_at ? pose.votes : pose.score);
  }

  void refine(PooledPoses& poses) {
    tell(PoseStage::refined, poses);
    {
      const StageTimer timer(times, "refine");
      for_each_pose(poses, [](const ModelStages& of, CoarsePose& pose) { of.refine(pose); });
    }
    const StageTimer timer(times, "verify");
    PerThread<kernels::ContourScratch> scratch;
    for_each_pose(
        poses, [&](const ModelStages& of, CoarsePose& pose) { of.verify(pose, scratch.local()); });
    num_refined += poses.size();
  }

  using Surfaces = std::map<std::uint32_t, std::shared_ptr<const kernels::RayScene>>;  // by model

  Result<Surfaces> surfaces_of(const PooledPoses& poses) const {
    Surfaces surfaces;
    for (const PooledPose& pooled : poses) surfaces.try_emplace(pooled.stages->index());
    std::vector<Surfaces::iterator> missing;
    for (auto at = surfaces.begin(); at != surfaces.end(); ++at) {
      recognizer.library().ask_for(at->first, ModelPart::surface);
      missing.push_back(at);
    }
    std::vector<Result<void>> results(missing.size());
    for_each_index(missing.size(), [&](std::size_t k) {
      auto surface = recognizer.surface(missing[k]->first);
      if (surface) {
        missing[k]->second = *std::move(surface);
      } else {
        results[k] = surface.error();
      }
    });
    for (const Result<void>& result : results) {
      if (!result) return result.error();
    }
    return surfaces;
  }

  Result<std::vector<Candidate>> examine(const PooledPoses& poses) {
    tell(PoseStage::examined, poses);
    const StageTimer timer(times, "examine");
    auto surfaces = surfaces_of(poses);
    if (!surfaces) return surfaces.error();
    std::vector<std::optional<Candidate>> examined(poses.size());
    PerThread<kernels::ExamineScratch> scratch;
    for_each_index(poses.size(), [&](std::size_t k) {
      const ModelStages& of = *poses[k].stages;
      examined[k] =
          of.examine(*surfaces->at(of.index()), recognizer.score(), poses[k].pose, scratch.local());
    });
    num_examined += poses.size();
    std::vector<Candidate> candidates;
    for (std::optional<Candidate>& candidate : examined) {
      if (candidate) candidates.push_back(*std::move(candidate));
    }
    return candidates;
  }
};

PosePool::PosePool(const Recognizer& recognizer, const PreparedScene& scene,
                   const SettleOptions& options, StageTimes& times, PlaceWatch* watch)
    : state_(new State{recognizer, scene, options, times, watch}) {}
PosePool::~PosePool() = default;

Result<void> PosePool::add(std::span<const ModelProposals> proposals, const PoseBudget& budget) {
  State& s = *state_;
  PooledPoses poses;
  {
    const StageTimer timer(s.times, "cluster");
    std::vector<std::uint32_t> models;
    for (const ModelProposals& of_model : proposals) models.push_back(of_model.model);
    TRIVET_TRY(s.prepare(models));
    std::vector<const ModelStages*> stages;
    for (const std::uint32_t m : models) stages.push_back(s.stages.at(m).get());
    if (s.watch != nullptr) {
      for (const ModelProposals& of_model : proposals)
        for (const Proposals& of_source : of_model.proposals)
          for (const kernels::Hypothesis& one : of_source.hypotheses)
            s.watch->note(PoseStage::proposed, of_model.model, one.T_scene_model, one.votes);
    }
    std::vector<std::vector<CoarsePose>> clusters(proposals.size());
    for_each_index(proposals.size(), [&](std::size_t k) {
      clusters[k] = stages[k]->cluster(proposals[k].proposals);
    });
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      for (CoarsePose& pose : clusters[k]) poses.push_back({stages[k], std::move(pose)});
    }
    poses = take_best(&CoarsePose::votes, budget.looked_at, poses);
  }
  const StageTimer timer(s.times, "preselect");
  s.tell(PoseStage::looked_at, poses);
  s.for_each_pose(poses, [](const ModelStages& of, CoarsePose& pose) { of.look(pose); });
  s.num_looked_at += poses.size();
  choose_of_each(poses, [](const ModelStages& of, const auto& looked_at) {
    return of.in_the_running(looked_at);
  });
  s.seen.insert(s.seen.end(), poses.begin(), poses.end());
  std::ranges::move(poses, std::back_inserter(s.waiting));
  return {};
}

std::vector<std::uint32_t> PosePool::likely_models(std::size_t limit,
                                                   std::span<const std::uint8_t> explained) const {
  const PooledPoses& seen = state_->seen;
  const std::vector<std::uint8_t> is_explained = state_->marked(seen, explained);
  std::map<std::uint32_t, float> best;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (is_explained[k] != 0) continue;
    float& score = best[seen[k].stages->index()];
    score = std::max(score, seen[k].pose.score);
  }
  std::vector<std::pair<std::uint32_t, float>> order(best.begin(), best.end());
  std::ranges::stable_sort(order, std::ranges::greater(), &std::pair<std::uint32_t, float>::second);
  order.resize(std::min(order.size(), limit));
  std::vector<std::uint32_t> models;
  for (const auto& [model, score] : order) models.push_back(model);
  std::ranges::sort(models);
  return models;
}

Result<std::vector<Candidate>> PosePool::test_best(const PoseBudget& budget,
                                                   std::span<const std::uint8_t> explained) {
  State& s = *state_;
  PooledPoses poses;
  {
    const StageTimer timer(s.times, "preselect");
    const std::vector<std::uint8_t> given_up = s.marked(s.waiting, explained);
    std::size_t at = 0;
    std::erase_if(s.waiting, [&](const PooledPose&) { return given_up[at++] != 0; });
    const std::size_t running = budget.refined < PoseBudget::kNoLimit / kContourShare
                                    ? kContourShare * budget.refined
                                    : PoseBudget::kNoLimit;
    poses = take_best(&CoarsePose::score, running, s.waiting);
    PerThread<kernels::ContourScratch> scratch;
    s.for_each_pose(poses, [&](const ModelStages& of, CoarsePose& pose) {
      of.judge_contour(pose, scratch.local());
    });
    choose_of_each(poses,
                   [](const ModelStages& of, const auto& judged) { return of.preselect(judged); });
    poses = take_best(&CoarsePose::score, budget.refined, poses);
  }
  s.refine(poses);
  choose_of_each(poses,
                 [](const ModelStages& of, const auto& verified) { return of.hopeful(verified); });
  return s.examine(take_best(&CoarsePose::score, budget.examined, poses));
}

Result<std::vector<Candidate>> PosePool::test(std::span<const std::vector<SuggestedPose>> lists,
                                              std::size_t examined) {
  State& s = *state_;
  std::vector<std::uint32_t> models;
  for (const std::vector<SuggestedPose>& list : lists) {
    for (const SuggestedPose& suggested : list) models.push_back(suggested.model);
  }
  TRIVET_TRY(s.prepare(models));
  PooledPoses all;
  for (const std::vector<SuggestedPose>& list : lists) {
    for (const SuggestedPose& suggested : list) {
      all.push_back({s.stages.at(suggested.model).get(), {Source::trisi, suggested.T_scene_model}});
    }
  }
  s.refine(all);
  PooledPoses chosen;
  auto next = all.begin();
  for (const std::vector<SuggestedPose>& list : lists) {
    const auto end = next + static_cast<std::ptrdiff_t>(list.size());
    PooledPoses of_list(std::make_move_iterator(next), std::make_move_iterator(end));
    next = end;
    std::ranges::move(take_best(&CoarsePose::score, examined, of_list), std::back_inserter(chosen));
  }
  choose_of_each(chosen,
                 [](const ModelStages& of, const auto& verified) { return of.hopeful(verified); });
  return s.examine(chosen);
}

Result<std::vector<kernels::JudgedRay>> PosePool::judged_rays(const SuggestedPose& suggested) {
  const Result<void> prepared = state_->prepare({&suggested.model, 1});
  if (!prepared) return prepared.error();
  const auto surface = state_->recognizer.surface(suggested.model);
  if (!surface) return surface.error();
  return state_->stages.at(suggested.model)
      ->tester()
      .judged_rays(**surface, suggested.T_scene_model);
}

std::size_t PosePool::num_looked_at() const noexcept { return state_->num_looked_at; }
std::size_t PosePool::num_refined() const noexcept { return state_->num_refined; }
std::size_t PosePool::num_examined() const noexcept { return state_->num_examined; }

}  // namespace trivet::engine
