// Poses for robot controllers, as a service gives them.
#include "apps/service/serve/requests/robot_request.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "apps/results/detections_json.hpp"
#include "apps/results/robot_poses.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

FilePose pose_of(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  FilePose pose = FilePose::Identity();
  pose.linear() = rotation;
  pose.translation() = position;
  return pose;
}

Library library_in_mm() {
  std::vector<Model> models(1);
  models[0].name = "cup";
  models[0].diameter = 100;
  Library library(std::move(models));
  library.header.unit = LengthUnit::millimeter;
  return library;
}

/// A request for one detection of a cup in a scene in meters.
Json request_for(const FilePose& T_scene_model, const std::string& convention) {
  return {{"convention", convention},
          {"scene", "a, b.ply"},
          {"unit", "m"},
          {"detections",
           {{{"model", "cup"},
             {"score", 0.75},
             {"pose_share", 0.5},
             {"ambiguous", true},
             {"T_scene_model", matrix_json(T_scene_model)}}}}};
}

Json answer_to(const Json& request) {
  const auto answer = robot_poses_json(request.dump(), library_in_mm());
  EXPECT_TRUE(answer) << answer.error().message;
  return answer ? *answer : Json();
}

std::string refusal_of(const Json& request) {
  const auto answer = robot_poses_json(request.dump(), library_in_mm());
  EXPECT_FALSE(answer);
  return answer ? "" : answer.error().message;
}

std::vector<double> orientation_of(const Eigen::Matrix3d& rotation, const std::string& convention) {
  const Json answer = answer_to(request_for(pose_of(rotation, {0, 0, 0}), convention));
  std::vector<double> values;
  for (const Json& number : answer["poses"][0][0]["numbers"]) values.push_back(number["value"]);
  return {values.begin() + 3, values.end()};
}

/// By the definitions in the controllers' manuals.
Eigen::Matrix3d rotation_from(const std::vector<double>& n, const std::string& convention) {
  const auto turn = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const double degree = std::numbers::pi / 180;
  if (convention == "quaternion")
    return Eigen::Quaterniond(n[3], n[0], n[1], n[2]).toRotationMatrix();
  if (convention == "abb") return Eigen::Quaterniond(n[0], n[1], n[2], n[3]).toRotationMatrix();
  if (convention == "rpy") return turn(n[2], z) * turn(n[1], y) * turn(n[0], x);
  if (convention == "kuka")
    return turn(degree * n[0], z) * turn(degree * n[1], y) * turn(degree * n[2], x);
  if (convention == "fanuc")
    return turn(degree * n[2], z) * turn(degree * n[1], y) * turn(degree * n[0], x);
  const Eigen::Vector3d vector(n[0], n[1], n[2]);
  return vector.norm() > 0 ? turn(vector.norm(), vector.normalized()) : Eigen::Matrix3d::Identity();
}

/// Rotations whose second angle is ±90 degrees, which leaves the other two undetermined.
std::vector<Eigen::Matrix3d> upright_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  for (const double sign : {1.0, -1.0}) {
    for (const double yaw : {0.0, 0.7, -2.0}) {
      rotations.emplace_back(
          Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(sign * std::numbers::pi / 2, Eigen::Vector3d::UnitY()));
    }
  }
  return rotations;
}

std::vector<Eigen::Matrix3d> rotations() {
  const double pi = std::numbers::pi;
  std::vector<Eigen::Matrix3d> all = upright_rotations();
  for (const Eigen::Vector3d& v :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(pi, 0, 0), Eigen::Vector3d(0, pi, 0),
        Eigen::Vector3d(0, 0, pi), Eigen::Vector3d(0.3, -1.2, 2.5), Eigen::Vector3d(-2, 1.5, -1),
        Eigen::Vector3d(1.8, 1.8, 1.7)})
    all.push_back(rotation_from({v.x(), v.y(), v.z()}, "ur"));
  return all;
}

TEST(RobotPosesJson, TurnBackIntoTheRotation) {
  for (const Choice& convention : choices_of<RobotConvention>()) {
    const std::string name(convention.name);
    for (const Eigen::Matrix3d& rotation : rotations()) {
      const Eigen::Matrix3d back = rotation_from(orientation_of(rotation, name), name);
      EXPECT_LT((back - rotation).cwiseAbs().maxCoeff(), 1e-6) << name << '\n' << rotation;
    }
  }
}

TEST(RobotPosesJson, SettlesWhatAConventionLeavesOpen) {
  for (const Eigen::Matrix3d& rotation : rotations()) {
    EXPECT_GE(orientation_of(rotation, "quaternion")[3], 0);
    EXPECT_GE(orientation_of(rotation, "abb")[0], 0);
  }
  EXPECT_EQ(orientation_of(Eigen::Matrix3d::Identity(), "ur"), (std::vector<double>{0, 0, 0}));
}

