/// What a detection is measured on: the surfaces that a manifest names, as they stand there.
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
  Shared<PointsView> vertices;      ///< all of the file's, at least two of them apart
  Shared<TrianglesView> triangles;  ///< empty for a cloud
  double diameter = 0;  ///< of the data set (BOP), else between the farthest vertices; > 0
  Symmetry symmetry;    ///< what the manifest declares; else none
};

/// Read the models of a manifest, in its order: for each the file that errors are measured on
/// (BOP: models_eval), else the one that it is trained from. Errors: those of read_cloud; bad_data
/// (a model without extent).
Result<std::vector<EvaluationMesh>> read_evaluation_meshes(const Manifest& manifest);

/// The surfaces of a library's models as they are stored, in its order and unit. Errors: bad_data
/// (damaged).
Result<std::vector<EvaluationMesh>> meshes_of(const Library& library);

/// The mesh of that name; none if there is none.
const EvaluationMesh* find_mesh(std::span<const EvaluationMesh> meshes, std::string_view name);

}  // namespace trivet
