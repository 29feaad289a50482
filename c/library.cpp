#include <utility>

#include "c/handles.hpp"
#include "engine/loaded_library/score_calibration.hpp"

using trivet::Error;
using trivet::ErrorCode;
using trivet::Library;
using trivet::Result;

namespace {

Result<std::unique_ptr<trivet_library>> open_recognizer(const char* file, const char* calibration) {
  if (!file) return Error{ErrorCode::usage, "expected the path of a library, found null"};
  trivet::kernels::ScoreModel score = trivet::default_score();
  if (calibration) {
    TRIVET_TRY_ASSIGN(const trivet::ScoreCalibration read, trivet::read_calibration(calibration));
    score = trivet::calibrated_score(read);
  }
  TRIVET_TRY_ASSIGN(Library library, trivet::open_library(file));
  return std::make_unique<trivet_library>(
      trivet_library{trivet::Recognizer(std::move(library), score)});
}

/// Null if the library is null or the index is too large.
const trivet::ModelInfo* find_model(const trivet_library* library, std::size_t model) {
  if (!library) return nullptr;
  const std::span<const trivet::ModelInfo> models = library->recognizer.library().models;
  return model < models.size() ? &models[model] : nullptr;
}

}  // namespace

const char* trivet_version(void) { return TRIVET_VERSION; }

trivet_status trivet_open(const char* file, const char* calibration, trivet_library** library,
                          trivet_error* error) {
  return trivet::c::hand_out(library, error, [&] { return open_recognizer(file, calibration); });
}

void trivet_close(trivet_library* library) { delete library; }

size_t trivet_num_models(const trivet_library* library) {
  return library ? library->recognizer.library().models.size() : 0;
}

const char* trivet_model_name(const trivet_library* library, size_t model) {
  const trivet::ModelInfo* const found = find_model(library, model);
  return found ? found->name.c_str() : nullptr;
}

double trivet_model_diameter(const trivet_library* library, size_t model) {
  const trivet::ModelInfo* const found = find_model(library, model);
  return found ? static_cast<double>(found->diameter) : 0;
}

trivet_unit trivet_library_unit(const trivet_library* library) {
  if (!library) return TRIVET_UNIT_OF_LIBRARY;
  const bool meter = library->recognizer.library().header.unit == trivet::LengthUnit::meter;
  return meter ? TRIVET_METER : TRIVET_MILLIMETER;
}
