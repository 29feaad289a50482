#include "engine/options/recognize_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/options/declare_option.hpp"
#include "kernels/pair_features/vote.hpp"

namespace trivet {
namespace {

constexpr std::array<Choice, 3> kMethods{{
    {"fused", "point pairs, then both of these on what is not yet explained"},
    {"ppf", "votes of point pairs (Drost et al., CVPR 2010)"},
    {"trisi", "matches of Tri-Spin-Images (Guo et al., GRAPP 2013)"},
}};
constexpr std::array<Choice, 2> kSearches{{
    {"automatic",
     "within a budget for the scene, which some thirty models on a table do not use up"},
    {"exhaustive", "each model on its own, whatever it costs: the reference"},
}};
constexpr std::array<Choice, 3> kDetectors{{
    {"uniform", "spread evenly"},
    {"iss", "intrinsic shape signatures"},
    {"harris", "Harris 3D"},
}};
constexpr std::array<Choice, 3> kGroupings{{
    {"frames", "each match gives a pose, by its two frames"},
    {"consistency", "matches whose distances agree give one together"},
    {"ransac", "so do those that a pose of three takes to their places"},
}};

}  // namespace

template <>
std::span<const Choice> choices_of<Method>() {
  return kMethods;
}
template <>
std::span<const Choice> choices_of<Search>() {
  return kSearches;
}
template <>
std::span<const Choice> choices_of<Detector>() {
  return kDetectors;
}
template <>
std::span<const Choice> choices_of<Grouping>() {
  return kGroupings;
}

namespace engine {

template <>
struct FieldTraits<ImprovementSet> {
  static constexpr OptionKind kKind = OptionKind::names;
  static OptionValue get(const ImprovementSet& field) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < kImprovements.size(); ++k) {
      if (field.contains(static_cast<Improvement>(k))) names.emplace_back(kImprovements[k].name);
    }
    return names;
  }
  static void set(ImprovementSet& field, const OptionValue& value) {
    const auto& names = std::get<std::vector<std::string>>(value);
    field = {};
    for (std::size_t k = 0; k < kImprovements.size(); ++k) {
      if (std::ranges::find(names, kImprovements[k].name) != names.end())
        field.insert(static_cast<Improvement>(k));
    }
  }
};

template <>
struct FieldTraits<std::optional<Eigen::Vector3d>> {
  static constexpr OptionKind kKind = OptionKind::numbers;
  static OptionValue get(const std::optional<Eigen::Vector3d>& field) {
    return field ? std::vector<double>(field->begin(), field->end()) : std::vector<double>();
  }
  static void set(std::optional<Eigen::Vector3d>& field, const OptionValue& value) {
    const auto& n = std::get<std::vector<double>>(value);
    field.reset();
    if (!n.empty()) field = Eigen::Vector3d(n[0], n[1], n[2]);
  }
};

template <>
struct FieldTraits<std::optional<PoseLimits::Region>> {
  static constexpr OptionKind kKind = OptionKind::numbers;
  static OptionValue get(const std::optional<PoseLimits::Region>& field) {
    std::vector<double> numbers;
    if (!field) return numbers;
    numbers.assign(field->low.begin(), field->low.end());
    numbers.insert(numbers.end(), field->high.begin(), field->high.end());
    return numbers;
  }
  static void set(std::optional<PoseLimits::Region>& field, const OptionValue& value) {
    const auto& n = std::get<std::vector<double>>(value);
    field.reset();
    if (!n.empty()) field = {Eigen::Vector3d(n[0], n[1], n[2]), Eigen::Vector3d(n[3], n[4], n[5])};
  }
};

