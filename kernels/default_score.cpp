// Written by `trivet calibrate` 0.1.0, from 120 rendered scenes with 664 right and
// 2911 wrong detections; log loss 0.0864. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-20.748F, {{
    {-8.2496F, -4.8107F, -2.9877F, -1.4333F, -0.41579F},  // violation
    {-6.1779F, -4.2767F, -3.0819F, -2.1059F, -0.87925F},  // crossed
    {0.01788F, 0.11735F, 0.17635F, 0.22918F, 0.32752F},  // residual
    {-5.4092F, -4.1644F, -3.4198F, -2.7797F, -1.869F},  // smooth
    {-4.6052F, -2.3422F, -1.8973F, -1.5907F, -1.1257F},  // slope
    {-8.1112F, -5.1682F, -4.4334F, -3.8761F, -3.1025F},  // hold
    {-2.976F, -1.7484F, -1.2111F, -0.75667F, -0.1626F},  // area
    {-2.2717F, -1.0878F, -0.69894F, -0.34664F, -0.020261F},  // consistent
    {0.0F, 0.0F, 0.033684F, 0.089004F, 0.30801F},  // unknown
    {4.4886F, 5.994F, 6.9518F, 7.76F, 9.1634F},  // pixels
    {-4.1352F, -4.1352F, -3.8258F, -3.4107F, -2.223F},  // coarseness
  }}, {{
    {0.0F, 1.061F, 3.6457F, 1.6234F},  // violation
    {1.9763F, 0.3193F, 1.883F, 2.2991F},  // crossed
    {0.0F, 0.38649F, 0.54727F, 0.39075F},  // residual
    {0.31791F, 0.33915F, 0.97653F, 1.3511F},  // smooth
    {0.0F, 0.0F, 0.92547F, 0.0F},  // slope
    {0.22732F, 0.38635F, 0.0F, 0.17152F},  // hold
    {0.0F, 0.0F, 0.0F, 0.0F},  // area
    {0.0F, 0.0F, 0.0F, 1.8791F},  // consistent
    {0.0F, 0.0F, 0.0062886F, 0.88366F},  // unknown
    {1.9207F, 2.0673F, 1.0116F, 0.55872F},  // pixels
    {0.0F, 0.0F, 0.0F, 0.0F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
