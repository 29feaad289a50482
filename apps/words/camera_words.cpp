#include "apps/words/camera_words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace trivet::apps {
namespace {

/// The deviation of a given value from the correct one, in words; `scale` corrects the value.
std::string how_far(double scale) {
  const double off = 1 / scale - 1;
  return fmt::format("{:.1f} % too {}", 100 * std::abs(off), off > 0 ? "large" : "small");
}

}  // namespace

std::optional<std::string> camera_finding(const CameraCheck& check) {
  std::string words;
  if (check.focal_is_off()) words = "the focal length looks " + how_far(check.scale->focal.value);
  if (check.depth_is_off()) {
    words += words.empty() ? "" : "; ";
    words += "depths look " + how_far(check.scale->depth->value);
  }
  if (check.depth_kind_is_off()) {
    words += words.empty() ? "" : "; ";
    words += check.camera.depth == DepthKind::z
                 ? "depths look like distances along the ray of each pixel, as a large surface is "
                   "flat by them and curved as z: say \"depth\": \"ray\" in the camera"
                 : "depths look as if they were along z, as a large surface is flat by them and "
                   "curved along the rays: leave out \"depth\": \"ray\" in the camera";
    words += fmt::format(" (it is {:.3g} from a plane, and would be {:.3g})", check.depth.curved,
                         check.depth.flat);
  }
  if (words.empty()) return std::nullopt;
  return words;
}

}  // namespace trivet::apps
