/// Disparity from matching windows of a dot pattern.
#pragma once

#include <cstdint>
#include <span>

namespace trivet::kernels {

/// Values for pixels without a dot of the pattern, and with a dot that the matcher cannot see.
inline constexpr float kNoDot = 0, kHiddenDot = -1;

struct WindowMatching {
  std::uint32_t half_window = 4;  ///< windows are 2 half_window + 1 pixels wide; 1..kMaxHalfWindow
  float taper = 0.1F;  ///< weight loss of a dot at a window's corner, 0..1; above 0 the nearer of
                       ///< two equals wins
  float reach_pixel = 1;          ///< largest difference between dots that agree, > 0
  std::uint32_t fewest_dots = 2;  ///< agreeing dots needed, >= 1
  float least_share = 0;  ///< agreeing share needed of the weight of all dots, seen or not, 0..1
};
inline constexpr std::uint32_t kMaxHalfWindow = 7;

/// Match rows of an image. If all dots of a window agree with their mean, it is the pixel's
/// disparity. Otherwise the dots vote, by their weights, for the disparity of the dot with which
/// most of them agree, and the pixel's disparity is the weighted mean of those in agreement.
///
/// dots         width * height: disparity > 0 [pixel] of the dot at a pixel, kNoDot or kHiddenDot
/// first_row    row of the image that the output starts with
/// disparities  whole rows [pixel]; 0: too few dots agree
/// Of disparities with equal votes, that of the first dot, row by row, wins. Rows are independent:
/// any split into chunks of rows gives the same bits. No allocation.
///
/// At depth discontinuities of less than `reach_pixel` of disparity, the two surfaces blend over a
/// window: recesses fill, edges slant. At more than twice that, the surface with more dots in the
/// window wins. Beside a shadow, which shows no dots, that is the object's surface: it grows there
/// by up to half a window. Source: foreground fattening of all methods that match windows,
/// Scharstein, Szeliski, "A taxonomy and evaluation of dense two-frame stereo correspondence
/// algorithms", IJCV 47, 2002. Windows that need a share of valid dots in agreement: Gschwandtner
/// et al., "BlenSor", ISVC 2011.
void match_windows(std::span<const float> dots, std::uint32_t width, std::uint32_t first_row,
                   const WindowMatching& options, std::span<float> disparities);

}  // namespace trivet::kernels
