#include "storage/datasets/manifest.hpp"

#include <gtest/gtest.h>

#include "support/temp_dir.hpp"

namespace trivet {
namespace {

const std::string kIdentity = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
const std::string kHalfTurn = "[[-1,0,0,2],[0,-1,0,4],[0,0,1,6],[0,0,0,1]]";

class ReadManifest : public testing::Test {
 protected:
  Result<Manifest> read(const std::string& json) {
    return read_manifest(folder_.write("manifest.json", json));
  }
  void expect_refused(const std::string& json, const std::string& text) {
    const auto manifest = read(json);
    ASSERT_FALSE(manifest) << json;
    EXPECT_EQ(manifest.error().code, ErrorCode::bad_data);
    EXPECT_NE(manifest.error().message.find(text), std::string::npos) << manifest.error().message;
    EXPECT_NE(manifest.error().message.find("manifest.json"), std::string::npos);
  }
  test::TempDir folder_;
};

TEST_F(ReadManifest, ReadsModelsInTheOrderOfTheFile) {
  const auto manifest = read(R"({"unit": "mm", "models": {
      "zebra": {"file": "a/zebra.ply", "scale": 0.5},
      "ant": {"file": "/somewhere/ant.stl", "symmetries": [)" +
                             kIdentity + "," + kHalfTurn + R"(]},
      "mug": {"file": "mug.obj", "symmetries": [], "symmetry_axis": {"axis": [0, 0, 2], "offset": [1, 2, 3]}},
      "box": {"file": "box.off", "symmetries": [], "symmetry_axis": null}},
      "models_scored": ["ant"], "scenes": []})");
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->unit, LengthUnit::millimeter);
  EXPECT_EQ(manifest->models_scored, std::vector<std::string>{"ant"});
  const auto& models = manifest->models;
  ASSERT_EQ(models.size(), 4U);
  EXPECT_EQ(models[0].name, "zebra");
  EXPECT_EQ(models[0].file, folder_ / "a/zebra.ply");
  EXPECT_EQ(models[0].scale, 0.5);
  EXPECT_FALSE(models[0].symmetry);

  EXPECT_EQ(models[1].file, "/somewhere/ant.stl");
  ASSERT_TRUE(models[1].symmetry);
  EXPECT_TRUE(models[1].symmetry->declared);
  ASSERT_EQ(models[1].symmetry->poses.size(), 1U) << "the identity is not listed";
  EXPECT_EQ(models[1].symmetry->poses[0].translation(), Eigen::Vector3f(2, 4, 6));

  ASSERT_TRUE(models[2].symmetry && models[2].symmetry->axis);
  EXPECT_EQ(models[2].symmetry->axis->direction, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(models[2].symmetry->axis->point, Eigen::Vector3f(1, 2, 3));
  EXPECT_FALSE(models[3].symmetry);
}

TEST_F(ReadManifest, ReadsScenesWithCamerasViewpointsAndTruth) {
  const auto manifest = read(R"({"unit": "m", "scenes": [
      {"file": "s/depth.png", "camera": {"fx": 500, "fy": 400, "cx": 3, "cy": 2, "depth_scale": 0.001}, "viewpoint": null,
       "truth": [{"model": "ant", "T_scene_model": )" +
                             kHalfTurn + R"(, "occlusion": 0.25, "ignore": true}]},
      {"file": "a.pcd", "camera": null, "viewpoint": [1, 2, 3], "truth": [{"model": "ant", "T_scene_model": )" +
                             kIdentity + R"(, "occlusion": null}]},
      {"file": "b.ply", "camera": null, "viewpoint": null}]})");
  ASSERT_TRUE(manifest) << manifest.error().message;
  const auto& scenes = manifest->scenes;
  ASSERT_EQ(scenes.size(), 3U);
  EXPECT_EQ(scenes[0].name, "s/depth.png");
  EXPECT_EQ(scenes[0].file, folder_ / "s/depth.png");
  EXPECT_EQ(scenes[0].camera, (Camera{500, 400, 3, 2, 0.001}));
  EXPECT_FALSE(scenes[0].closed_surface || scenes[1].closed_surface);
  ASSERT_EQ(scenes[0].truth.size(), 1U);
  EXPECT_EQ(scenes[0].truth[0].model, "ant");
  EXPECT_EQ(scenes[0].truth[0].occlusion, 0.25);
  EXPECT_TRUE(scenes[0].truth[0].ignore);
  EXPECT_EQ(scenes[1].viewpoint, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(scenes[1].truth[0].occlusion || scenes[1].truth[0].ignore);
  EXPECT_TRUE(scenes[2].closed_surface);
  EXPECT_TRUE(scenes[2].truth.empty());
}

TEST_F(ReadManifest, MakesMeasuredRotationsTrueOnes) {
  const auto manifest =
      read(R"({"unit": "m", "scenes": [{"file": "a", "truth": [{"model": "a", "T_scene_model":
      [[1.004, 0.003, 0, 1], [0, 0.998, 0, 2], [0.001, 0, 1.002, 3], [0, 0, 0, 1]]}]}]})");
  ASSERT_TRUE(manifest) << manifest.error().message;
  const auto pose = manifest->scenes[0].truth[0].T_scene_model;
  // The bound is the float rounding of nine products.
  EXPECT_LT((pose.linear() * pose.linear().transpose() - Eigen::Matrix3f::Identity()).norm(),
            1e-6F);
  EXPECT_LT((pose.linear() - Eigen::Matrix3f::Identity()).norm(), 0.01F);
  EXPECT_EQ(pose.translation(), Eigen::Vector3f(1, 2, 3));
}

