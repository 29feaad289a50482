// Written by `trivet calibrate` 0.1.0, from 745 right and 9563 wrong detections in rendered
// scenes; prior share of right ones 0.333. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{{-28.672F, -21.525F}, {{
    {-3.5066F, -2.8347F, -2.1629F, -1.491F, -0.81921F},  // violation
    {-2.9957F, -2.4107F, -1.8257F, -1.2407F, -0.65569F},  // background
    {0.0F, 0.24307F, 0.48614F, 0.72921F, 0.97228F},  // free
    {-2.9957F, -2.4085F, -1.8213F, -1.2341F, -0.64687F},  // crossed
    {-2.9957F, -2.5197F, -2.0436F, -1.5675F, -1.0915F},  // touching
    {-2.9957F, -2.4449F, -1.894F, -1.3432F, -0.79235F},  // buried
    {0.0F, 0.072447F, 0.14489F, 0.21734F, 0.28979F},  // residual
    {-5.2983F, -4.4993F, -3.7003F, -2.9013F, -2.1022F},  // smooth
    {-3.912F, -3.1335F, -2.355F, -1.5765F, -0.79804F},  // slope
    {-8.0794F, -6.6776F, -5.2758F, -3.874F, -2.4722F},  // hold
    {-1.7255F, -1.3027F, -0.88005F, -0.45735F, -0.034647F},  // consistent
    {0.0F, 0.10226F, 0.20453F, 0.30679F, 0.40906F},  // unknown
    {1.1939F, 2.2213F, 3.2486F, 4.276F, 5.3033F},  // pixels
    {-4.1352F, -3.4734F, -2.8116F, -2.1498F, -1.488F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}, {{
  {{  // where errors are independent from pixel to pixel
    {0.80728F, 1.373F, 0.92253F, 1.2884F},  // violation
    {0.048478F, 1.0559F, 1.1568F, 0.77996F},  // background
    {0.16229F, 0.64973F, 0.30053F, 0.76458F},  // free
    {2.4965F, 2.0207F, 1.1301F, 0.0F},  // crossed
    {0.0F, 0.0F, 0.0F, 0.0F},  // touching
    {1.128F, 2.0393F, 0.94656F, 0.0F},  // buried
    {0.0F, 0.62667F, 1.2236F, 0.60738F},  // residual
    {0.0F, 0.0F, 0.39172F, 0.38882F},  // smooth
    {0.0F, 0.0F, 0.083751F, 0.0F},  // slope
    {1.3578F, 1.534F, 1.109F, 0.0F},  // hold
    {0.0F, 0.58535F, 0.0F, 0.80379F},  // consistent
    {0.23593F, 1.03F, 0.71228F, 0.85923F},  // unknown
    {0.0F, 0.0F, 0.0F, 2.7473F},  // pixels
    {0.21316F, 0.89895F, 0.0F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }},
  {{  // where neighbours share them
    {0.9051F, 0.62441F, 1.2093F, 0.91631F},  // violation
    {0.7964F, 1.2113F, 0.74291F, 0.0F},  // background
    {0.67014F, 1.3893F, 1.5804F, 0.0F},  // free
    {0.64333F, 1.3482F, 0.47891F, 0.0F},  // crossed
    {0.31021F, 0.67125F, 0.571F, 0.0F},  // touching
    {1.3357F, 0.0F, 0.0F, 0.0F},  // buried
    {0.0F, 0.0F, 0.0F, 0.0F},  // residual
    {0.0F, 0.18941F, 0.44684F, 0.0F},  // smooth
    {0.0F, 0.0F, 0.5582F, 0.86391F},  // slope
    {0.0F, 0.0F, 0.22928F, 0.51791F},  // hold
    {0.0F, 0.69904F, 0.05033F, 0.73791F},  // consistent
    {1.0711F, 0.0F, 0.0F, 0.0F},  // unknown
    {0.36558F, 2.0331F, 3.2541F, 1.3062F},  // pixels
    {0.0F, 0.76264F, 0.0F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}}}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
