/// Surfaces for measuring the errors of detections, in the manifest's coordinates.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/model.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// One model of a manifest. Lengths are in the manifest's unit.
struct EvaluationMesh {
  std::string name;
  Shared<PointsView> vertices;      ///< all vertices of the file, at least two of them distinct
  Shared<TrianglesView> triangles;  ///< empty for a cloud
  double diameter = 0;  ///< from the data set (BOP), or else between the farthest vertices; > 0
  Symmetry symmetry;    ///< symmetry declared by the manifest, or else none
};

/// Read the models of a manifest, in its order. The file of each is the one for measuring errors
/// (BOP: models_eval), or else the training file. Errors: those of read_cloud; bad_data (a model
/// without extent).
Result<std::vector<EvaluationMesh>> read_evaluation_meshes(const Manifest& manifest);

/// The surfaces of a library's models as they are stored, in its order and unit. Errors:
/// damaged.
Result<std::vector<EvaluationMesh>> meshes_of(const Library& library);

/// The mesh with this name; null if there is none.
const EvaluationMesh* find_mesh(std::span<const EvaluationMesh> meshes, std::string_view name);

}  // namespace trivet
