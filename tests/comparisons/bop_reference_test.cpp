// Compares the program's BOP scores with tests/comparisons/bop_metrics.py, which computes them from
// the definitions alone, on random scenes.
#include <gtest/gtest.h>
#include <stdio.h>

#include <Eigen/Geometry>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/evaluation/bop_scores.hpp"
#include "kernels/scans/render_depth.hpp"
#include "storage/formats/write_png.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;
using nlohmann::json;

constexpr std::uint32_t kWidth = 64, kHeight = 48;

json rows_of(const Pose& pose) {
  json rows = json::array();
  for (int r = 0; r < 4; ++r) {
    rows.push_back(json::array());
    for (int c = 0; c < 4; ++c) rows.back().push_back(static_cast<double>(pose.matrix()(r, c)));
  }
  return rows;
}

json numbers_of(const Vector3f& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

Pose half_turn(const Vector3f& axis) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisf(std::numbers::pi_v<float>, axis).toRotationMatrix();
  return pose;
}

/// Scenes of three models of some 100 mm, 0.6 m in front of the camera, in either unit.
class Case {
 public:
  Case(std::uint64_t number, LengthUnit unit, const test::TempDir& folder)
      : random_(number),
        folder_(folder),
        mm_(static_cast<float>(unit_scale(LengthUnit::millimeter, unit))) {
    manifest.unit = unit;
    add_model(
        "box", test::box({-30, -20, -15}, {30, 20, 15}), 78,
        {{half_turn(Vector3f::UnitX()), half_turn(Vector3f::UnitY()), half_turn(Vector3f::UnitZ())},
         {},
         true});
    test::Shape rod;  // six-sided, declared round
    for (int i = 0; i < 6; ++i) {
      const auto at = [](int side, float z) {
        const float angle = static_cast<float>(side) * std::numbers::pi_v<float> / 3;
        return Vector3f(20 * std::cos(angle) + 5, 20 * std::sin(angle), z);
      };
      rod.add(at(i, -40), at(i + 1, -40), at(i + 1, 40), at(i, 40));
      rod.add(at(i, 40), at(i + 1, 40), {5, 0, 40});
      rod.add(at(i + 1, -40), at(i, -40), {5, 0, -40});
    }
    Symmetry round{{}, Symmetry::Axis{Vector3f::UnitZ(), Vector3f(5, 0, 0)}, true};
    Pose flip = half_turn(Vector3f::UnitX());
    round.poses.push_back(flip);
    add_model("rod", rod, 89, round);
    add_model("wedge", test::tetrahedron(), 85, {}, 30);
    add_model("spare", test::box({-10, -10, -10}, {10, 10, 10}), 35, {});
    if (number % 2 == 1) manifest.models_scored = {"wedge", "box", "rod"};
    for (int i = 0; i < 5; ++i) add_scene(i);
  }

  Manifest manifest;
  std::vector<EvaluationMesh> meshes;
  std::vector<std::optional<SceneResult>> results;
  json document;  // input of bop_metrics.py

 private:
  void add_model(const std::string& name, const test::Shape& shape, double diameter,
                 Symmetry symmetry, float size = 1) {
    EvaluationMesh mesh{name, {}, shape.triangles, diameter * static_cast<double>(mm_), {}};
    Points vertices;
    for (std::size_t i = 0; i < shape.vertices.size(); ++i)
      vertices.push_back(mm_ * size * shape.vertices[i]);
    mesh.vertices = std::move(vertices);
    for (Pose& pose : symmetry.poses) pose.translation() *= mm_;
    if (symmetry.axis) symmetry.axis->point *= mm_;
    mesh.symmetry = symmetry;
    json entry{{"diameter", mesh.diameter},
               {"vertices", json::array()},
               {"triangles", json::array()},
               {"symmetries", json::array()},
               {"axis", nullptr}};
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      entry["vertices"].push_back(numbers_of(mesh.vertices[i]));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      entry["triangles"].push_back({mesh.triangles.a[t], mesh.triangles.b[t], mesh.triangles.c[t]});
    for (const Pose& pose : symmetry.poses) entry["symmetries"].push_back(rows_of(pose));
    if (symmetry.axis) {
      entry["axis"] = {{"direction", numbers_of(symmetry.axis->direction)},
                       {"point", numbers_of(symmetry.axis->point)}};
    }
    document["models"][name] = entry;
    manifest.models.push_back({name, name + ".ply", 1, symmetry});
    meshes.push_back(std::move(mesh));
  }

