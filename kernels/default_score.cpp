// Written by `trivet calibrate` 0.1.0, from 108 rendered scenes with 436 right and
// 1713 wrong detections; prior share of right ones 0.375. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-28.912F, {{
    {-3.5066F, -2.7636F, -2.0207F, -1.2777F, -0.53478F},  // violation
    {-2.9957F, -2.4644F, -1.933F, -1.4016F, -0.87024F},  // crossed
    {-2.9957F, -2.6723F, -2.3488F, -2.0253F, -1.7018F},  // touching
    {0.010447F, 0.086643F, 0.16284F, 0.23904F, 0.31523F},  // residual
    {-5.0606F, -4.2649F, -3.4692F, -2.6735F, -1.8778F},  // smooth
    {-3.912F, -3.2087F, -2.5053F, -1.8019F, -1.0986F},  // slope
    {-8.1117F, -6.8777F, -5.6436F, -4.4095F, -3.1755F},  // hold
    {-2.4775F, -1.8618F, -1.2461F, -0.63043F, -0.014722F},  // consistent
    {0.0F, 0.10676F, 0.21352F, 0.32028F, 0.42704F},  // unknown
    {3.8918F, 4.2447F, 4.5976F, 4.9504F, 5.3033F},  // pixels
    {-4.1352F, -3.6484F, -3.1616F, -2.6748F, -2.188F},  // coarseness
  }}, {{
    {0.0F, 3.1098F, 0.9492F, 0.66647F},  // violation
    {3.0992F, 1.8215F, 0.9565F, 0.54003F},  // crossed
    {0.84508F, 0.55377F, 0.0F, 0.0F},  // touching
    {0.031251F, 0.0F, 2.3431F, 0.0F},  // residual
    {0.66366F, 0.80124F, 2.1961F, 0.0F},  // smooth
    {0.0F, 0.0F, 0.0F, 0.73836F},  // slope
    {1.1013F, 1.4137F, 0.58092F, 0.55883F},  // hold
    {0.0F, 0.0F, 0.74725F, 2.4893F},  // consistent
    {0.0F, 0.22192F, 1.1035F, 0.82158F},  // unknown
    {0.0F, 0.0F, 0.99261F, 3.1031F},  // pixels
    {0.0F, 0.57418F, 1.4527F, 0.89391F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
