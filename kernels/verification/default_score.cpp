// Written by `trivet fit-score` 0.1.0, from 1211 right and 18428 wrong detections in rendered
// scenes; the odds of right ones times 3.5. scripts/calibrate scans the scenes.
#include "kernels/verification/pose_score.hpp"

namespace trivet::kernels {

// clang-format off
const ScoreModel& default_score() noexcept {
  static constexpr ScoreModel model{{-26.521F, -20.984F}, {{
    {-3.5066F, -2.8554F, -2.2043F, -1.5531F, -0.902F},  // violation
    {-2.9957F, -2.3946F, -1.7935F, -1.1924F, -0.59128F},  // background
    {0.0F, 0.24011F, 0.48022F, 0.72032F, 0.96043F},  // free
    {-2.9957F, -2.4073F, -1.8189F, -1.2305F, -0.64209F},  // crossed
    {-2.9957F, -2.5197F, -2.0436F, -1.5675F, -1.0915F},  // touching
    {-2.9957F, -2.4791F, -1.9625F, -1.4459F, -0.92931F},  // buried
    {0.0F, 0.069275F, 0.13855F, 0.20782F, 0.2771F},  // residual
    {-5.2983F, -4.521F, -3.7437F, -2.9664F, -2.1891F},  // smooth
    {-3.912F, -3.148F, -2.3841F, -1.6201F, -0.85609F},  // slope
    {-8.1117F, -6.7012F, -5.2907F, -3.8802F, -2.4696F},  // hold
    {-1.7923F, -1.355F, -0.91776F, -0.4805F, -0.043236F},  // consistent
    {0.0F, 0.10125F, 0.20249F, 0.30374F, 0.40498F},  // unknown
    {3.6376F, 4.054F, 4.4704F, 4.8869F, 5.3033F},  // pixels
    {-3.5066F, -2.8091F, -2.1116F, -1.414F, -0.71654F},  // sunk
    {-1.0334F, -0.40642F, 0.22054F, 0.84749F, 1.4744F},  // relief
    {-4.1352F, -3.464F, -2.7927F, -2.1215F, -1.4503F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}, {{
  {{  // where errors are independent from pixel to pixel
    {0.4628F, 1.0231F, 1.0991F, 1.1869F},  // violation
    {0.23077F, 0.72988F, 0.74962F, 0.36085F},  // background
    {0.37063F, 1.1482F, 0.80311F, 1.0847F},  // free
    {1.9184F, 2.1177F, 1.0475F, 0.0F},  // crossed
    {0.0F, 0.0F, 0.0F, 0.0F},  // touching
    {0.8297F, 1.3423F, 1.034F, 0.60233F},  // buried
    {0.0F, 0.038051F, 1.1637F, 0.0F},  // residual
    {0.0F, 0.0F, 0.47513F, 0.68567F},  // smooth
    {0.0F, 0.0F, 0.0F, 0.0F},  // slope
    {0.88239F, 1.2151F, 0.36119F, 0.0F},  // hold
    {0.44572F, 0.19347F, 0.0F, 0.0F},  // consistent
    {0.53553F, 1.4825F, 0.0F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.0F, 2.2228F},  // pixels
    {0.73201F, 1.0572F, 0.39956F, 0.0F},  // sunk
    {0.0F, 0.99516F, 1.1994F, 0.89844F},  // relief
    {0.0F, 0.0F, 0.0F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }},
  {{  // where neighbors share them
    {0.57405F, 0.65616F, 1.7131F, 0.82098F},  // violation
    {0.77414F, 0.17411F, 0.60663F, 0.0F},  // background
    {0.0F, 1.424F, 1.7217F, 0.58068F},  // free
    {0.1129F, 0.59974F, 0.55157F, 0.0F},  // crossed
    {0.0F, 0.25748F, 0.0F, 0.0F},  // touching
    {0.8452F, 0.0F, 0.0F, 0.0F},  // buried
    {0.0F, 0.0F, 0.25075F, 0.66824F},  // residual
    {0.0F, 0.0F, 0.0F, 0.0F},  // smooth
    {0.0F, 0.0F, 0.47944F, 0.0F},  // slope
    {0.0F, 0.0F, 0.8447F, 0.0F},  // hold
    {0.0F, 0.83086F, 0.30206F, 0.98665F},  // consistent
    {0.32215F, 0.5956F, 0.0F, 0.0F},  // unknown
    {0.0F, 0.0F, 0.0F, 1.0896F},  // pixels
    {0.19422F, 0.15607F, 1.2931F, 0.0F},  // sunk
    {0.0F, 2.1847F, 1.9249F, 0.69366F},  // relief
    {0.53221F, 1.4202F, 0.0F, 0.0F},  // coarseness
    {0.0F, 0.0F, 0.0F, 0.0F},  // correlation
  }}}}};
  return model;
}
// clang-format on

}  // namespace trivet::kernels