  Pose random_pose() {
    Pose pose = random_.motion(0);
    pose.translation() = mm_ * Vector3f(random_.uniform(-150, 150), random_.uniform(-100, 100),
                                        random_.uniform(500, 700));
    return pose;
  }

  /// An estimate that is usually near the pose and sometimes changed by a symmetry of the model.
  Pose estimate_of(const Pose& truth, const Symmetry& symmetry) {
    Pose off = Pose::Identity();
    const float size = std::pow(10.0F, random_.uniform(-2, 0.3F));
    off.linear() = Eigen::AngleAxisf(0.3F * size, random_.direction()).toRotationMatrix();
    off.translation() = 15 * size * mm_ * random_.direction();
    Pose pose = truth;
    if (!symmetry.poses.empty() && random_.below(2) == 0)
      pose =
          pose * symmetry.poses[random_.below(static_cast<std::uint32_t>(symmetry.poses.size()))];
    if (symmetry.axis) {
      const Vector3f point = symmetry.axis->point;
      pose = pose * Eigen::Translation3f(point) *
             Eigen::AngleAxisf(random_.uniform(-3, 3), Vector3f(symmetry.axis->direction)) *
             Eigen::Translation3f(-point);
    }
    return pose * off;
  }

  void add_scene(int index) {
    ManifestScene scene;
    scene.name = "scene" + std::to_string(index);
    const std::uint32_t num_truths = 3 + random_.below(5);
    for (std::uint32_t i = 0; i < num_truths; ++i) {
      TruthInstance truth;
      truth.model = meshes[random_.below(3)].name;
      truth.T_scene_model = random_pose();
      if (random_.below(4) > 0) {
        const std::array<double, 5> shares{0.05, 0.1, 0.4, 0.4, 0.9};
        truth.visible_fraction = shares[random_.below(5)];
      } else {
        truth.ignore = random_.below(3) == 0;
      }
      scene.truth.push_back(truth);
    }
    if (index == 1) scene.targets = {{"box", 1}, {"wedge", 9}};
    json entry{{"camera", nullptr},
               {"depth", nullptr},
               {"targets", nullptr},
               {"truth", json::array()},
               {"detections", json::array()}};
    for (const SceneTarget& target : scene.targets)
      entry["targets"][target.model] = target.num_instances;
    if (index == 2) {
      scene.file = folder_ / "cloud.ply";  // no image: never read
    } else {
      add_depth(scene, entry);
    }

    for (const TruthInstance& truth : scene.truth) {
      json instance{{"model", truth.model},
                    {"pose", rows_of(truth.T_scene_model)},
                    {"ignore", truth.ignore},
                    {"visible_fraction", nullptr}};
      if (truth.visible_fraction) instance["visible_fraction"] = *truth.visible_fraction;
      entry["truth"].push_back(instance);
    }
    if (index == 3) {
      results.emplace_back();
    } else {
      results.push_back(detect(scene, index == 4 ? 140 : 0));
      for (const Detection& detection : results.back()->detections) {
        entry["detections"].push_back({{"model", detection.model},
                                       {"score", static_cast<double>(detection.score)},
                                       {"pose", rows_of(detection.T_scene_model)}});
      }
    }
    document["scenes"].push_back(entry);
    manifest.scenes.push_back(scene);
  }

