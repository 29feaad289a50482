#include "apps/options/recognize_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/options/option_names.hpp"
#include "apps/options/presets.hpp"
#include "apps/results/detections_json.hpp"

namespace trivet::apps {
namespace {

std::vector<std::string> improvement_names() {
  std::vector<std::string> names;
  for (const ImprovementName& known : kImprovements) names.emplace_back(known.name);
  return names;
}

std::string describe_methods() {
  std::string text = "Where hypotheses come from:";
  for (const MethodName& known : kMethods)
    text += fmt::format("\n{}: {}", known.name, known.sentence);
  return text;
}

std::string describe_improvements() {
  std::string text = "Leave improvements out, as a,b,c, to measure what each is worth:";
  for (const ImprovementName& known : kImprovements)
    text += fmt::format("\n{}: {}", known.name, known.sentence);
  return text;
}

}  // namespace

void add_recognize_options(CLI::App& command, RecognizeArguments& arguments) {
  command.add_option("--method", arguments.method, describe_methods())
      ->check(CLI::IsMember(option_names<Method>()).description(""))
      ->capture_default_str();
  command.add_option("--preset", arguments.preset, "fast, balanced or accurate")
      ->check(CLI::IsMember({"fast", "balanced", "accurate"}))
      ->capture_default_str();
  command.add_option("--min-score", arguments.min_score,
                     "Detections below are not reported, 0 to 1 (default 0.8)");
  command.add_flag("--require-pose", arguments.require_pose,
                   "Report only detections whose very pose, not only the object, has the minimum "
                   "score");
  command.add_option("--max-instances", arguments.max_instances,
                     "Per model and scene (default 100)");
  command.add_option("--normal-window", arguments.normal_window,
                     "Radius of the windows that normals are fitted to, in mean spacings of the "
                     "scan's points, 1 to 20 (default: 2 to 7, by the scan's noise)");
  command.add_option(
      "--reference-share", arguments.reference_share,
      "Share of the sampled scene points that vote, above 0 to 1; overrides the preset");
  command.add_option(
      "--neighbor-share", arguments.neighbor_share,
      "Outer share of a feature bin in which the adjoining cell votes too, 0 to 0.5");
  command.add_option("--max-votes", arguments.max_votes,
                     "Votes of a reference point for a model; fewer is faster (default 40000)");
  command
      .add_option(
          "--keypoints", arguments.keypoints,
          "trisi: points of the scene that are described: spread evenly, by intrinsic shape "
          "signatures, or by Harris 3D")
      ->check(CLI::IsMember(option_names<Detector>()))
      ->capture_default_str();
  command.add_option("--keypoint-spacing", arguments.keypoint_spacing,
                     "trisi: between them, in 1/80 of the models' diameter, 1 to 20 (default 3)");
  command.add_option(
      "--max-lean", arguments.max_lean,
      "trisi: how far the surface around a keypoint may lie to one side, in radii of "
      "what is described: 0.15 leaves borders out (default 1)");
  command.add_option("--neighbors", arguments.neighbors,
                     "trisi: features of models that each feature is matched with, 1 to 10 "
                     "(default 3)");
  command.add_option("--max-distance", arguments.max_distance,
                     "trisi: largest distance of matched features, above 0 (default: any)");
  command.add_option("--max-ratio", arguments.max_ratio,
                     "trisi: largest ratio of the distance to that of the nearest feature of "
                     "another place, above 0 to 1 (default 1: any)");
  command.add_flag("--weigh-by-ratio", arguments.weigh_by_ratio,
                   "trisi: a match has 1 - ratio votes instead of 1");
  command
      .add_option("--grouping", arguments.grouping,
                  "trisi: how matches become poses: each by its two frames, or together by "
                  "geometric consistency or RANSAC")
      ->check(CLI::IsMember(option_names<Grouping>()))
      ->capture_default_str();
  command.add_option("--min-cluster-share", arguments.min_cluster_share,
                     "Clusters of poses with less than this share of the best one's votes are "
                     "dropped, 0 to 1 (default 0)");
  command.add_option(
      "--rounds", arguments.rounds,
      "Of searching, later ones on what is not yet explained; 0 to test expected poses "
      "only, else 1 to 4 (default 2)");
  command.add_option("--models", arguments.models, "Only these models, as a,b,c");
  command
      .add_option("--region", arguments.region,
                  "Box x0,y0,z0,x1,y1,z1 in the scene's frame and unit that the models' centers "
                  "lie in; the rest is not searched")
      ->delimiter(',')
      ->expected(6);
  command
      .add_option("--tilt", arguments.tilt,
                  "Limit mx,my,mz,sx,sy,sz,DEG: the model's direction m is within DEG degrees of "
                  "the scene's direction s")
      ->delimiter(',')
      ->expected(7);
  command.add_option("--expected", arguments.expected,
                     "Result of an earlier recognition (--json): its poses are tested first, and "
                     "voting is for what they leave unexplained");
  command.add_option("--ablate", arguments.ablated, describe_improvements())
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(improvement_names()).description(""));
}

Result<RecognizeOptions> options_of(const RecognizeArguments& arguments) {
  RecognizeOptions options = recognize_presets().at(arguments.preset);
  options.method = option_names<Method>().at(arguments.method);
  if (arguments.min_score) options.min_score = *arguments.min_score;
  options.require_pose = arguments.require_pose;
  options.normal_window = arguments.normal_window;
  if (arguments.reference_share) options.vote.reference_share = *arguments.reference_share;
  if (arguments.neighbor_share) options.vote.neighbor_share = *arguments.neighbor_share;
  if (arguments.max_votes) options.vote.max_votes = *arguments.max_votes;
  options.match.detector = option_names<Detector>().at(arguments.keypoints);
  options.match.grouping = option_names<Grouping>().at(arguments.grouping);
  options.match.weigh_by_ratio = arguments.weigh_by_ratio;
  if (arguments.keypoint_spacing) options.match.spacing = *arguments.keypoint_spacing;
  if (arguments.max_lean) options.match.limits.max_lean = *arguments.max_lean;
  if (arguments.neighbors) options.match.num_neighbors = *arguments.neighbors;
  if (arguments.max_distance) options.match.max_distance = *arguments.max_distance;
  if (arguments.max_ratio) options.match.max_ratio = *arguments.max_ratio;
  if (arguments.min_cluster_share) options.pose.min_cluster_share = *arguments.min_cluster_share;
  if (arguments.max_instances) options.max_instances = *arguments.max_instances;
  if (arguments.rounds) options.pose.rounds = *arguments.rounds;
  if (!arguments.models.empty()) options.models = CLI::detail::split(arguments.models, ',');
  if (const std::vector<float>& r = arguments.region; !r.empty())
    options.limits.region = PoseLimits::Region{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}};
  if (const std::vector<float>& t = arguments.tilt; !t.empty())
    options.limits.tilt = PoseLimits::Tilt{{t[0], t[1], t[2]}, {t[3], t[4], t[5]}, t[6]};
  if (!arguments.expected.empty()) {
    Result<std::vector<ExpectedPose>> expected = read_expected_poses(arguments.expected);
    if (!expected) return expected.error();
    options.expected = std::move(*expected);
  }
  for (const ImprovementName& known : kImprovements) {
    if (std::ranges::find(arguments.ablated, known.name) != arguments.ablated.end())
      options.ablated.insert(known.improvement);
  }
  return options;
}

}  // namespace trivet::apps
