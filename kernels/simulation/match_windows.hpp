/// Disparity as a matcher finds it that compares windows of a pattern of dots.
#pragma once

#include <cstdint>
#include <span>

namespace trivet::kernels {

/// Pixels without a dot of the pattern, and with one that the matcher cannot see.
inline constexpr float kNoDot = 0, kUnseenDot = -1;

struct WindowMatching {
  std::uint32_t half_window = 4;  ///< windows are 2 half_window + 1 pixels wide; 1..kMaxHalfWindow
  float taper = 0.1F;             ///< what a dot at a window's corner weighs less than one at its
                                  ///< center, 0..1; more than 0 lets the nearer of equals win
  float reach_pixel = 1;          ///< dots agree with what differs from them by no more, > 0
  std::uint32_t fewest_dots = 2;  ///< that agree, >= 1
  float least_share = 0;  ///< of the weight of a window's dots, seen or not, that agree, 0..1
};
inline constexpr std::uint32_t kMaxHalfWindow = 7;

/// Match rows of an image: where all dots of a window agree with their mean, it is the pixel's
/// disparity; else the dots vote for that of the dot which most of them agree with, by their
/// weights, and the pixel's is the weighted mean of those that do.
///
/// dots         width * height: disparity > 0 [pixel] of the dot that a pixel shows, kNoDot or
///              kUnseenDot
/// first_row    row of the image that the output starts with
/// disparities  whole rows [pixel]; 0: too few dots agree
/// Of disparities that equally many vote for, that of the first dot, row by row, wins. Rows are
/// independent: any split into chunks of rows gives the same bits. No allocation.
///
/// Where depth jumps by less than `reach_pixel` of disparity, the two surfaces blend over a window:
/// recesses fill, edges lean. Where it jumps by more than twice that, the surface with more dots in
/// the window wins, and beside a shadow, which shows no dots, the object's does: it grows there by
/// up to half a window. Source: foreground fattening of all methods that match windows, Scharstein,
/// Szeliski, "A taxonomy and evaluation of dense two-frame stereo correspondence algorithms", IJCV
/// 47, 2002. Windows that need a share of valid dots which agree: Gschwandtner et al., "BlenSor",
/// ISVC 2011.
void match_windows(std::span<const float> dots, std::uint32_t width, std::uint32_t first_row,
                   const WindowMatching& options, std::span<float> disparities);

}  // namespace trivet::kernels