  /// Depths of the truths in front of a wall, with gaps.
  void add_depth(ManifestScene& scene, json& entry) {
    scene.camera = Camera{70, 68, 30.3, 24.8, 0.1 * static_cast<double>(mm_)};
    scene.file = folder_ / (scene.name + ".png");
    std::vector<kernels::RayScene> shapes;
    for (const EvaluationMesh& mesh : meshes)
      shapes.push_back(*kernels::RayScene::from_mesh(mesh.vertices, mesh.triangles));
    std::vector<kernels::RayScene::Instance> instances;
    for (const TruthInstance& truth : scene.truth) {
      const auto mesh = std::ranges::find(meshes, truth.model, &EvaluationMesh::name);
      instances.push_back(
          {&shapes[static_cast<std::size_t>(mesh - meshes.begin())], truth.T_scene_model});
    }
    const auto rays = kernels::RayScene::from_instances(instances);
    std::vector<float> depth(kWidth * kHeight);
    std::vector<std::uint32_t> hit(depth.size());
    kernels::render_depth(*rays, *scene.camera, kWidth, 0, {depth, hit});
    std::vector<std::uint16_t> raw(depth.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const float z = depth[i] > 0 ? depth[i] / mm_ : random_.uniform(400, 900);
      if (random_.below(10) > 0) raw[i] = static_cast<std::uint16_t>(10 * (z + random_.normal(2)));
      entry["depth"].push_back(raw[i] * scene.camera->depth_scale);
    }
    ASSERT_TRUE(write_depth_png(scene.file, raw, kWidth));
    entry["width"] = kWidth;
    entry["height"] = kHeight;
    entry["camera"] = {{"fx", scene.camera->fx},
                       {"fy", scene.camera->fy},
                       {"cx", scene.camera->cx},
                       {"cy", scene.camera->cy}};
  }

  SceneResult detect(const ManifestScene& scene, int num_false) {
    SceneResult result;
    const auto add = [&](const std::string& model, const Pose& pose) {
      Detection detection;
      detection.model = model;
      detection.score = static_cast<float>(random_.below(12)) / 12;  // with ties
      detection.T_scene_model = pose;
      result.detections.push_back(detection);
    };
    for (const TruthInstance& truth : scene.truth) {
      const auto mesh = std::ranges::find(meshes, truth.model, &EvaluationMesh::name);
      for (std::uint32_t n = random_.below(4); n > 0; --n)
        add(truth.model, estimate_of(truth.T_scene_model, mesh->symmetry));
    }
    for (int i = 0; i < 4 + num_false; ++i) add(meshes[random_.below(4)].name, random_pose());
    return result;
  }

  test::Random random_;
  const test::TempDir& folder_;
  float mm_;  // in the manifest's unit
};

json run_reference(const json& document, const test::TempDir& folder) {
  const auto file = folder.write("case.json", document.dump());
  const std::string command = std::string(TRIVET_PYTHON) +
                              " " TRIVET_TEST_REFERENCE "/bop_metrics.py " + file.string() +
                              " 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot run " + command);
  std::string output;
  std::array<char, 4096> block;
  while (const std::size_t n = ::fread(block.data(), 1, block.size(), pipe))
    output.append(block.data(), n);
  if (::pclose(pipe) != 0) {
    throw std::runtime_error(command + " failed (Debian: python3 python3-numpy): " + output);
  }
  return json::parse(output);
}

void expect_near(const std::optional<double>& ours, const json& reference, double tolerance,
                 const char* what) {
  ASSERT_EQ(ours.has_value(), !reference.is_null()) << what;
  if (!ours) return;
  EXPECT_NEAR(*ours, reference.get<double>(), tolerance) << what;
}

class BopReference : public testing::TestWithParam<int> {};

