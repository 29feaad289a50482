// Written by `trivet calibrate` 0.1.0, from 120 rendered scenes with 685 right and
// 4395 wrong detections; log loss 0.0858. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-26.734F, {{
    {-4.6052F, -4.6052F, -3.6443F, -2.2175F, -0.6362F},  // violation
    {-3.912F, -3.912F, -2.8519F, -1.8895F, -0.72615F},  // crossed
    {-3.912F, -3.912F, -3.912F, -2.82F, -1.3341F},  // touching
    {0.01788F, 0.11319F, 0.16209F, 0.21208F, 0.30505F},  // residual
    {-4.9319F, -4.0405F, -3.5551F, -3.0276F, -1.9543F},  // smooth
    {-3.912F, -2.2731F, -1.8781F, -1.584F, -1.0782F},  // slope
    {-8.1117F, -5.6799F, -4.6207F, -4.0013F, -3.149F},  // hold
    {-2.2789F, -1.1338F, -0.73959F, -0.38171F, -0.022475F},  // consistent
    {0.0F, 0.0F, 0.01698F, 0.073699F, 0.35398F},  // unknown
    {3.9318F, 5.2679F, 5.3033F, 5.3033F, 5.3033F},  // pixels
    {-4.1352F, -4.1352F, -3.6562F, -3.1616F, -1.7182F},  // coarseness
  }}, {{
    {0.0F, 0.0F, 2.6167F, 2.3054F},  // violation
    {0.0F, 1.6992F, 2.7297F, 2.1985F},  // crossed
    {0.0F, 0.0F, 0.057899F, 0.77716F},  // touching
    {0.0F, 0.0F, 0.86742F, 0.0F},  // residual
    {0.22335F, 0.0F, 1.009F, 2.3623F},  // smooth
    {0.0F, 0.0F, 0.64201F, 0.0F},  // slope
    {2.1288F, 0.56857F, 0.01852F, 0.2516F},  // hold
    {0.0F, 0.0F, 1.0133F, 1.9926F},  // consistent
    {0.0F, 0.0F, 0.0F, 0.8583F},  // unknown
    {0.0F, 4.1728F, 0.0F, 0.0F},  // pixels
    {0.0F, 0.0F, 1.1701F, 1.5636F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
