// Written by `trivet calibrate` 0.1.0, from 1341 right and 22380 wrong detections in rendered
// scenes; the odds of right ones times 5. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{{-28.917F, -23.484F}, {{
    {-3.5066F, -2.8659F, -2.2252F, -1.5845F, -0.94375F},  // violation
    {-2.9957F, -2.3987F, -1.8017F, -1.2047F, -0.60768F},  // background
    {0.0F, 0.23799F, 0.47597F, 0.71396F, 0.95195F},  // free
    {-2.9957F, -2.4189F, -1.8421F, -1.2652F, -0.6884F},  // crossed
    {-2.9957F, -2.5197F, -2.0436F, -1.5675F, -1.0915F},  // touching
    {-2.9957F, -2.5093F, -2.0228F, -1.5363F, -1.0498F},  // buried
    {0.0F, 0.069491F, 0.13898F, 0.20847F, 0.27797F},  // residual
    {-5.2983F, -4.5321F, -3.7659F, -2.9997F, -2.2335F},  // smooth
    {-3.912F, -3.1416F, -2.3711F, -1.6007F, -0.83026F},  // slope
    {-8.1112F, -6.6919F, -5.2725F, -3.8532F, -2.4339F},  // hold
    {-1.6944F, -1.2798F, -0.86519F, -0.45058F, -0.035983F},  // consistent
    {0.0F, 0.12414F, 0.24828F, 0.37241F, 0.49655F},  // unknown
    {3.5835F, 4.0135F, 4.4434F, 4.8734F, 5.3033F},  // pixels
    {-4.1352F, -3.4221F, -2.7091F, -1.996F, -1.283F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}, {{
  {{  // where errors are independent from pixel to pixel
    {0.52915F, 1.2455F, 1.1032F, 1.188F},  // violation
    {0.12818F, 1.0103F, 0.80417F, 0.74659F},  // background
    {0.21328F, 0.85281F, 0.91596F, 0.59274F},  // free
    {2.3572F, 2.0233F, 1.1653F, 0.0F},  // crossed
    {0.089925F, 0.30356F, 0.0F, 0.0F},  // touching
    {0.93592F, 1.9226F, 0.91578F, 0.63399F},  // buried
    {0.0F, 0.38648F, 1.3662F, 0.9363F},  // residual
    {0.0F, 0.0F, 0.28864F, 0.55136F},  // smooth
    {0.0F, 0.0F, 0.0F, 0.0F},  // slope
    {0.997F, 1.5895F, 0.88709F, 0.0F},  // hold
    {0.0F, 0.4371F, 0.0F, 1.0725F},  // consistent
    {0.3535F, 1.085F, 1.1622F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.63361F, 2.825F},  // pixels
    {0.14987F, 0.7516F, 0.0F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }},
  {{  // where neighbours share them
    {0.17127F, 1.0011F, 1.3432F, 0.75771F},  // violation
    {0.54883F, 0.53817F, 1.0914F, 0.0F},  // background
    {0.82599F, 1.2168F, 1.7565F, 1.2361F},  // free
    {0.44804F, 0.88251F, 0.84241F, 0.0F},  // crossed
    {0.0F, 0.0F, 0.0F, 0.0F},  // touching
    {0.99071F, 0.4155F, 0.0F, 0.0F},  // buried
    {0.0F, 0.0F, 0.0F, 0.51305F},  // residual
    {0.0F, 0.0F, 0.0F, 0.0F},  // smooth
    {0.0F, 0.0F, 0.096125F, 1.0203F},  // slope
    {0.0F, 0.0F, 0.97053F, 1.0251F},  // hold
    {0.0F, 0.87706F, 0.70523F, 1.8691F},  // consistent
    {0.35891F, 0.66614F, 0.0F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.0F, 3.0472F},  // pixels
    {0.73199F, 2.3809F, 0.67457F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}}}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
