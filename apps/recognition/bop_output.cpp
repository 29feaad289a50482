#include "apps/recognition/bop_output.hpp"

#include "apps/results/bop_csv.hpp"

namespace trivet::apps {

Result<void> BopOutput::add(const RecognizedScene& scene) {
  add_bop_results(request_.scenes, scene.index, scene.all, results_);
  return {};
}

Result<void> BopOutput::finish() { return write_bop_results(file_, results_); }

}  // namespace trivet::apps
