#include "engine/train.hpp"

#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/training/build_pair_table.hpp"
#include "engine/training/describe_model.hpp"
#include "engine/training/encode_features.hpp"
#include "engine/training/survey_model.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"

namespace trivet {
namespace {

using Features = std::array<TriSpinFeatures, kFeatureScales.size()>;

Features describe(const engine::SurveyedModel& model, const TriSpinBasis& basis,
                  StageTimes& times) {
  Features features;
  if (basis.components.size() == 0) return features;
  const StageTimer timer(times, "describe");
  engine::for_each_index(features.size(), [&](std::size_t k) {
    const std::uint32_t above = kFeatureScales[k];
    features[k] = engine::encode_features(
        engine::describe_model(model, {.half_octaves = above, .support = basis.support}), basis,
        engine::resolution_for(model.diameter, above));
  });
  return features;
}

/// Models of one step share the scene's samples, with or without a table.
Result<engine::PairTable> pair_up(const engine::SurveyedModel& model,
                                  const engine::Symmetries& symmetries, const TrainOptions& options,
                                  const ModelSource& source, StageTimes& times) {
  if (options.point_pairs) {
    return engine::build_pair_table(model, symmetries.exact, engine::pair_table_options(options),
                                    source, times);
  }
  engine::PairTable none;
  none.view.quantization.distance_step = sampling_step(model.diameter, options.relative_step);
  return none;
}

Model assemble(const ModelSource& source, engine::SurveyedModel surveyed,
               engine::Symmetries symmetries, engine::PairTable pairs, Features features) {
  Model model;
  model.name = source.name;
  model.source = source.file.filename().string();
  model.diameter = surveyed.diameter;
  model.center = surveyed.center;
  model.symmetry = std::move(symmetries.exact);
  model.near_symmetries = std::move(symmetries.near);
  model.near_axis = symmetries.near_axis;
  model.vertices = std::move(surveyed.vertices);
  model.triangles = std::move(surveyed.triangles);
  model.samples = std::move(surveyed.samples.points);
  model.sample_normals = std::move(surveyed.samples.normals);
  model.sample_views = std::move(surveyed.sample_views);
  model.sample_spacing = surveyed.samples.spacing;
  model.ppf_points = std::move(pairs.points);
  model.ppf_normals = std::move(pairs.normals);
  model.ppf = {pairs.view, std::move(pairs.storage)};
  model.features = std::move(features);
  return model;
}

}  // namespace

float sampling_step(float diameter, float relative_step) {
  return relative_step * std::exp2(std::round(4 * std::log2(diameter)) / 4);
}

Result<TrainedModel> train_model(const Cloud& cloud, const ModelSource& source,
                                 const TrainOptions& options, const TriSpinBasis& basis) {
  TrainStats stats;
  Result<engine::SurveyedModel> surveyed =
      engine::survey_model(cloud, source, options.num_samples, stats.times);
  if (!surveyed) return surveyed.error();
  engine::Symmetries symmetries = engine::find_symmetries(*surveyed, source.symmetry, stats.times);
  Result<engine::PairTable> pairs = engine::PairTable{};
  Features features;
  StageTimes pair_times, feature_times;
  engine::in_parallel([&] { pairs = pair_up(*surveyed, symmetries, options, source, pair_times); },
                      [&] { features = describe(*surveyed, basis, feature_times); });
  if (!pairs) return pairs.error();

  stats.times.add(pair_times);
  stats.times.add(feature_times);
  stats.num_hidden_samples = surveyed->num_hidden();
  stats.num_ppf_points = pairs->points.size();
  stats.num_ppf_entries = pairs->view.entries.size();
  for (const TriSpinFeatures& at_scale : features) stats.num_features += at_scale.size();
  return TrainedModel{assemble(source, std::move(*surveyed), std::move(symmetries),
                               std::move(*pairs), std::move(features)),
                      std::move(stats)};
}

}  // namespace trivet
