/// The pictures of an evaluation: scenes with their detections, and close-ups of single instances.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/evaluation_report.hpp"
#include "apps/report/pictures.hpp"
#include "engine/pictures/draw_scene.hpp"

namespace trivet::apps {

/// One instance for a close-up: a truth, a detection, or both.
struct Exhibit {
  std::size_t scene = 0;
  std::optional<std::size_t> truth;      ///< index in the scene's truth
  std::optional<std::size_t> detection;  ///< index in the scene's evaluated detections
};

/// The instances for close-ups: missed truths with the nearest detection, wrong detections
/// elsewhere, then correct ones in order of increasing score; each part up to a limit.
struct Gallery {
  std::vector<Exhibit> problems, right;
  std::size_t num_problems = 0, num_right = 0;  ///< without the limit
};
Gallery choose_exhibits(const ReportInput& input);

/// The legend of the outlines.
std::string picture_key();

/// The figure of a scene with its table.
Result<std::string> scene_figure(const ReportInput& input, std::size_t scene, SceneDrawing& drawing,
                                 PictureStore& store);

/// The figure of one instance: the measured scene, truth and detection in outlines, its numbers.
Result<std::string> exhibit_figure(const ReportInput& input, const Exhibit& exhibit,
                                   SceneDrawing& drawing, PictureStore& store,
                                   const std::string& name);

}  // namespace trivet::apps
