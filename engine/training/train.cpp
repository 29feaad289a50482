#include "engine/training/train.hpp"

#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/training/model_stages.hpp"

namespace trivet {

float sampling_step(float diameter, float relative_step) {
  return relative_step * std::exp2(std::round(4 * std::log2(diameter)) / 4);
}

Result<TrainedModel> train_model(const Cloud& cloud, const ModelSource& source,
                                 const TrainOptions& options, const TriSpinBasis& basis) {
  engine::ModelInTraining model;
  TRIVET_TRY(engine::survey(cloud, source, options, model));
  engine::find_symmetries(source, model);
  engine::in_parallel([&] { engine::pair_up(source, options, model); },
                      [&] {
                        engine::gather_supports(basis, model);
                        engine::describe(basis, model);
                      });
  if (model.pair_fault) return *model.pair_fault;
  return engine::finish(source, std::move(model));
}

}  // namespace trivet
