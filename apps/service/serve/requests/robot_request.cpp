#include "apps/service/serve/requests/robot_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "apps/results/robot_table.hpp"
#include "engine/options/option.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

struct RobotRequest {
  RobotSetup setup;
  LengthUnit unit = LengthUnit::meter;  ///< unit of the scene
  std::vector<PosedModel> detections;
};

/// The index of a string among the choices.
std::size_t parse_choice(const JsonNode& node, std::span<const Choice> choices) {
  const std::string name = node.string();
  const auto found = std::ranges::find(choices, name, &Choice::name);
  if (found == choices.end()) {
    std::string names;
    for (const Choice& choice : choices)
      names += (names.empty() ? "" : ", ") + std::string(choice.name);
    node.refuse("expected one of " + names);
  }
  return static_cast<std::size_t>(found - choices.begin());
}

LengthUnit unit_of(const JsonNode& node) {
  const std::string unit = node.string();
  if (unit != "m" && unit != "mm") node.refuse("expected the unit \"m\" or \"mm\"");
  return parse_unit(unit);
}

RobotSetup parse_setup(const JsonNode& root) {
  RobotSetup setup;
  setup.convention = static_cast<RobotConvention>(
      parse_choice(root.at("convention"), choices_of<RobotConvention>()));
  if (root.has("frame")) {
    const JsonNode frame = root.at("frame").only({"name", "T_robot_scene"});
    setup.robot_frame = frame.at("name").string();
    if (setup.robot_frame.empty() || setup.robot_frame == kSceneFrame)
      frame.at("name").refuse("expected the name of a frame other than the scene's");
    setup.T_robot_scene = frame.at("T_robot_scene").file_pose();
  }
  if (root.has("grasps")) setup.grasps = parse_grasp_frames(root.at("grasps"));
  return setup;
}

RobotRequest parse_request(const JsonNode& root) {
  root.only({"convention", "scene", "unit", "frame", "grasps", "detections"});
  RobotRequest request{parse_setup(root), unit_of(root.at("unit")), {}};
  const std::string scene = root.at("scene").string();
  for (const JsonNode& node : root.at("detections").elements()) {
    const auto score = static_cast<float>(node.at("score").number());
    const auto pose_share = static_cast<float>(node.at("pose_share").number());
    request.detections.push_back({scene, node.at("model").string(), score, score * pose_share,
                                  node.at("ambiguous").boolean(),
                                  node.at("T_scene_model").file_pose(), request.unit});
  }
  return request;
}

nlohmann::ordered_json numbers_json(const RobotPose& pose, RobotConvention convention) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  const char* const length = unit_name(length_unit(convention));
  for (std::size_t k = 0; k < pose.position.size(); ++k)
    numbers.push_back(
        {{"name", std::string(1, "xyz"[k])}, {"value", pose.position[k]}, {"unit", length}});
  const std::span<const std::string_view> names = orientation_names(convention);
  for (std::size_t k = 0; k < names.size(); ++k)
    numbers.push_back({{"name", names[k]},
                       {"value", pose.orientation[k]},
                       {"unit", orientation_unit(convention)}});
  return numbers;
}

/// A length of the setup that suggests another unit than the one in which it is read.
nlohmann::ordered_json doubt_json(std::string_view about, double length, LengthUnit unit,
                                  LengthUnit likelier) {
  return {{"about", about},
          {"length", length},
          {"unit", unit_name(unit)},
          {"likelier", unit_name(likelier)}};
}

double longest_of(const std::map<std::string, FilePose>& grasps) {
  double longest = 0;
  for (const auto& [name, frame] : grasps) longest = std::max(longest, frame.translation().norm());
  return longest;
}

/// Of the grasps, the first model of the library whose lengths are in doubt stands for all.
nlohmann::ordered_json doubts_json(const RobotRequest& request, const Library& library) {
  nlohmann::ordered_json doubts = nlohmann::ordered_json::array();
  const RobotSetup& setup = request.setup;
  if (setup.T_robot_scene) {
    if (const auto likelier = likelier_frame_unit(*setup.T_robot_scene, request.unit))
      doubts.push_back(
          doubt_json("frame", setup.T_robot_scene->translation().norm(), request.unit, *likelier));
  }
  const LengthUnit unit = library.header.unit;
  for (const ModelInfo& model : library.models) {
    const auto grasps = setup.grasps.find(model.name);
    if (grasps == setup.grasps.end()) continue;
    const double length = longest_of(grasps->second);
    const auto likelier = likelier_grasp_unit(length, static_cast<double>(model.diameter), unit);
    if (!likelier) continue;
    doubts.push_back(doubt_json("grasps", length, unit, *likelier));
    doubts.back()["model"] = model.name;
    break;
  }
  return doubts;
}

}  // namespace

Result<nlohmann::ordered_json> robot_poses_json(const std::string& body, const Library& library) {
  RobotRequest request;
  const Result<void> read = with_json(std::as_bytes(std::span(body)), "request",
                                      [&](const JsonNode& root) { request = parse_request(root); });
  if (!read) return read.error();
  const RobotSetup& setup = request.setup;
  const LengthUnit unit = library.header.unit;
  RobotTable table(setup, unit);
  nlohmann::ordered_json poses = nlohmann::ordered_json::array();
  for (const PosedModel& posed : request.detections) {
    table.add(posed);
    nlohmann::ordered_json& of_model = poses.emplace_back(nlohmann::ordered_json::array());
    for (const RobotGrasp& grasp : robot_grasps(setup, posed, unit))
      of_model.push_back(
          {{"grasp", grasp.name}, {"numbers", numbers_json(grasp.pose, setup.convention)}});
  }
  return nlohmann::ordered_json{{"frame", setup.frame_name()},
                                {"poses", std::move(poses)},
                                {"table", table.csv().whole()},
                                {"doubts", doubts_json(request, library)}};
}

}  // namespace trivet::apps::service
