/// The surface of a model as training looks at it.
#pragma once

#include <string>
#include <vector>

#include "engine/train.hpp"
#include "kernels/common/ray_scene.hpp"
#include "storage/cloud.hpp"
#include "storage/model.hpp"
#include "storage/points.hpp"
#include "storage/result.hpp"

namespace trivet::engine {

/// Points spread over a surface, with normals.
struct SpreadPoints {
  Points points;
  Normals normals;
  float spacing = 0;
};

/// What training knows of a surface beyond what the model keeps.
struct ModelSurface {
  SpreadPoints samples;         ///< also those that nothing sees; normals outward
  std::vector<ViewMask> views;  ///< of the samples
  std::vector<double> areas;    ///< running sums over the triangles; none: a cloud
  kernels::RayScene rays;
  float ray_offset = 0;  ///< how far from the surface rays start

  bool has_faces() const noexcept { return !areas.empty(); }
};

/// Fill in what every method needs of a model: surface, samples, views.
/// Errors: bad_data (too few distinct points, no extent), internal.
Result<ModelSurface> survey_model(const Cloud& cloud, const ModelSource& source,
                                  const TrainOptions& options, Model& model, TrainStats& stats);

/// Find the symmetries of a surveyed model that are not declared, and its near ones.
void find_symmetries(const ModelSource& source, Model& model, TrainStats& stats);

/// Points of the outer surface with outward normals, one a voxel and direction: normals of a voxel
/// that differ by more than the angle stay apart. Same bytes for any number of threads.
void sample_evenly(const Model& model, const ModelSurface& surface, float step, float max_angle_rad,
                   Points& points, Normals& normals);

/// What is wrong with a surface that cannot be trained from.
Error bad_surface(const ModelSource& source, const std::string& found);

}  // namespace trivet::engine
