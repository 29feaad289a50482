/// The table of a model's point pair features, and their points.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/results/stage_times.hpp"
#include "engine/training/survey_model.hpp"
#include "engine/training/train.hpp"
#include "storage/common/result.hpp"
#include "storage/data/points.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::engine {

struct PairTableOptions {
  float relative_step = 0.04F;        ///< sampling step / diameter
  float reference_spacing = 1.2F;     ///< spacing of the reference points [steps]
  std::uint32_t num_angle_bins = 15;  ///< over 180 degrees
  float normal_cluster_angle_deg = kNormalClusterDeg;
  bool operator==(const PairTableOptions&) const = default;
};

PairTableOptions pair_table_options(const TrainOptions& options);

struct PairTable {
  Points points;  ///< reference points first
  Normals normals;
  PpfTableView view;  ///< refers to the storage
  std::shared_ptr<const void> storage;
};

/// Sample a model evenly, and store the point pair features in a table. Same bytes for any number
/// of threads.
///
/// source  source named in errors: bad_data (too few or too many points, no pairs)
Result<PairTable> build_pair_table(const SurveyedModel& model, const Symmetry& symmetry,
                                   const PairTableOptions& options, const ModelSource& source,
                                   StageTimes& times);

}  // namespace trivet::engine
