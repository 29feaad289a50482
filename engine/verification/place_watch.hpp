/// Counts the poses of each model that reach to a place, stage by stage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "engine/results/explanation.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// How far from a posed model's samples a place may lie to be its own [diameters]: of poses as votes
/// leave them, and of refined ones.
inline constexpr float kReach = 0.1F, kTouch = 0.03F;

class PlaceWatch {
 public:
  /// What came furthest of a model, as it was there; the best of its stage.
  struct Furthest {
    PoseStage stage = PoseStage::proposed;
    Pose T_scene_model = Pose::Identity();
    float merit = 0;
  };
  struct OfModel {
    std::array<std::size_t, kNumPoseStages> num_poses{};
    std::optional<Furthest> furthest{};
  };

  /// point  in the scene's frame [library unit]
  /// noise  of the scan there [library unit]: a measured place lies so far from its surface
  PlaceWatch(const Library& library, const Eigen::Vector3f& point, float noise)
      : library_(library), point_(point), noise_(noise) {}

  /// Whether a posed model reaches to the place. Its samples must have been checked.
  bool reaches(std::uint32_t model, const Pose& T_scene_model, float share = kReach) const;
  /// A pose came to a stage. merit  by which it is held against others of its stage
  void note(PoseStage stage, std::uint32_t model, const Pose& T_scene_model, float merit);

  const std::map<std::uint32_t, OfModel>& models() const noexcept { return models_; }

 private:
  const Library& library_;
  const Eigen::Vector3f point_;
  const float noise_;
  std::map<std::uint32_t, OfModel> models_;
};

}  // namespace trivet::engine
