/// The options of recognition on the command line, the same wherever scenes are recognized.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/recognize.hpp"

namespace trivet::apps {

struct RecognizeArguments {
  std::string method = "fused", preset = "balanced", models, expected, keypoints = "uniform",
              grouping = "frames";
  std::vector<std::string> ablated;  ///< names of improvements
  std::vector<float> region, tilt;
  std::optional<float> min_score, reference_share, neighbor_share, max_distance, max_ratio,
      keypoint_spacing, max_lean, min_cluster_share, normal_window;
  std::optional<std::uint32_t> max_instances, max_votes, rounds, neighbors;
  bool require_pose = false, weigh_by_ratio = false;
};

/// `arguments` must live as long as the command.
void add_recognize_options(CLI::App& command, RecognizeArguments& arguments);

/// The preset with what was given on the command line in its place. Errors: of reading expected
/// poses.
Result<RecognizeOptions> options_of(const RecognizeArguments& arguments);

}  // namespace trivet::apps
