#include <Eigen/Core>

#include "c/handles.hpp"
#include "storage/data/file_pose.hpp"

namespace {

/// Null if the result is null or the index is too large.
const trivet::Detection* find_detection(const trivet_result* result, std::size_t index) {
  if (!result || index >= result->scene.detections.size()) return nullptr;
  return &result->scene.detections[index];
}

void copy_pose(const trivet::Pose& pose, const trivet_result& result, double* rows) {
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(rows);
  matrix = trivet::in_file_frame(pose, result.scene.offset).matrix();
}

}  // namespace

size_t trivet_num_detections(const trivet_result* result) {
  return result ? result->scene.detections.size() : 0;
}

trivet_status trivet_get_detection(const trivet_result* result, size_t index,
                                   trivet_detection* detection) {
  const trivet::Detection* const found = find_detection(result, index);
  if (!found || !detection) return TRIVET_USAGE;
  copy_pose(found->T_scene_model, *result, detection->pose);
  detection->model = result->models[index];
  detection->num_alternatives = static_cast<std::uint32_t>(found->alternatives.size());
  detection->score = found->score;
  detection->pose_share = found->pose_share;
  detection->visible_fraction = found->visible_fraction;
  detection->hidden_fraction = found->hidden_fraction;
  detection->outside_fraction = found->outside_fraction;
  detection->violation = found->violation;
  detection->contour = found->contour;
  detection->rmse = found->rmse;
  return TRIVET_OK;
}

trivet_status trivet_get_alternative(const trivet_result* result, size_t index, size_t alternative,
                                     double* pose) {
  const trivet::Detection* const found = find_detection(result, index);
  if (!found || alternative >= found->alternatives.size() || !pose) return TRIVET_USAGE;
  copy_pose(found->alternatives[alternative], *result, pose);
  return TRIVET_OK;
}

trivet_status trivet_get_scene(const trivet_result* result, trivet_scene* scene) {
  if (!result || !scene) return TRIVET_USAGE;
  const trivet::SceneStats& stats = result->scene.stats;
  *scene = {stats.num_points, stats.num_invalid, static_cast<double>(stats.noise),
            stats.total_seconds};
  return TRIVET_OK;
}

void trivet_free_result(trivet_result* result) { delete result; }
