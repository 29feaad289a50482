#include "apps/service/serve/library/model_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "apps/results/detections_json.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kSameAxis = 0.9998F;  // cosine of 1 degree
constexpr float kDegreesPerRadian = 180 / std::numbers::pi_v<float>;

/// An axis about which a rotation maps the model onto itself, or nearly.
struct TurnAxis {
  Eigen::Vector3f direction, point;
  float turn = 0;  ///< smallest rotation [rad]; 0: any
};

/// The distinct axes of some rotations. Every symmetry keeps the center in place, near ones nearly.
std::vector<TurnAxis> axes_of(std::span<const Pose> poses, const std::optional<Symmetry::Axis>& any,
                              const Eigen::Vector3f& center) {
  std::vector<TurnAxis> axes;
  if (any) axes.push_back({any->direction, any->point, 0});
  for (const Pose& pose : poses) {
    const Eigen::AngleAxisf turn(Eigen::Matrix3f(pose.linear()));
    const auto same = std::ranges::find_if(axes, [&](const TurnAxis& axis) {
      return std::abs(axis.direction.dot(turn.axis())) > kSameAxis;
    });
    if (same == axes.end()) {
      axes.push_back({turn.axis(), center, turn.angle()});
    } else if (same->turn > 0) {
      same->turn = std::min(same->turn, turn.angle());
    }
  }
  return axes;
}

Json vector_json(const Eigen::Vector3f& v) { return std::array{v.x(), v.y(), v.z()}; }

Json axes_json(const std::vector<TurnAxis>& axes) {
  Json json = Json::array();
  for (const TurnAxis& axis : axes) {
    json.push_back(turn_axis_json({axis.direction, axis.point}, axis.turn));
  }
  return json;
}

/// Symmetries as a manifest declares them; null if there are none.
Json declaration_json(std::span<const std::vector<Pose>* const> poses,
                      const std::optional<Symmetry::Axis>& axis) {
  Json symmetries = Json::array();
  for (const std::vector<Pose>* const some : poses) {
    for (const Pose& pose : *some) symmetries.push_back(apps::matrix_json(pose.cast<double>()));
  }
  if (symmetries.empty() && !axis) return nullptr;
  Json declaration{{"symmetries", std::move(symmetries)}};
  if (axis) {
    declaration["symmetry_axis"] = {{"axis", vector_json(axis->direction)},
                                    {"offset", vector_json(axis->point)}};
  }
  return declaration;
}

/// The near symmetries of the model together with its exact ones, since a declaration replaces all
/// symmetries.
Json near_declaration_json(const ModelInfo& model) {
  if (model.near_symmetries.empty() && !model.near_axis) return nullptr;
  return declaration_json(std::array{&model.symmetry.poses, &model.near_symmetries},
                          model.near_axis ? model.near_axis : model.symmetry.axis);
}

}  // namespace

Json turn_axis_json(const Symmetry::Axis& axis, float turn) {
  return {{"direction", vector_json(axis.direction)},
          {"point", vector_json(axis.point)},
          {"turn_deg", turn > 0 ? Json(kDegreesPerRadian * turn) : Json()}};
}

Json model_json(const ModelInfo& model) {
  return {
      {"name", model.name},
      {"diameter", model.diameter},
      {"symmetry",
       {{"poses", model.symmetry.poses.size()},
        {"axis", model.symmetry.axis.has_value()},
        {"axes", axes_json(axes_of(model.symmetry.poses, model.symmetry.axis, model.center))},
        {"declared", model.symmetry.declared},
        {"declaration", declaration_json(std::array{&model.symmetry.poses}, model.symmetry.axis)}}},
      {"near_symmetry",
       {{"poses", model.near_symmetries.size()},
        {"axis", model.near_axis.has_value()},
        {"axes", axes_json(axes_of(model.near_symmetries, model.near_axis, model.center))},
        {"declaration", near_declaration_json(model)}}}};
}

}  // namespace trivet::apps::service
