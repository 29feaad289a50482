/// A pose of a model on its way from hypothesis to detection.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "engine/results/recognize_result.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/pose_score.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

struct Candidate {
  std::uint32_t model = 0;
  Source source = Source::ppf;  ///< that proposed it
  Pose T_scene_model = Pose::Identity();
  float tolerance = 0;  ///< that it was examined with [library unit]
  // Of the full test, by rays.
  kernels::Examination examination;
  kernels::ScoreParts parts{};
  float score = 0;                     ///< probability of being right, 0..1
  kernels::ExplainedPixels explained;  ///< over all images
  // What the scan cannot tell from this pose.
  std::vector<Pose> alternatives;
  float pose_share = 1;  ///< of the score that is this pose's, the rest its alternatives', 0..1
  std::vector<std::uint32_t> siblings;  ///< models that it may be as well
  std::optional<TurnExtent> turns;  ///< about the model's near axis, if more than one is as likely
};

/// The probability whose odds are `factor` times those of this one, which is below 1.
float scale_odds(float probability, float factor) noexcept;

/// Limits within which a pose is right [diameters], [rad].
inline constexpr float kRightTranslation = 0.1F;
inline constexpr float kRightRotationRad = 12 * std::numbers::pi_v<float> / 180;

/// Whether two poses of a model are one placement of it, up to the limits within which a detection
/// is right, modulo symmetry.
/// Source: Drost et al., CVPR 2010, section 5.
bool same_placement(const Model& model, const Pose& a, const Pose& b) noexcept;

}  // namespace trivet::engine
