/// State of a model during training, and the stages of training.
#pragma once

#include <array>
#include <optional>

#include "engine/training/build_pair_table.hpp"
#include "engine/training/describe_model.hpp"
#include "engine/training/survey_model.hpp"
#include "engine/training/train.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// Model in training. Each stage sets the members below its name from the members above. Pairs and
/// features are independent and may be computed in parallel.
struct ModelInTraining {
  // survey
  std::optional<SurveyedModel> surveyed;
  StageTimes times;
  // find_symmetries
  Symmetries symmetries;
  // pair_up
  PairTable pairs;
  std::optional<Error> pair_fault;  ///< reason for missing pairs
  StageTimes pair_times;
  // gather_supports, by scale
  std::array<std::optional<ModelDescriber>, kFeatureScales.size()> describers;
  StageTimes feature_times;
  // describe
  std::array<TriSpinFeatures, kFeatureScales.size()> features;
};

/// Determine surface, normals and visibility. Errors: as for train_model.
Result<void> survey(const Cloud& cloud, const ModelSource& source, const TrainOptions& options,
                    ModelInTraining& model);
void find_symmetries(const ModelSource& source, ModelInTraining& model);
/// Build the pair table, if it is trained for.
void pair_up(const ModelSource& source, const TrainOptions& options, ModelInTraining& model);
/// Prepare the Tri-Spin-Images of all scales for encoding; nothing without a basis. An image is 45
/// times as large as its code and never leaves the processor's caches.
void gather_supports(const TriSpinBasis& basis, ModelInTraining& model);
void describe(const TriSpinBasis& basis, ModelInTraining& model);
/// The result of all stages.
TrainedModel finish(const ModelSource& source, ModelInTraining&& model);

}  // namespace trivet::engine