TEST_F(ReadManifest, NamesThePathOfWhatIsWrong) {
  const auto model = [](const std::string& body) {
    return R"({"unit": "m", "models": {"ant": {"file": "a", )" + body + "}}}";
  };
  const auto truth = [](const std::string& pose) {
    return R"({"unit": "m", "scenes": [{"file": "a"}, {"file": "b", "truth": [{"model": "ant", "T_scene_model": )" +
           pose + "}]}]}";
  };
  expect_refused(R"({"models": {}})", "\"unit\"");
  expect_refused(R"({"unit": "inch"})", "unit: expected the unit");
  expect_refused(R"({"unit": "m", "models": []})", "models: expected an object");
  expect_refused(R"({"unit": "m", "models": {"ant": {}}})", "models.ant: expected \"file\", found");
  expect_refused(R"({"unit": "m", "models": {"../ant": {"file": "a"}}})", "expected a name");
  expect_refused(R"({"unit": "m", "models": {"ant": {"file": "a"}, "ant": {"file": "b"}}})",
                 "twice");
  expect_refused(model(R"("scale": 0)"), "models.ant.scale");
  expect_refused(model(R"("scale": "1")"), "models.ant.scale: expected a number, found \"1\"");
  expect_refused(model(R"("symmetries": {})"), "models.ant.symmetries: expected an array");
  expect_refused(model(R"("symmetries": [)" + kHalfTurn + R"(, [[1, 0], [0, 1]]])"),
                 "models.ant.symmetries[1]: expected 4 x 4 numbers");
  expect_refused(model(R"("symmetry_axis": {"axis": [0, 0, 0], "offset": [0, 0, 0]})"),
                 "models.ant.symmetry_axis.axis");
  expect_refused(truth("[[1,0,0,0],[0,1,0,0],[0,0,1.1,0],[0,0,0,1]]"),
                 "scenes[1].truth[0].T_scene_model: expected a rotation");
  expect_refused(truth("[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]"), "expected a rotation");
  expect_refused(truth("[[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,1]]"), "expected a rotation");
  expect_refused(truth("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]]"), "last row");
  expect_refused(truth("[[1,0,0,1e300],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), "at most 1e10");
  expect_refused(truth("[[1,0,0,null],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"),
                 "T_scene_model[0][3]: expected a number");
  expect_refused(R"({"unit": "m", "scenes": [{"file": "a", "camera": {"fx": 1}}]})",
                 "scenes[0].camera");
  expect_refused(R"({"unit": "m", "scenes": [{"file": "a", "viewpoint": [1, 2]}]})",
                 "scenes[0].viewpoint: expected 3 numbers");
  expect_refused(R"({"unit": "m", "scenes": )" + std::string(40, '['), "deeper");
  expect_refused("{\"unit\": \"m\xFF\"}", "byte");
  EXPECT_EQ(read_manifest(folder_ / "none.json").error().code, ErrorCode::missing_input);
}

TEST_F(ReadManifest, RefusesUnknownNamesAndSuggestsTheNearest) {
  const auto model = [](const std::string& body) {
    return R"({"unit": "m", "models": {"ant": {"file": "a", )" + body + "}}}";
  };
  const auto truth = [](const std::string& body) {
    return R"({"unit": "m", "scenes": [{"file": "a", "truth": [{"model": "ant", "T_scene_model": )" +
           kIdentity + body + "}]}]}";
  };
  expect_refused(R"({"unit": "m", "modles": {}})",
                 "the document: found 'modles'; did you mean 'models'?");
  expect_refused(model(R"("scal": 1000)"), "models.ant: found 'scal'; did you mean 'scale'?");
  expect_refused(
      model(R"("color": "red")"),
      "models.ant: expected one of file, scale, symmetries, symmetry_axis, found 'color'");
  expect_refused(model(R"("symmetry_axis": {"axis": [0, 0, 1], "ofset": [1, 0, 0]})"),
                 "models.ant.symmetry_axis: found 'ofset'; did you mean 'offset'?");
  expect_refused(R"({"unit": "m", "scenes": [{"file": "a", "view_point": [1, 2, 3]}]})",
                 "scenes[0]: found 'view_point'; did you mean 'viewpoint'?");
  expect_refused(truth(R"(, "ignored": true)"),
                 "scenes[0].truth[0]: found 'ignored'; did you mean 'ignore'?");

  EXPECT_TRUE(read(model(R"("_color": "red")"))) << "a note";
  const auto noted = read(truth(R"(, "origin": "by hand", "median_nn_mm": 0.2, "name": "left")"));
  EXPECT_TRUE(noted) << noted.error().message;
}

TEST_F(ReadManifest, SurvivesTruncationAtEveryByte) {
  const std::string whole =
      R"({"unit": "m", "models": {"ant": {"file": "a", "symmetries": [)" + kHalfTurn +
      R"(]}}, "scenes": [{"file": "a", "truth": [{"model": "ant", "T_scene_model": )" + kIdentity +
      "}]}]}";
  ASSERT_TRUE(read(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(read(whole.substr(0, size)));
}

}  // namespace
}  // namespace trivet
