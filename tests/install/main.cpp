#include <cstdio>

#include "engine/recognition/recognize.hpp"
#include "engine/training/train.hpp"

int main() {
  trivet::TrainOptions options;
  const float step = trivet::sampling_step(0.2F, options.relative_step);
  const bool good = trivet::validate(options).has_value();
  options.relative_step = -1;
  const trivet::Result<void> bad = trivet::validate(options);
  // Calls functions of every layer, so that all the libraries below are linked.
  const auto untrained = trivet::train_model({}, {"empty", "empty.ply", 1, {}}, {});
  const auto missing = trivet::open_library("missing.h5");
  if (!(step > 0) || !good || bad || untrained || missing) return 1;
  std::printf("step %g\n%s\n%s\n%s\n", static_cast<double>(step), bad.error().message.c_str(),
              untrained.error().message.c_str(), missing.error().message.c_str());
}