template <>
struct FieldTraits<std::optional<PoseLimits::Tilt>> {
  static constexpr OptionKind kKind = OptionKind::numbers;
  static OptionValue get(const std::optional<PoseLimits::Tilt>& field) {
    std::vector<double> numbers;
    if (!field) return numbers;
    for (const float x : field->model_direction) numbers.push_back(decimal_of(x));
    for (const float x : field->scene_direction) numbers.push_back(decimal_of(x));
    numbers.push_back(decimal_of(field->max_angle_deg));
    return numbers;
  }
  static void set(std::optional<PoseLimits::Tilt>& field, const OptionValue& value) {
    const auto& n = std::get<std::vector<double>>(value);
    field.reset();
    if (!n.empty())
      field = {Eigen::Vector3d(n[0], n[1], n[2]).cast<float>(),
               Eigen::Vector3d(n[3], n[4], n[5]).cast<float>(), static_cast<float>(n[6])};
  }
};

}  // namespace engine

namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr std::string_view kAnswers = "Answers", kSearch = "What is searched",
                           kVoting = "For research: voting, first round",
                           kLater = "For research: voting, later rounds",
                           kMatching = "For research: matching of Tri-Spin-Images",
                           kPoses = "For research: hypotheses",
                           kVerification = "For research: verification";

template <auto Path>
Option<RecognizeOptions> declare(const OptionInfo& info) {
  return engine::declare_option<RecognizeOptions, Path>(info);
}

}  // namespace

