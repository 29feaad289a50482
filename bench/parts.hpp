/// Two parts, a scan of them in front of a wall, and how well poses found in it agree with the
/// truth.
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
  Pose T_scene_part;  ///< where it is in the scan
};

/// A bracket and a lever of about 0.2 m without symmetry, in the order of their names.
const std::vector<Part>& parts();

/// Both, trained; the same on every call with this step.
const Library& trained_parts(float relative_step);
inline constexpr float kDefaultStep = 0.04F;

/// VGA depth scan of the parts in front of a wall, with 0.5 mm noise along the rays [m].
const Cloud& parts_scan();
const engine::PreparedScene& prepared_scan();

struct OrientedPoints {
  Points points;
  Normals normals;
};

/// What peers are given in place of a mesh: points of the part's visible surface with outward
/// normals. Every prefix covers the surface evenly.
const OrientedPoints& part_surface(const Part& part);

/// What peers are given in place of the scan: its points without the wall, normals as Trivet
/// estimates them.
const OrientedPoints& scan_without_wall();

/// How rows of whole stages are timed: the wall's clock, and the processor's over all threads.
inline void whole_process(benchmark::internal::Benchmark* row) {
  row->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}

/// Add counters: how many of the expected poses are right (within a tenth of the diameter and 12
/// degrees), and the largest errors. One pose a part, in their order; nothing where a part was not
/// found.
void report_poses(benchmark::State& state, std::span<const std::optional<Pose>> T_scene_parts);

/// Poses of the bracket 5 degrees and 0.04 diameters off the truth, to be refined.
const std::vector<Pose>& rough_poses();

/// Add counters: the mean errors of the bracket's poses, refined from rough_poses().
void report_refined(benchmark::State& state, std::span<const Pose> T_scene_brackets);

}  // namespace trivet::bench
