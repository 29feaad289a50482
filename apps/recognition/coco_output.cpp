#include "apps/recognition/coco_output.hpp"

#include "apps/results/coco_results.hpp"

namespace trivet::apps {

Result<void> CocoOutput::add(const RecognizedScene& scene) {
  return add_coco_results(request_.scenes, scene.index, request_.recognizer, scene.all, results_);
}

Result<void> CocoOutput::finish() { return write_coco_results(file_, results_); }

}  // namespace trivet::apps
