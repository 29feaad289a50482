#include "engine/scene/measure_sensor.hpp"

#include <algorithm>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/scene/sensor_image.hpp"
#include "kernels/common/median.hpp"
#include "kernels/scans/depth_steps.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

kernels::StepCounts count_steps(const kernels::RangeImage& image) {
  const std::size_t width = image.geometry.width, height = image.geometry.height;
  const std::size_t row_chunks = (height + kRowGrain - 1) / kRowGrain;
  std::vector<kernels::StepCounts> counts(row_chunks + (width + kRowGrain - 1) / kRowGrain);
  for_each_index(counts.size(), [&](std::size_t k) {
    const bool of_rows = k < row_chunks;
    const std::size_t first = (of_rows ? k : k - row_chunks) * kRowGrain;
    const std::size_t num = std::min(kRowGrain, (of_rows ? height : width) - first);
    counts[k] = of_rows ? kernels::count_steps_of_rows(image, first, num)
                        : kernels::count_steps_of_columns(image, first, num);
  });
  kernels::StepCounts all;
  for (const kernels::StepCounts& some : counts) all += some;
  return all;
}

}  // namespace

void measure_sensor(const kernels::RangeImage& image, const PrepareOptions& options,
                    kernels::SensorModel& sensor) {
  std::vector<float> ranges;
  for (const float d : image.depth) {
    if (d > 0) ranges.push_back(d);
  }
  check_stop();
  sensor.range = kernels::median(std::span(ranges));
  if (!options.correlated_noise) return;
  const std::size_t height = image.geometry.height;
  std::vector<std::vector<kernels::SmoothPatch>> rows((height + kRowGrain - 1) / kRowGrain);
  for_each_index(rows.size(), [&](std::size_t k) {
    const std::size_t first = k * kRowGrain;
    kernels::measure_patches(image, first, std::min(kRowGrain, height - first), rows[k]);
  });
  std::vector<kernels::SmoothPatch> patches;
  for (const auto& row : rows) patches.insert(patches.end(), row.begin(), row.end());
  kernels::fit_sensor_model(patches, sensor);
  sensor.may_be_smoothed = kernels::may_be_smoothed(count_steps(image));
}

}  // namespace trivet::engine
