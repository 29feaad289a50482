// Written by `trivet calibrate` 0.1.0, from 126 rendered scenes with 345 right and
// 4912 wrong detections; prior share of right ones 0.333. scripts/calibrate scans the scenes.
#include "kernels/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{{-17.789F, -22.366F}, {{
    {-3.5066F, -2.9339F, -2.3612F, -1.7885F, -1.2159F},  // violation
    {-2.9957F, -2.4315F, -1.8672F, -1.3029F, -0.73868F},  // background
    {0.0F, 0.2392F, 0.47841F, 0.71761F, 0.95681F},  // free
    {-2.9957F, -2.3963F, -1.7968F, -1.1973F, -0.59784F},  // crossed
    {-2.9957F, -2.5421F, -2.0885F, -1.6349F, -1.1813F},  // touching
    {-2.9957F, -2.5838F, -2.1718F, -1.7598F, -1.3479F},  // buried
    {0.0F, 0.064597F, 0.12919F, 0.19379F, 0.25839F},  // residual
    {-5.2983F, -4.5645F, -3.8306F, -3.0967F, -2.3629F},  // smooth
    {-3.912F, -3.1328F, -2.3536F, -1.5744F, -0.79525F},  // slope
    {-8.1117F, -6.6872F, -5.2627F, -3.8382F, -2.4137F},  // hold
    {-1.6036F, -1.2096F, -0.81569F, -0.42175F, -0.027814F},  // consistent
    {0.0F, 0.11765F, 0.23529F, 0.35294F, 0.47059F},  // unknown
    {3.5553F, 3.9923F, 4.4293F, 4.8663F, 5.3033F},  // pixels
    {-4.1352F, -3.429F, -2.7228F, -2.0166F, -1.3104F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}, {{
  {{  // where errors are independent from pixel to pixel
    {0.0F, 0.70969F, 0.67595F, 0.65589F},  // violation
    {0.21522F, 0.033597F, 0.0F, 0.0F},  // background
    {0.45316F, 0.69305F, 0.98705F, 0.93646F},  // free
    {1.1241F, 0.71372F, 0.24117F, 0.0075969F},  // crossed
    {0.021938F, 0.20716F, 0.19171F, 0.04107F},  // touching
    {0.99246F, 0.40556F, 0.42966F, 0.51174F},  // buried
    {0.50796F, 0.48107F, 0.42195F, 0.58592F},  // residual
    {0.0F, 0.0F, 0.0F, 0.0F},  // smooth
    {0.080276F, 0.0F, 0.3946F, 0.30437F},  // slope
    {0.52188F, 0.64369F, 0.46121F, 0.48745F},  // hold
    {0.12898F, 0.13379F, 0.58759F, 0.96295F},  // consistent
    {0.28741F, 0.96834F, 0.83892F, 0.65699F},  // unknown
    {0.049095F, 0.12947F, 0.6441F, 1.1336F},  // pixels
    {0.48076F, 0.95127F, 0.26438F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }},
  {{  // where neighbours share them
    {0.13352F, 1.797F, 0.32863F, 0.0F},  // violation
    {0.42409F, 0.58609F, 0.0F, 0.0F},  // background
    {0.91974F, 1.6376F, 1.1828F, 2.1683F},  // free
    {0.92056F, 1.121F, 1.4557F, 0.0F},  // crossed
    {0.0F, 0.0F, 0.0F, 0.0F},  // touching
    {0.74356F, 0.67544F, 0.0F, 0.0F},  // buried
    {0.0F, 0.0F, 0.060836F, 0.82161F},  // residual
    {0.0F, 0.0F, 0.0F, 0.47665F},  // smooth
    {0.0F, 0.0F, 0.34798F, 0.0F},  // slope
    {0.0F, 0.44489F, 0.76452F, 0.33068F},  // hold
    {0.52773F, 0.73763F, 1.0572F, 1.3403F},  // consistent
    {0.79488F, 0.6637F, 0.4781F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.52344F, 2.2989F},  // pixels
    {0.85939F, 1.3832F, 0.72247F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}}}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
