#include "apps/service/serve/recognize_query.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/inputs/inputs.hpp"
#include "apps/options/recognize_arguments.hpp"
#include "storage/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint32_t kMaxRejected = 100;
constexpr std::uint64_t kMaxPoints = 16'000'000;  ///< a small body may hold a large image

struct QueryArguments {
  RecognizeArguments recognize;
  std::vector<double> camera;
  std::vector<float> viewpoint;
  std::string unit;
  std::uint32_t rejected = 0;
  bool claims = false;
};

void add_query_options(CLI::App& app, QueryArguments& arguments) {
  app.set_help_flag();
  add_recognize_options(app, arguments.recognize);
  app.remove_option(app.get_option("--expected"));  // names a file of this machine
  app.add_option("--camera", arguments.camera)->delimiter(',')->expected(4, 5);
  app.add_option("--viewpoint", arguments.viewpoint)->delimiter(',')->expected(3);
  app.add_option("--unit", arguments.unit)->check(CLI::IsMember({"m", "mm"}));
  app.add_option("--rejected", arguments.rejected)->check(CLI::Range(0U, kMaxRejected));
  app.add_flag("--claims", arguments.claims);
}

}  // namespace

SceneInput ServedScene::input(LengthUnit library_unit) const {
  SceneInput out;
  out.viewpoint = viewpoint;
  if (unit) out.scale = unit_scale(*unit, library_unit);
  return out;
}

Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters) {
  QueryArguments arguments;
  CLI::App app;
  add_query_options(app, arguments);
  std::vector<std::string> words;
  for (const auto& [name, value] : parameters) {
    // Else it would be another word than it seems.
    if (name.empty() || name.find('=') != name.npos)
      return Error{ErrorCode::usage,
                   fmt::format("expected NAME=VALUE, found '{}={}'", name, value)};
    words.push_back("--" + name + (value.empty() ? "" : "=" + value));
  }
  std::ranges::reverse(words);  // as the parser takes them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return Error{ErrorCode::usage, error.what()};
  }
  Result<RecognizeOptions> options = options_of(arguments.recognize);
  if (!options) return options.error();
  options->max_rejected = arguments.rejected;
  options->tell_claims = arguments.claims;
  if (const Result<void> valid = validate(*options); !valid) return valid.error();

  RecognizeQuery query{std::move(*options), {}};
  if (const std::vector<double>& c = arguments.camera; !c.empty())
    query.scene.camera = Camera{c[0], c[1], c[2], c[3], c.size() > 4 ? c[4] : 1};
  if (const std::vector<float>& v = arguments.viewpoint; !v.empty())
    query.scene.viewpoint = Eigen::Vector3f(v[0], v[1], v[2]);
  if (!arguments.unit.empty()) query.scene.unit = parse_unit(arguments.unit);
  return query;
}

std::vector<std::string> recognize_parameter_names() {
  QueryArguments arguments;
  CLI::App app;
  add_query_options(app, arguments);
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options())
    names.push_back(option->get_single_name());
  std::ranges::sort(names);
  return names;
}

Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene) {
  return read_cloud(bytes, name,
                    {.camera = scene.camera, .max_points = kMaxPoints, .max_pixels = kMaxPoints});
}

}  // namespace trivet::apps::service
