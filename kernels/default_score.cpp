// Written by `trivet calibrate` 0.1.0, from 132 rendered scenes with 441 right and
// 3012 wrong detections; prior share of right ones 0.375. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{-33.4F, {{
    {-3.5066F, -2.756F, -2.0054F, -1.2547F, -0.50414F},  // violation
    {-2.9957F, -2.4F, -1.8F, -1.2F, -0.6F},  // background
    {0.0F, 0.25F, 0.5F, 0.75F, 1.0F},  // free
    {-2.9957F, -2.4506F, -1.9055F, -1.3604F, -0.81526F},  // crossed
    {-2.9957F, -2.5721F, -2.1484F, -1.7248F, -1.3011F},  // touching
    {-2.9957F, -2.4076F, -1.8195F, -1.2313F, -0.6432F},  // buried
    {0.02115F, 0.096416F, 0.17168F, 0.24695F, 0.32221F},  // residual
    {-4.8938F, -4.121F, -3.3481F, -2.5753F, -1.8024F},  // smooth
    {-3.912F, -3.1948F, -2.4776F, -1.7604F, -1.0432F},  // slope
    {-8.1116F, -6.8643F, -5.617F, -4.3697F, -3.1224F},  // hold
    {-2.3413F, -1.7633F, -1.1853F, -0.60729F, -0.029287F},  // consistent
    {0.0F, 0.11064F, 0.22129F, 0.33193F, 0.44257F},  // unknown
    {4.0775F, 4.384F, 4.6904F, 4.9969F, 5.3033F},  // pixels
    {-4.1352F, -3.5305F, -2.9258F, -2.321F, -1.7163F},  // coarseness
  }}, {{
    {0.74937F, 2.2363F, 0.49168F, 0.41676F},  // violation
    {0.5F, 0.5F, 0.5F, 0.5F},  // background
    {0.5F, 0.5F, 0.5F, 0.5F},  // free
    {2.4299F, 2.5901F, 0.90371F, 0.0F},  // crossed
    {0.63011F, 0.84717F, 0.79658F, 0.46194F},  // touching
    {2.6615F, 1.7872F, 0.55755F, 0.0F},  // buried
    {0.0F, 0.3436F, 2.1014F, 0.0F},  // residual
    {0.0F, 0.54235F, 0.82443F, 0.0F},  // smooth
    {0.0F, 0.0F, 0.17298F, 0.54045F},  // slope
    {2.4092F, 1.7985F, 1.2188F, 0.61451F},  // hold
    {0.0F, 0.47289F, 0.61836F, 1.0757F},  // consistent
    {0.44847F, 0.76548F, 0.94126F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.93717F, 1.7F},  // pixels
    {0.0F, 1.8605F, 0.0F, 0.0F},  // coarseness
  }}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
