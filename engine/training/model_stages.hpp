/// A model on its way through training, and the stages that it takes.
#pragma once

#include <array>
#include <optional>

#include "engine/training/build_pair_table.hpp"
#include "engine/training/describe_model.hpp"
#include "engine/training/survey_model.hpp"
#include "engine/training/train.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// Each stage fills what stands below its name, from what stands above. Pairs and features do not
/// need one another and may be made at once.
struct ModelInTraining {
  // survey
  std::optional<SurveyedModel> surveyed;
  StageTimes times;
  // find_symmetries
  Symmetries symmetries;
  // pair_up
  PairTable pairs;
  std::optional<Error> pair_fault;  ///< why there are none
  StageTimes pair_times;
  // gather_supports, by scale
  std::array<std::optional<ModelDescriber>, kFeatureScales.size()> describers;
  StageTimes feature_times;
  // describe
  std::array<TriSpinFeatures, kFeatureScales.size()> features;
};

/// Surface, normals and visibility. Errors: as of train_model.
Result<void> survey(const Cloud& cloud, const ModelSource& source, const TrainOptions& options,
                    ModelInTraining& model);
void find_symmetries(const ModelSource& source, ModelInTraining& model);
/// The pair table, where it is trained for.
void pair_up(const ModelSource& source, const TrainOptions& options, ModelInTraining& model);
/// What Tri-Spin-Images of all scales are made from, and their codes; none without a basis. An image is
/// 45 times as large as its code and never leaves the processor's caches.
void gather_supports(const TriSpinBasis& basis, ModelInTraining& model);
void describe(const TriSpinBasis& basis, ModelInTraining& model);
/// What came of it all.
TrainedModel finish(const ModelSource& source, ModelInTraining&& model);

}  // namespace trivet::engine
