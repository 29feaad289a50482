#include "engine/training/model_stages.hpp"

#include <utility>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/training/encode_features.hpp"
#include "engine/training/warn_of_model.hpp"

namespace trivet::engine {

Result<void> survey(const Cloud& cloud, const ModelSource& source, const TrainOptions& options,
                    ModelInTraining& model) {
  TRIVET_TRY_ASSIGN(SurveyedModel surveyed,
                    survey_model(cloud, source, options.num_samples, model.times));
  model.surveyed = std::move(surveyed);
  return {};
}

void find_symmetries(const ModelSource& source, ModelInTraining& model) {
  model.symmetries = find_symmetries(*model.surveyed, source.symmetry, model.times);
}

// Models of one step share the scene's samples, with or without a pair table.
void pair_up(const ModelSource& source, const TrainOptions& options, ModelInTraining& model) {
  if (!options.point_pairs) {
    model.pairs.view.quantization.distance_step =
        sampling_step(model.surveyed->diameter, options.relative_step);
    return;
  }
  Result<PairTable> pairs = build_pair_table(*model.surveyed, model.symmetries.exact,
                                             pair_table_options(options), source, model.pair_times);
  if (pairs) {
    model.pairs = std::move(*pairs);
  } else {
    model.pair_fault = pairs.error();
  }
}

void gather_supports(const TriSpinBasis& basis, ModelInTraining& model) {
  if (basis.components.size() == 0) return;
  const StageTimer timer(model.feature_times, "supports");
  for_each_index(kFeatureScales.size(), [&](std::size_t k) {
    model.describers[k].emplace(*model.surveyed, DescribeOptions{.half_octaves = kFeatureScales[k],
                                                                 .support = basis.support});
  });
}

void describe(const TriSpinBasis& basis, ModelInTraining& model) {
  if (basis.components.size() == 0) return;
  const StageTimer timer(model.feature_times, "describe");
  const kernels::Projector projector(basis.components);
  PerThread<Descriptions> images;
  for (std::size_t k = 0; k < kFeatureScales.size(); ++k) {
    const ModelDescriber& describer = *model.describers[k];
    std::vector<FeatureRows> rows(describer.num_chunks());
    for_each_index(rows.size(), [&](std::size_t c) {
      Descriptions& some = images.local();
      some.clear();
      describer.describe(c, some);
      rows[c] = encode_features(some, projector, basis.code_step);
    });
    model.features[k] =
        join_features(rows, basis, resolution_for(model.surveyed->diameter, kFeatureScales[k]));
    model.describers[k].reset();
  }
}

TrainedModel finish(const ModelSource& source, ModelInTraining&& made) {
  TrainedModel out;
  TrainStats& stats = out.stats;
  stats.times = std::move(made.times);
  stats.times.add(made.pair_times);
  stats.times.add(made.feature_times);
  stats.num_hidden_samples = made.surveyed->num_hidden();
  stats.num_ppf_points = made.pairs.points.size();
  stats.num_ppf_entries = made.pairs.view.entries.size();
  for (const TriSpinFeatures& at_scale : made.features) stats.num_features += at_scale.size();
  stats.warnings = warn_of_model(*made.surveyed);

  Model& model = out.model;
  SurveyedModel& surveyed = *made.surveyed;
  model.name = source.name;
  model.source = source.file.filename().string();
  model.diameter = surveyed.diameter;
  model.center = surveyed.center;
  model.symmetry = std::move(made.symmetries.exact);
  model.near_symmetries = std::move(made.symmetries.near);
  model.near_axis = made.symmetries.near_axis;
  model.vertices = std::move(surveyed.vertices);
  model.triangles = std::move(surveyed.triangles);
  model.samples = std::move(surveyed.samples.points);
  model.sample_normals = std::move(surveyed.samples.normals);
  model.sample_views = std::move(surveyed.sample_views);
  model.sample_spacing = surveyed.samples.spacing;
  model.ppf_points = std::move(made.pairs.points);
  model.ppf_normals = std::move(made.pairs.normals);
  model.ppf = {made.pairs.view, std::move(made.pairs.storage)};
  model.features = std::move(made.features);
  return out;
}

}  // namespace trivet::engine
