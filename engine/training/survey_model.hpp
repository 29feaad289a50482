/// The surface of a model as training looks at it.
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

/// Points spread over a surface, with normals.
struct SpreadPoints {
  Points points;
  Normals normals;
  float spacing = 0;
};

/// What every method needs of a model. Lengths are in the library's unit.
struct SurveyedModel {
  Points vertices;
  Triangles triangles;  ///< none: a cloud without a surface
  float diameter = 0;
  Eigen::Vector3f center{0, 0, 0};
  SpreadPoints samples;  ///< those that some view sees, shuffled; normals outward
  Column<ViewMask> sample_views;

  // What only training needs.
  SpreadPoints all_samples;         ///< also those that nothing sees
  std::vector<ViewMask> all_views;  ///< of all samples
  std::vector<double> areas;        ///< running sums over the triangles; none without a surface
  kernels::RayScene rays;
  float ray_offset = 0;                              ///< how far from the surface rays start
  std::size_t num_turned = 0;                        ///< of all samples: whose faces look inwards
  std::size_t num_unused = 0, num_without_area = 0;  ///< of the cloud, dropped when it was read

  bool has_faces() const noexcept { return !areas.empty(); }
  bool faces_look_outward() const noexcept { return has_faces() && num_turned == 0; }
  std::size_t num_hidden() const noexcept { return all_views.size() - sample_views.size(); }
};

/// num_samples  of a surface with faces
/// Errors: bad_data (too few distinct points, no extent), internal.
Result<SurveyedModel> survey_model(const Cloud& cloud, const ModelSource& source,
                                   std::size_t num_samples, StageTimes& times);

/// Motions that map a model onto itself, and those that nearly do.
struct Symmetries {
  Symmetry exact;
  std::vector<Pose> near;
  std::optional<Symmetry::Axis> near_axis;
};

/// Find the symmetries of a model, unless they are declared, and its near ones.
Symmetries find_symmetries(const SurveyedModel& model, const std::optional<Symmetry>& declared,
                           StageTimes& times);

/// Points of the surface with outward normals, one a voxel and direction: normals of a voxel that
/// differ by more than the angle stay apart. Some may be inside, where nothing sees them. Same bytes for
/// any number of threads.
SpreadPoints sample_evenly(const SurveyedModel& model, float step, float max_angle_rad);

/// Leave out the points that nothing sees, as the samples know them.
void drop_hidden(const SurveyedModel& model, SpreadPoints& surface);

/// What is wrong with a surface that cannot be trained from.
Error bad_surface(const ModelSource& source, const std::string& found);

}  // namespace trivet::engine
