/// Two parts, a scan of them in front of a wall, and the errors of poses found in it.
#pragma once

#include <benchmark/benchmark.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/prepare_scene.hpp"
#include "storage/library/library.hpp"
#include "support/shapes.hpp"

namespace trivet::bench {

struct Part {
  std::string name;
  test::Shape shape;
  Pose T_scene_part;  // /< ground-truth pose in the scan
};

/// A bracket and a lever of about 0.2 m without symmetry, sorted by name.
const std::vector<Part>& parts();

/// Both parts, trained; the same on every call with this step.
const std::vector<Model>& trained_parts(float relative_step);
inline constexpr float kDefaultStep = 0.04F;

/// A VGA depth scan of the parts in front of a wall, with 0.5 mm noise along the rays [m].
const Cloud& parts_scan();
const engine::PreparedScene& prepared_scan();

struct OrientedPoints {
  Points points;
  Normals normals;
};

/// The input of PCL and OpenCV instead of a mesh: points of the part's visible surface with outward
/// normals. Every prefix covers the surface evenly.
const OrientedPoints& part_surface(const Part& part);

/// The input of PCL and OpenCV instead of the scan: its points without the wall, with Trivet's
/// normals.
const OrientedPoints& scan_without_wall();

/// The clocks of rows for whole stages: wall time, and CPU time over all threads.
inline void measure_process_time(benchmark::internal::Benchmark* row) {
  row->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}

/// Adds counters: the number of expected poses that are right (within a tenth of the diameter and
/// 12 degrees), and the largest errors. One pose per part, in their order; empty where a part was
/// not found.
void report_poses(benchmark::State& state, std::span<const std::optional<Pose>> T_scene_parts);

/// Poses of the bracket 5 degrees and 0.04 diameters off the truth, to be refined.
const std::vector<Pose>& rough_poses();

/// Adds counters: the mean errors of the bracket's poses, refined from rough_poses().
void report_refined(benchmark::State& state, std::span<const Pose> T_scene_brackets);

}  // namespace trivet::bench
