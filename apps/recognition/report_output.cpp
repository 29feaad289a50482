#include "apps/recognition/report_output.hpp"

#include "apps/report/recognition_report.hpp"

namespace trivet::apps {

Result<void> ReportOutput::add(const RecognizedScene& scene) {
  scenes_.push_back(scene.input);
  results_.push_back(scene.reported);
  return {};
}

Result<void> ReportOutput::finish() {
  TRIVET_TRY(write_recognition_report(
      folder_, {request_.recognizer, request_.options, scenes_, results_, context_.command},
      context_.console.progress("drawn", context_.stop)));
  context_.console.wrote_report(folder_);
  return {};
}

}  // namespace trivet::apps
