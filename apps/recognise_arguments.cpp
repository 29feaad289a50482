#include "apps/recognise_arguments.hpp"

#include "apps/presets.hpp"

namespace trivet::apps {

void add_recognise_options(CLI::App& command, RecogniseArguments& arguments) {
  command.add_option("--method", arguments.method, "ppf: point-pair features")
      ->check(CLI::IsMember({"ppf"}))
      ->capture_default_str();
  command.add_option("--preset", arguments.preset, "fast, balanced or accurate")
      ->check(CLI::IsMember({"fast", "balanced", "accurate"}))
      ->capture_default_str();
  command.add_option("--min-score", arguments.min_score,
                     "Detections below are not reported, 0 to 1 (default 0.5)");
  command.add_option("--max-instances", arguments.max_instances,
                     "Per model and scene (default 100)");
  command.add_option(
      "--reference-share", arguments.reference_share,
      "Share of the sampled scene points that vote, above 0 to 1; overrides the preset");
  command.add_option(
      "--neighbour-share", arguments.neighbour_share,
      "Outer share of a feature bin in which the adjoining cell votes too, 0 to 0.5");
  command.add_option("--max-votes", arguments.max_votes,
                     "Votes of a reference point for a model; fewer is faster (default 60000)");
  command.add_option("--models", arguments.models, "Only these models, as a,b,c");
}

RecogniseOptions options_of(const RecogniseArguments& arguments) {
  RecogniseOptions options = recognise_presets().at(arguments.preset);
  if (arguments.min_score) options.min_score = *arguments.min_score;
  if (arguments.reference_share) options.vote.reference_share = *arguments.reference_share;
  if (arguments.neighbour_share) options.vote.neighbour_share = *arguments.neighbour_share;
  if (arguments.max_votes) options.vote.max_votes = *arguments.max_votes;
  if (arguments.max_instances) options.max_instances = *arguments.max_instances;
  if (!arguments.models.empty()) options.models = CLI::detail::split(arguments.models, ',');
  return options;
}

}  // namespace trivet::apps
