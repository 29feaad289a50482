#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "c/handles.hpp"
#include "engine/options/presets.hpp"
#include "storage/formats/memory_cloud.hpp"

using trivet::ArrayView;
using trivet::Camera;
using trivet::Cloud;
using trivet::DepthKind;
using trivet::Error;
using trivet::ErrorCode;
using trivet::RecognizeOptions;
using trivet::Result;
using trivet::SceneInput;

namespace {

using FoundInScene = Result<std::unique_ptr<trivet_result>>;

Error usage(std::string message) { return {ErrorCode::usage, std::move(message)}; }

/// texts   "name=value", terminated by a null pointer; or null
Result<RecognizeOptions> parse_options(const char* const* texts) {
  std::vector<std::pair<std::string_view, std::string_view>> pairs;
  for (; texts && *texts; ++texts) {
    const std::string_view text(*texts);
    const std::size_t end = std::min(text.find('='), text.size());
    pairs.emplace_back(text.substr(0, end), text.substr(std::min(end + 1, text.size())));
  }
  return trivet::parse_recognize_options(pairs, "`trivet recognize --help`");
}

/// Factor from the scene's unit to the library's.
Result<double> scale_of(trivet_unit unit, trivet::LengthUnit library_unit) {
  switch (unit) {
    case TRIVET_UNIT_OF_LIBRARY:
      return 1.0;
    case TRIVET_METER:
      return trivet::unit_scale(trivet::LengthUnit::meter, library_unit);
    case TRIVET_MILLIMETER:
      return trivet::unit_scale(trivet::LengthUnit::millimeter, library_unit);
  }
  return usage(fmt::format("unit: expected 0, 1 or 2, found {}", static_cast<int>(unit)));
}

/// The array at `data` with the element type that `number` specifies.
Result<ArrayView> typed_array(const void* data, trivet_number number) {
  ArrayView array;
  switch (number) {
    case TRIVET_FLOAT32:
      array.data = static_cast<const float*>(data);
      return array;
    case TRIVET_FLOAT64:
      array.data = static_cast<const double*>(data);
      return array;
    case TRIVET_UINT16:
      array.data = static_cast<const std::uint16_t*>(data);
      return array;
  }
  return usage(
      fmt::format("type of numbers: expected 0, 1 or 2, found {}", static_cast<int>(number)));
}

/// Check a stride. Errors: usage (below `least`, or too large for an array in memory).
Result<std::ptrdiff_t> check_stride(std::size_t stride, std::size_t least) {
  if (stride >= least && stride <= std::size_t{std::numeric_limits<std::ptrdiff_t>::max()})
    return static_cast<std::ptrdiff_t>(stride);
  return usage(fmt::format("stride: expected at least {}, found {}", least, stride));
}

Result<ArrayView> points_array(const void* xyz, trivet_number number, std::size_t width,
                               std::size_t height, std::size_t stride) {
  if (number == TRIVET_UINT16)
    return usage("points: expected floats or doubles, found integers of 16 bits");
  Result<ArrayView> array = typed_array(xyz, number);
  if (!array) return array.error();
  TRIVET_TRY_ASSIGN(const std::ptrdiff_t step, check_stride(stride, 3));
  if (width > 0 && std::size_t{std::numeric_limits<std::ptrdiff_t>::max()} / width < stride)
    return usage(
        fmt::format("points: expected an array that fits into memory, found rows of {} "
                    "points {} numbers apart",
                    width, stride));
  array->num_dimensions = 3;
  array->shape = {height, width, 3};
  array->strides = {step * static_cast<std::ptrdiff_t>(width), step, 1};
  return array;
}

Result<ArrayView> depths_array(const void* depths, trivet_number number, std::size_t width,
                               std::size_t height, std::size_t stride) {
  Result<ArrayView> array = typed_array(depths, number);
  if (!array) return array.error();
  TRIVET_TRY_ASSIGN(const std::ptrdiff_t step, check_stride(stride, width));
  array->shape = {height, width, 1};
  array->strides = {step, 1, 1};
  return array;
}

/// Common arguments of all scenes.
struct Call {
  const trivet_library* library;
  trivet_unit unit;
  const char* const* options;
  const trivet_stopper* stopper;
};

/// make_cloud  () -> Result<Cloud>; called after the other arguments are checked
template <class MakeCloud>
FoundInScene recognize_scene(const Call& call, SceneInput input, MakeCloud&& make_cloud) {
  if (!call.library) return usage("expected a library, found null");
  const trivet::Recognizer& recognizer = call.library->recognizer;
  const trivet::Library& library = recognizer.library();
  TRIVET_TRY_ASSIGN(const double scale, scale_of(call.unit, library.header.unit));
  input.scale = scale;
  TRIVET_TRY_ASSIGN(const RecognizeOptions options, parse_options(call.options));
  TRIVET_TRY_ASSIGN(const Cloud cloud, make_cloud());

  const std::stop_token stop = call.stopper ? call.stopper->source.get_token() : std::stop_token();
  TRIVET_TRY_ASSIGN(trivet::SceneResult found,
                    trivet::recognize(recognizer, cloud, input, options, stop));
  auto result = std::make_unique<trivet_result>(trivet_result{std::move(found), {}});
  for (const trivet::Detection& detection : result->scene.detections) {
    const auto model =
        std::ranges::lower_bound(library.models, detection.model, {}, &trivet::Model::name);
    result->models.push_back(static_cast<std::uint32_t>(model - library.models.begin()));
  }
  return result;
}

Camera camera_of(const trivet_camera& c) {
  const auto& d = c.distortion;
  return {.fx = c.fx,
          .fy = c.fy,
          .cx = c.cx,
          .cy = c.cy,
          .depth_scale = c.depth_scale,
          .depth = c.depth_along_ray == 0 ? DepthKind::z : DepthKind::ray,
          .distortion = {d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]},
          .width = c.width,
          .height = c.height};
}

}  // namespace

