#include "apps/words/view_words.hpp"

#include <fmt/format.h>

namespace trivet::apps {

std::optional<std::string> view_words(const SceneView& view) {
  const auto place = [&] {
    const Eigen::Vector3d& v = *view.viewpoint;
    return v.isZero(0) ? std::string("the origin")
                       : fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x(), v.y(), v.z());
  };
  switch (view.source) {
    case ViewSource::given:
    case ViewSource::file:
      break;
    case ViewSource::grid:
      return fmt::format(
          "treated as seen from {}, where its rows and columns meet to {:.2g} pixels; if the "
          "sensor "
          "stood elsewhere, give its viewpoint",
          place(), *view.residual);
    case ViewSource::faces:
      if (!view.viewpoint)
        return "treated as a complete surface, as no one place sees all its faces; if it is a "
               "scan, give its viewpoint";
      return fmt::format(
          "treated as seen from {}, where its faces turn to; if the sensor stood "
          "elsewhere, give its viewpoint",
          place());
    case ViewSource::assumed:
      return fmt::format(
          "treated as seen from {}; if the sensor stood elsewhere, give its viewpoint", place());
  }
  return std::nullopt;
}

}  // namespace trivet::apps
