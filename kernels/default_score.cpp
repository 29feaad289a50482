// Written by `trivet calibrate` 0.1.0, from 180 rendered scenes with 721 right and
// 4875 wrong detections; log loss 0.1223. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-24.187F, {{
    {-4.6052F, -4.6052F, -3.2455F, -1.8359F, -0.57088F},  // violation
    {-3.912F, -3.912F, -3.912F, -2.616F, -1.0642F},  // crossed
    {-3.912F, -3.912F, -3.912F, -3.2271F, -1.5849F},  // touching
    {0.012617F, 0.10976F, 0.16077F, 0.21115F, 0.30799F},  // residual
    {-5.0013F, -3.9861F, -3.5166F, -2.9904F, -1.9197F},  // smooth
    {-3.912F, -2.2767F, -1.8883F, -1.5956F, -1.0943F},  // slope
    {-8.1117F, -5.6755F, -4.7163F, -4.0973F, -3.1834F},  // hold
    {-2.3073F, -1.1907F, -0.77943F, -0.40115F, -0.026079F},  // consistent
    {0.0F, 0.0F, 0.027027F, 0.085586F, 0.39389F},  // unknown
    {3.8918F, 5.3033F, 5.3033F, 5.3033F, 5.3033F},  // pixels
    {-4.1352F, -4.1352F, -3.7856F, -3.3385F, -2.1351F},  // coarseness
  }}, {{
    {0.0F, 0.0F, 3.0303F, 1.0749F},  // violation
    {0.0F, 0.0F, 3.1588F, 1.691F},  // crossed
    {0.0F, 0.0F, 0.26403F, 0.75301F},  // touching
    {0.0F, 0.0F, 1.0374F, 1.1902F},  // residual
    {0.13912F, 0.0F, 0.57558F, 1.0603F},  // smooth
    {0.0F, 0.0F, 0.79551F, 0.38326F},  // slope
    {2.1015F, 0.37037F, 0.16018F, 0.0F},  // hold
    {0.0F, 0.22094F, 0.61685F, 2.7439F},  // consistent
    {0.0F, 0.0F, 0.0F, 0.52066F},  // unknown
    {3.925F, 0.0F, 0.0F, 0.0F},  // pixels
    {0.0F, 0.0F, 0.25044F, 1.5646F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
