// Written by `trivet calibrate` 0.1.0, from 120 rendered scenes with 671 right and
// 3934 wrong detections; log loss 0.0694. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-23.068F, {{
    {-7.9628F, -4.7095F, -3.2758F, -1.6882F, -0.33462F},  // violation
    {-6.2206F, -4.8283F, -3.434F, -2.3979F, -1.1249F},  // crossed
    {0.0F, 0.10606F, 0.15832F, 0.20507F, 0.31342F},  // residual
    {-6.2146F, -4.2414F, -3.5858F, -2.9987F, -1.8889F},  // smooth
    {-4.6052F, -2.3993F, -1.9763F, -1.6753F, -1.0287F},  // slope
    {-8.1117F, -6.7562F, -5.0447F, -4.273F, -3.183F},  // hold
    {-4.6052F, -2.1043F, -1.5141F, -1.0927F, -0.27254F},  // area
    {-3.912F, -1.4442F, -1.0056F, -0.51193F, -0.021393F},  // consistent
    {0.0F, 0.0F, 0.031236F, 0.092249F, 0.45365F},  // unknown
    {0.0F, 5.1761F, 6.5294F, 7.4396F, 9.0086F},  // pixels
    {-4.1352F, -4.1352F, -3.7829F, -3.3396F, -2.0971F},  // coarseness
  }}, {{
    {0.0F, 0.71931F, 3.4747F, 2.5372F},  // violation
    {1.0796F, 1.2613F, 1.5039F, 2.4672F},  // crossed
    {0.0F, 0.0F, 1.0671F, 0.85153F},  // residual
    {0.0F, 0.28987F, 1.1577F, 1.1736F},  // smooth
    {0.0F, 0.0F, 0.92766F, 0.0F},  // slope
    {0.3445F, 1.2184F, 0.12141F, 0.0F},  // hold
    {0.0F, 0.0F, 0.0F, 0.0F},  // area
    {0.0F, 0.10644F, 0.0F, 1.2546F},  // consistent
    {0.0F, 0.0F, 0.30857F, 1.2201F},  // unknown
    {0.0F, 2.843F, 1.546F, 1.2143F},  // pixels
    {0.0F, 0.0F, 0.0F, 0.0F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
