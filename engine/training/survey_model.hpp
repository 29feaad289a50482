/// Surface of a model for training.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/results/stage_times.hpp"
#include "engine/training/train.hpp"
#include "kernels/common/ray_scene.hpp"
#include "storage/common/columns.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Points distributed over a surface, with normals.
struct SpreadPoints {
  Points points;
  Normals normals;
  float spacing = 0;
};

/// Data of a model for every method. Lengths are in the library's unit.
struct SurveyedModel {
  Points vertices;
  Triangles triangles;  ///< empty: a cloud without a surface
  float diameter = 0;
  Eigen::Vector3f center{0, 0, 0};
  SpreadPoints samples;  ///< samples visible in some view, shuffled; normals outward
  Column<ViewMask> sample_views;

  // Members for training only.
  SpreadPoints all_samples;         ///< includes samples visible in no view
  std::vector<ViewMask> all_views;  ///< views of all samples
  std::vector<double> areas;        ///< cumulative areas of the triangles; empty without a surface
  kernels::RayScene rays;
  float ray_offset = 0;        ///< distance from the surface at which rays start
  std::size_t num_turned = 0;  ///< number of all samples whose faces point inward
  /// Numbers of the cloud's points and triangles dropped when reading.
  std::size_t num_unused = 0, num_without_area = 0;

  bool has_faces() const noexcept { return !areas.empty(); }
  bool faces_point_outward() const noexcept { return has_faces() && num_turned == 0; }
  std::size_t num_hidden() const noexcept { return all_views.size() - sample_views.size(); }
};

/// num_samples  number of samples for a surface with faces
/// Errors: bad_data (too few distinct points, no extent), internal.
Result<SurveyedModel> survey_model(const Cloud& cloud, const ModelSource& source,
                                   std::size_t num_samples, StageTimes& times);

/// Exact and near symmetries of a model.
struct Symmetries {
  Symmetry exact;
  std::vector<Pose> near;
  std::optional<Symmetry::Axis> near_axis;
};

/// Find the symmetries of a model, unless they are declared, and its near symmetries.
Symmetries find_symmetries(const SurveyedModel& model, const std::optional<Symmetry>& declared,
                           StageTimes& times);

/// Sample points of the surface with outward normals, one per voxel and direction: normals of a
/// voxel that differ by more than the angle are kept apart. Some points may be inside, where they
/// are not visible. Same bytes for any number of threads.
SpreadPoints sample_evenly(const SurveyedModel& model, float step, float max_angle_rad);

/// Remove points that are visible in no view, according to the samples.
void drop_hidden(const SurveyedModel& model, SpreadPoints& surface);

/// The error for a surface that is unsuitable for training.
Error bad_surface(const ModelSource& source, const std::string& found);

}  // namespace trivet::engine