/// Ordered by how soon a user needs them.
template <>
std::span<const Option<RecognizeOptions>> options_of<RecognizeOptions>() {
  static const std::array kOptions{
      declare<TRIVET_FIELD(min_score)>({.name = "min-score",
                                        .group = kAnswers,
                                        .label = "least score",
                                        .help = "Detections below are not reported",
                                        .range = {0, 1}}),
      declare<TRIVET_FIELD(require_pose)>(
          {.name = "require-pose",
           .group = kAnswers,
           .label = "least score held against the very pose",
           .help = "Report only detections whose very pose, not only the object, has the least "
                   "score"}),
      declare<TRIVET_FIELD(require_identity)>(
          {.name = "require-identity",
           .group = kAnswers,
           .label = "least score held against the model named first",
           .help = "Report only detections whose first candidate, not only any of them, has the "
                   "least score"}),
      declare<TRIVET_FIELD(max_sigma)>(
          {.name = "max-sigma",
           .group = kAnswers,
           .label = "largest standard deviation of a position",
           .unit = "scene unit",
           .help = "Detections are ambiguous whose position is less certain in some direction, as "
                   "along a face whose ends are hidden",
           .unset_help = "any",
           .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(max_instances)>({.name = "max-instances",
                                            .group = kAnswers,
                                            .label = "instances of a model",
                                            .help = "Per model and scene"}),
      declare<TRIVET_FIELD(max_rejected)>(
          {.name = "rejected",
           .group = kAnswers,
           .label = "rejected poses of a model that are reported",
           .help = "Poses per model that are reported with the reason why they are no detections",
           .range = {0, 100},
           .place = OptionPlace::service_only}),
      declare<TRIVET_FIELD(explain.point)>({.name = "explain",
                                            .group = kAnswers,
                                            .label = "place to explain",
                                            .help =
                                                "Report why models are found at the place x,y,z "
                                                "of the scene, or are not, in its frame "
                                                "and unit",
                                            .unset_help = "none",
                                            .length = 3,
                                            .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(explain.models)>({.name = "model",
                                             .group = kAnswers,
                                             .label = "models to explain there",
                                             .help = "Of the place to explain: only these models",
                                             .unset_help = "all that come near it",
                                             .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(method)>({.name = "method",
                                     .group = kSearch,
                                     .label = "method",
                                     .help = "Where hypotheses come from",
                                     .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(models)>({.name = "models",
                                     .group = kSearch,
                                     .label = "models searched",
                                     .help = "Only these models, by their names",
                                     .unset_help = "all",
                                     .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(limits.region)>(
          {.name = "region",
           .group = kSearch,
           .label = "region",
           .help = "Box x0,y0,z0,x1,y1,z1 in the scene's frame and unit that the models' centers "
                   "lie in",
           .unset_help = "everywhere",
           .length = 6,
           .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(limits.tilt)>(
          {.name = "tilt",
           .group = kSearch,
           .label = "tilt",
           .help = "Limit mx,my,mz,sx,sy,sz,DEG: the model's direction m is within DEG degrees of "
                   "the scene's direction s",
           .unset_help = "any",
           .length = 7,
           .place = OptionPlace::not_in_studies}),
      declare<TRIVET_FIELD(search)>({.name = "search",
                                     .group = kSearch,
                                     .label = "search",
                                     .help = "How the models share the work"}),
      declare<TRIVET_FIELD(budget)>({.name = "budget",
                                     .group = kSearch,
                                     .label = "budget of a scene",
                                     .help = "Work that a scene may cost, with large libraries or "
                                             "in large scenes; more is slower and finds more",
                                     .range = {0.05, 100}}),
      declare<TRIVET_FIELD(pose.rounds)>(
          {.name = "rounds",
           .group = kSearch,
           .label = "rounds of searching",
           .help = "Of searching, later ones on what is not yet explained; 0 to test expected "
                   "poses only",
           .range = {0, 4}}),
      declare<TRIVET_FIELD(verify.model_deviation)>(
          {.name = "model-deviation",
           .group = kSearch,
           .label = "deviation of the parts from their models",
           .unit = "scene unit",
           .help =
               "Parts differ from their models by so much, root mean square, as cast, printed "
               "and scanned ones do: what agrees may lie farther off, and poses are less certain",
           .range = {0, kAny}}),
      declare<TRIVET_FIELD(normal_window)>(
          {.name = "normal-window",
           .group = kSearch,
           .label = "radius of the normals' windows",
           .unit = "spacing",
           .help = "Radius of the windows that normals are fitted to, in mean spacings of the "
                   "scan's points",
           .unset_help = "2 to 7, by the scan's noise",
           .range = {1, 20}}),

      declare<TRIVET_FIELD(vote.radius)>(
          {.name = "radius",
           .group = kVoting,
           .label = "radius of pairs",
           .unit = "diameter",
           .help = "Pairs of a reference point end within it in the first round; smaller is faster "
                   "and bears more occlusion, larger bears more noise",
           .range = {0, 1, true}}),
      declare<TRIVET_FIELD(vote.reference_share)>(
          {.name = "reference-share",
           .group = kVoting,
           .label = "share of points that are references",
           .help =
               "Share of the sampled points of the scan that vote in the first round; overrides "
               "the preset",
           .range = {0, 1, true}}),
      declare<TRIVET_FIELD(vote.max_references)>(
          {.name = "max-references",
           .group = kVoting,
           .label = "most references",
           .help =
               "References per size of models in the first round; fewer is faster in large scenes",
           .range = {1, kAny}}),
      declare<TRIVET_FIELD(vote.max_votes)>(
          {.name = "max-votes",
           .group = kVoting,
           .label = "votes of a reference point for a model",
           .help = "Votes of a reference point for a model in the first round; fewer is faster",
           .range = {1, kAny}}),
      declare<TRIVET_FIELD(vote.neighbor_share)>(
          {.name = "neighbor-share",
           .group = kVoting,
           .label = "share of a bin that votes for the next, too",
           .help =
               "Outer share of a feature bin in which the adjoining cell votes too in the first "
               "round; slower",
           .range = {0, 0.5}}),
      declare<TRIVET_FIELD(vote.max_peaks)>(
          {.name = "max-peaks",
           .group = kVoting,
           .label = "poses of a reference point",
           .help = "Poses of a reference point in the first round",
           .range = {1, kernels::kMaxPeaks}}),
      declare<TRIVET_FIELD(vote.peak_share)>(
          {.name = "peak-share",
           .group = kVoting,
           .label = "least share of the best pose's votes",
           .help = "Poses with less than this share of the votes of their reference point's best "
                   "are dropped",
           .range = {0, 1, true}}),

      declare<TRIVET_FIELD(later.radius)>({.name = "later-radius",
                                           .group = kLater,
                                           .label = "radius of pairs, later rounds",
                                           .unit = "diameter",
                                           .help = "In later rounds, as --radius",
                                           .range = {0, 1, true}}),
      declare<TRIVET_FIELD(later.reference_share)>(
          {.name = "later-reference-share",
           .group = kLater,
           .label = "share of points that are references, later rounds",
           .help = "In later rounds, as --reference-share; overrides the preset",
           .range = {0, 1, true}}),
      declare<TRIVET_FIELD(later.max_references)>({.name = "later-max-references",
                                                   .group = kLater,
                                                   .label = "most references, later rounds",
                                                   .help = "In later rounds, as --max-references",
                                                   .range = {1, kAny}}),
      declare<TRIVET_FIELD(later.max_votes)>(
          {.name = "later-max-votes",
           .group = kLater,
           .label = "votes of a reference point for a model, later rounds",
           .help = "In later rounds, as --max-votes",
           .range = {1, kAny}}),
      declare<TRIVET_FIELD(later.neighbor_share)>(
          {.name = "later-neighbor-share",
           .group = kLater,
           .label = "share of a bin that votes for the next, too, later rounds",
           .help = "In later rounds, as --neighbor-share",
           .range = {0, 0.5}}),
      declare<TRIVET_FIELD(later.max_peaks)>({.name = "later-max-peaks",
                                              .group = kLater,
                                              .label = "poses of a reference point, later rounds",
                                              .help = "In later rounds, as --max-peaks",
                                              .range = {1, kernels::kMaxPeaks}}),
      declare<TRIVET_FIELD(later.peak_share)>(
          {.name = "later-peak-share",
           .group = kLater,
           .label = "least share of the best pose's votes, later rounds",
           .help = "In later rounds, as --peak-share",
           .range = {0, 1, true}}),

      declare<TRIVET_FIELD(match.detector)>({.name = "keypoints",
                                             .group = kMatching,
                                             .label = "keypoint detector",
                                             .help = "Which points of the scan are described"}),
      declare<TRIVET_FIELD(match.spacing)>({.name = "keypoint-spacing",
                                            .group = kMatching,
                                            .label = "spacing of keypoints",
                                            .unit = "1/80 diameter",
                                            .help = "Between keypoints of the scan",
                                            .range = {1, 20}}),
      declare<TRIVET_FIELD(match.max_keypoints)>(
          {.name = "max-keypoints",
           .group = kMatching,
           .label = "most keypoints",
           .help =
               "Of more, so many spread over the image are described; a fifth of it after votes",
           .range = {1, kAny}}),
      declare<TRIVET_FIELD(match.limits.max_lean)>(
          {.name = "max-lean",
           .group = kMatching,
           .label = "lean of a keypoint's surface",
           .unit = "radius",
           .help = "How far the surface around a keypoint may lie to one side, in radii of what is "
                   "described: 0.15 leaves borders out",
           .range = {0, kAny}}),
      declare<TRIVET_FIELD(match.num_neighbors)>(
          {.name = "neighbors",
           .group = kMatching,
           .label = "features that each is matched with",
           .help = "Features of models that each feature is matched with",
           .range = {1, 10}}),
      declare<TRIVET_FIELD(match.num_lists)>({.name = "match-lists",
                                              .group = kMatching,
                                              .label = "lists of the index searched",
                                              .help = "Lists of some 2,000 features of models that "
                                                      "each feature is compared with; more are "
                                                      "slower and more exact",
                                              .range = {1, kAny}}),
      declare<TRIVET_FIELD(match.max_distance)>({.name = "max-distance",
                                                 .group = kMatching,
                                                 .label = "largest distance of matches",
                                                 .help = "Largest distance of matched features",
                                                 .unset_help = "any",
                                                 .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(match.max_ratio)>(
          {.name = "max-ratio",
           .group = kMatching,
           .label = "matching threshold tau (NNDR)",
           .help = "Largest ratio of the distance to that of the nearest feature of another place; "
                   "1: any",
           .range = {0, 1, true}}),
      declare<TRIVET_FIELD(match.weigh_by_ratio)>(
          {.name = "weigh-by-ratio",
           .group = kMatching,
           .label = "matches weighed by their ratio",
           .help = "A match has 1 - ratio votes instead of 1"}),
      declare<TRIVET_FIELD(match.grouping)>({.name = "grouping",
                                             .group = kMatching,
                                             .label = "grouping of matches",
                                             .help = "How matches become poses"}),

      declare<TRIVET_FIELD(pose.cluster_translation)>(
          {.name = "cluster-translation",
           .group = kPoses,
           .label = "translation threshold of clustering",
           .unit = "diameter",
           .help = "Largest distance of poses in a cluster",
           .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(pose.cluster_rotation_deg)>(
          {.name = "cluster-rotation",
           .group = kPoses,
           .label = "rotation threshold of clustering",
           .unit = "°",
           .help = "Largest angle between poses in a cluster",
           .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(pose.min_cluster_share)>(
          {.name = "min-cluster-share",
           .group = kPoses,
           .label = "least share of the best cluster's votes",
           .help = "Clusters of poses with less than this share of the best one's votes are "
                   "dropped",
           .range = {0, 1}}),
      declare<TRIVET_FIELD(pose.max_clusters)>(
          {.name = "max-clusters",
           .group = kPoses,
           .label = "clusters of a model",
           .help = "Clusters of a model that are verified coarsely; overrides the preset"}),
      declare<TRIVET_FIELD(pose.max_refined)>(
          {.name = "max-refined",
           .group = kPoses,
           .label = "refined poses of a model",
           .help = "Poses of a model that are refined by ICP; overrides the preset"}),
      declare<TRIVET_FIELD(pose.max_examined)>(
          {.name = "max-examined",
           .group = kPoses,
           .label = "ray-cast poses of a model",
           .help = "Poses of a model that are verified by ray casting; overrides the preset"}),

      declare<TRIVET_FIELD(verify.tolerance_sigmas)>(
          {.name = "tolerance-sigmas",
           .group = kVerification,
           .label = "tolerance of agreement",
           .unit = "sigma",
           .help = "What agrees lies within so many standard deviations of the scan's noise",
           .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(verify.tolerance_diameters)>(
          {.name = "tolerance-diameters",
           .group = kVerification,
           .label = "least tolerance of agreement",
           .unit = "diameter",
           .help = "... or within this share of the diameter, if that is more",
           .range = {0, kAny, true}}),
      declare<TRIVET_FIELD(verify.max_overlap)>(
          {.name = "max-overlap",
           .group = kVerification,
           .label = "pixels that better detections may explain",
           .help = "Share of a detection's pixels that better ones may already explain",
           .range = {0, 1}}),
      [] {
        Option<RecognizeOptions> ablate = declare<TRIVET_FIELD(ablated)>(
            {.name = "ablate",
             .group = kVerification,
             .label = "left out",
             .help = "Leave improvements out, to measure what each is worth"});
        ablate.info.choices = kImprovements;
        return ablate;
      }(),
  };
  return kOptions;
}

namespace {

bool is_direction(const Eigen::Vector3f& v) { return v.norm() > 0 && std::isfinite(v.norm()); }

}  // namespace

Result<void> validate(const RecognizeOptions& options) {
  TRIVET_TRY(check_options(options));
  const auto refuse = [](const char* what) { return Error{ErrorCode::usage, what}; };
  if (const auto& region = options.limits.region;
      region && !(region->low.array() <= region->high.array()).all())
    return refuse("region: expected a box whose low corner is below its high corner");
  if (const auto& tilt = options.limits.tilt;
      tilt && !(is_direction(tilt->model_direction) && is_direction(tilt->scene_direction) &&
                tilt->max_angle_deg >= 0))
    return refuse("tilt: expected two directions of a length above 0 and an angle of at least 0");
  if (options.doubtful_score && !(*options.doubtful_score >= 0 && *options.doubtful_score <= 1))
    return refuse("doubtful score: expected 0 to 1");
  return {};
}

}  // namespace trivet
