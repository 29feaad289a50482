#include "engine/verification/place_watch.hpp"

#include <Eigen/Geometry>

namespace trivet::engine {
namespace {

constexpr float kSigmas = 3;

}  // namespace

bool PlaceWatch::reaches(std::uint32_t model, const Pose& T_scene_model, float share) const {
  const Model& m = library_.models[model];
  const Eigen::Vector3f point = T_scene_model.inverse() * point_;
  // Samples are points of a surface: the place may lie between them.
  const float reach = share * m.diameter + m.sample_spacing + kSigmas * noise_;
  if ((point - m.center).norm() > m.diameter + reach) return false;
  const PointsView samples = m.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if ((samples[i] - point).squaredNorm() <= reach * reach) return true;
  }
  return false;
}

void PlaceWatch::note(PoseStage stage, std::uint32_t model, const Pose& T_scene_model,
                      float merit) {
  if (!reaches(model, T_scene_model)) return;
  OfModel& of = models_[model];
  ++of.num_poses[static_cast<std::size_t>(stage)];
  if (!of.furthest || stage > of.furthest->stage ||
      (stage == of.furthest->stage && merit > of.furthest->merit))
    of.furthest = Furthest{stage, T_scene_model, merit};
}

}  // namespace trivet::engine