trivet_status trivet_recognize_points(const trivet_library* library, const void* xyz,
                                      trivet_number number, size_t width, size_t height,
                                      size_t stride, const double* viewpoint, trivet_unit unit,
                                      const char* const* options, const trivet_stopper* stopper,
                                      trivet_result** result, trivet_error* error) {
  return trivet::c::hand_out(result, error, [&] {
    SceneInput input;
    input.file = "points";
    if (viewpoint) input.viewpoint.emplace(viewpoint[0], viewpoint[1], viewpoint[2]);
    return recognize_scene({library, unit, options, stopper}, input, [&]() -> Result<Cloud> {
      TRIVET_TRY_ASSIGN(const ArrayView array, points_array(xyz, number, width, height, stride));
      return trivet::cloud_from_points(array, {.name = "points"});
    });
  });
}

trivet_status trivet_recognize_depth(const trivet_library* library, const void* depths,
                                     trivet_number number, size_t width, size_t height,
                                     size_t stride, const trivet_camera* camera, trivet_unit unit,
                                     const char* const* options, const trivet_stopper* stopper,
                                     trivet_result** result, trivet_error* error) {
  return trivet::c::hand_out(result, error, [&]() -> FoundInScene {
    if (!camera) return usage("expected a camera, found null");
    SceneInput input;
    input.file = "depth image";
    input.camera = camera_of(*camera);
    return recognize_scene({library, unit, options, stopper}, input, [&]() -> Result<Cloud> {
      TRIVET_TRY_ASSIGN(const ArrayView array, depths_array(depths, number, width, height, stride));
      return trivet::cloud_from_depths(array, *input.camera, {.name = "depth image"});
    });
  });
}

trivet_stopper* trivet_new_stopper(void) {
  try {
    return new trivet_stopper;
  } catch (...) {
    return nullptr;
  }
}

void trivet_stop(trivet_stopper* stopper) {
  if (stopper) stopper->source.request_stop();
}

void trivet_free_stopper(trivet_stopper* stopper) { delete stopper; }