// All scores use the same double arithmetic, except for VSD: Trivet casts rays in float. The
// reference reports the pixels that such rounding can change, and by how much the error may change.
TEST_P(BopReference, AgreesOnRandomScenes) {
  const test::TempDir folder;
  const auto number = static_cast<std::uint64_t>(GetParam());
  Case c(number, number < 2 ? LengthUnit::millimeter : LengthUnit::meter, folder);
  if (number == 2)
    c.meshes[0].triangles = {}, c.document["models"]["box"]["triangles"] = json::array();
  c.document["unit_mm"] = unit_scale(c.manifest.unit, LengthUnit::millimeter);
  c.document["delta_mm"] = 15;
  for (const ManifestModel& model : c.manifest.models) c.document["scored"].push_back(model.name);
  if (!c.manifest.models_scored.empty()) c.document["scored"] = c.manifest.models_scored;

  const Result<BopScores> ours = bop_scores(c.manifest, c.meshes, c.results);
  ASSERT_TRUE(ours) << ours.error().message;
  const json expected = run_reference(c.document, folder);

  const json& recall = expected["localization"];
  EXPECT_EQ(ours->localization.num_targets, recall["num_targets"].get<std::size_t>());
  EXPECT_GT(ours->localization.num_targets, 8U);
  expect_near(ours->localization.mssd, recall["mssd"], 1e-12, "AR MSSD");
  expect_near(ours->localization.mspd, recall["mspd"], 1e-12, "AR MSPD");
  const double slack = recall["vsd_slack"].get<double>();
  EXPECT_LT(slack, 0.02);
  expect_near(ours->localization.vsd, recall["vsd"], slack + 1e-12, "AR VSD");
  const json& precision = expected["detection"];
  EXPECT_EQ(ours->detection.num_absent, precision["num_absent"].get<std::size_t>());
  expect_near(ours->detection.mssd, precision["mssd"], 1e-12, "AP MSSD");
  expect_near(ours->detection.mspd, precision["mspd"], 1e-12, "AP MSPD");
  expect_near(ours->detection.mssd_mm, precision["mssd_mm"], 1e-12, "AP MSSD in mm");

  std::size_t num_exact = 0, num_compared = 0;
  for (std::size_t s = 0; s < c.results.size(); ++s) {
    ASSERT_EQ(ours->errors[s].size(), expected["errors"][s].size());
    for (std::size_t d = 0; d < ours->errors[s].size(); ++d) {
      SCOPED_TRACE(testing::Message() << "scene " << s << ", detection " << d);
      const json& reference = expected["errors"][s][d];
      if (c.results[s]->detections[d].model == "spare") {
        EXPECT_FALSE(ours->errors[s][d]);
        continue;
      }
      ASSERT_EQ(ours->errors[s][d].has_value(), !reference.is_null());
      if (reference.is_null()) continue;
      const BopErrors& error = *ours->errors[s][d];
      EXPECT_EQ(error.truth, reference["truth"].get<std::size_t>());
      expect_near(error.mssd, reference["mssd"], 1e-9 * error.mssd, "MSSD");
      expect_near(error.mspd, reference["mspd"], 1e-9 * error.mspd.value_or(0), "MSPD");
      ASSERT_EQ(error.vsd.has_value(), !reference["vsd"].is_null());
      if (!error.vsd) continue;
      for (std::size_t k = 0; k < kBopShares.size(); ++k) {
        const double doubt = reference["vsd_slack"][k].get<double>();
        expect_near((*error.vsd)[k], reference["vsd"][k], doubt + 1e-12, "VSD");
        num_exact += doubt == 0 ? 1 : 0;
        ++num_compared;
      }
    }
  }
  EXPECT_GT(num_compared, 200U);
  EXPECT_GT(num_exact, num_compared * 3 / 4) << "otherwise the comparison shows little";
}

INSTANTIATE_TEST_SUITE_P(Cases, BopReference, testing::Range(0, 4));

}  // namespace
}  // namespace trivet