TEST(RobotPosesJson, AreInTheFrameOfTheRobotForEachGrasp) {
  const Eigen::Matrix3d quarter(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  Json request = request_for(pose_of(Eigen::Matrix3d::Identity(), {0.1, 0.2, 0.3}), "kuka");
  request["frame"] = {{"name", "cell"},
                      {"T_robot_scene", matrix_json(pose_of(quarter, {1, 0, 0}))}};
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  request["grasps"]["cup"] = {{"top", matrix_json(pose_of(same, {0, 0, 50}))},
                              {"rim", matrix_json(pose_of(same, {20, 0, 0}))}};
  request["grasps"]["plate"] = {{"top", matrix_json(pose_of(same, {0, 0, 5000}))}};
  const Json answer = answer_to(request);
  EXPECT_EQ(answer["frame"], "cell");
  ASSERT_EQ(answer["poses"][0].size(), 2U);
  EXPECT_EQ(answer["poses"][0][0]["grasp"], "rim");
  const Json& a = answer["poses"][0][0]["numbers"][3];
  EXPECT_EQ(a["name"], "A");
  EXPECT_EQ(a["unit"], "deg");
  EXPECT_NEAR(a["value"].get<double>(), 90, 1e-5);
  EXPECT_EQ(answer["table"],
            "scene,model,grasp,score,pose_score,ambiguous,x [mm],y [mm],z [mm],A,B,C,frame\n"
            "\"a, b.ply\",cup,rim,0.75,0.375,1,800,120,300,90,0,0,cell\n"
            "\"a, b.ply\",cup,top,0.75,0.375,1,800,100,350,90,0,0,cell\n");
  EXPECT_TRUE(answer["doubts"].empty()) << answer["doubts"];
}

TEST(RobotPosesJson, DoubtLengthsThatSuggestAnotherUnit) {
  Json request = request_for(FilePose::Identity(), "abb");
  EXPECT_EQ(answer_to(request)["frame"], "scene");
  const auto at = [](double x) {
    return matrix_json(pose_of(Eigen::Matrix3d::Identity(), {x, 0, 0}));
  };
  request["frame"] = {{"name", "robot"}, {"T_robot_scene", at(500)}};
  request["grasps"]["cup"] = {{"rim", at(0.02)}};
  EXPECT_EQ(answer_to(request)["doubts"],
            Json::parse(R"([{"about": "frame", "length": 500.0, "unit": "m", "likelier": "mm"},
                            {"about": "grasps", "length": 0.02, "unit": "mm", "likelier": "m",
                             "model": "cup"}])"));
  const auto frame_unit = [](double x, LengthUnit unit) {
    return likelier_frame_unit(pose_of(Eigen::Matrix3d::Identity(), {x, 0, 0}), unit);
  };
  const LengthUnit m = LengthUnit::meter, mm = LengthUnit::millimeter;
  for (const double x : {0.9, 9.9}) EXPECT_EQ(frame_unit(x, mm), m) << x;
  for (const double x : {0.0, 10.1, 900.0}) EXPECT_EQ(frame_unit(x, mm), std::nullopt) << x;
  for (const double x : {51.0, 900.0}) EXPECT_EQ(frame_unit(x, m), mm) << x;
  for (const double x : {0.0, 0.9, 49.0}) EXPECT_EQ(frame_unit(x, m), std::nullopt) << x;
  EXPECT_EQ(likelier_grasp_unit(0.02, 100, mm), m);
  EXPECT_EQ(likelier_grasp_unit(2, 100, mm), std::nullopt);
  EXPECT_EQ(likelier_grasp_unit(20, 0.1, m), mm);
  EXPECT_EQ(likelier_grasp_unit(0.3, 0.01, m), std::nullopt);
}

TEST(RobotPosesJson, AreRefusedWithThePlaceOfTheFault) {
  const auto expect_refused = [](const std::string& member, const Json& value,
                                 const std::string& words) {
    Json request = request_for(FilePose::Identity(), "ur");
    request[member] = value;
    const std::string refusal = refusal_of(request);
    EXPECT_NE(refusal.find(words), std::string::npos) << refusal;
  };
  const Json identity = matrix_json(FilePose::Identity());
  expect_refused("convention", "plc", "convention: expected one of quaternion, rpy");
  expect_refused("unit", "inch", "unit: expected the unit");
  expect_refused("frame", {{"name", "scene"}, {"T_robot_scene", identity}}, "frame.name: expected");
  expect_refused("frame", {{"name", "robot"}, {"T_robot_scene", {{2, 0, 0, 0}}}},
                 "frame.T_robot_scene: expected 4 x 4");
  expect_refused("grasps", Json::parse(R"({"cup": {"rim": 7}})"),
                 R"(grasps["cup"]["rim"]: expected)");
  expect_refused("detections", Json::parse("[{}]"), "detections[0]: expected \"score\"");
}

}  // namespace
}  // namespace trivet::apps::service
