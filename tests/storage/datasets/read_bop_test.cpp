#include "storage/datasets/read_bop.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "storage/datasets/write_bop.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

Pose tilted() {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisf(2, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() << 0.1F, -20, 812.5F;
  return pose;
}

/// A data set with two objects, and two scenes of which the first has two images.
class ReadBop : public testing::Test {
 protected:
  ReadBop() {
    fs::create_directories(root() / "models");
    fs::create_directories(root() / "models_eval");
    EXPECT_TRUE(write_bop_models_info(root() / "models/models_info.json", objects_));
    dir_.write("set/models_eval/obj_000012.ply", "");
    scenes_ = {{1, {image(3, {{12, 0.75}, {2, 0.05}}), image(20, {{2, 1}})}},
               {45, {image(0, {{12, 0.1}, {12, 0.4}})}}};
    write_split("test");
  }

  static BopImage image(int id, const std::vector<std::pair<int, double>>& visible) {
    BopImage image{id, {500, 501, 319.5, 239.5 + id, 0.1}, {}};
    for (const auto& [object_id, visib_fract] : visible)
      image.instances.push_back({object_id, tilted(), {}, {}, 100, 100, 50, visib_fract});
    return image;
  }
  void write_split(const std::string& name) {
    for (const BopScene& scene : scenes_) {
      const fs::path folder = bop_scene_folder(root() / name, scene.id);
      ASSERT_TRUE(write_bop_scene(folder, scene.images));
      fs::create_directories(folder / "depth");
      for (const BopImage& image : scene.images)
        write(bop_depth_file(folder, image.id), "looked at when it is read");
    }
  }
  static void write(const fs::path& file, const std::string& text) {
    fs::remove(file);  // some file systems flush an overwritten file
    std::ofstream(file, std::ios::binary) << text;
  }
  void expect_refused(const fs::path& folder, ErrorCode code,
                      const std::vector<std::string>& texts) const {
    const Result<Manifest> manifest = read_bop(folder);
    ASSERT_FALSE(manifest);
    EXPECT_EQ(manifest.error().code, code) << manifest.error().message;
    for (const std::string& text : texts)
      EXPECT_NE(manifest.error().message.find(text), std::string::npos) << manifest.error().message;
  }
  /// Replaces a file with this text and expects the reader to refuse the data set because of it.
  void expect_refused(const std::string& name, const std::string& text, const std::string& why) {
    const fs::path file = root() / name;
    const std::string before = fs::exists(file) ? test::read_bytes(file) : "";
    write(file, text);
    expect_refused(root(), ErrorCode::bad_data, {file.string(), why});
    before.empty() ? (void)fs::remove(file) : write(file, before);
  }
  fs::path root() const { return dir_ / "set"; }

  const std::vector<BopObject> objects_{
      {2, 50, {-1, -2, -3}, {2, 4, 6}, {{}, {}, true}},
      {12, 99.5, {0, 0, 0}, {1, 2, 3}, {{tilted()}, Symmetry::Axis{}, true}}};
  std::vector<BopScene> scenes_;
  test::TempDir dir_;
};

TEST_F(ReadBop, GivesTheModels) {
  const Result<Manifest> manifest = read_bop_models(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->unit, LengthUnit::millimeter);
  EXPECT_TRUE(manifest->scenes.empty());
  ASSERT_EQ(manifest->models.size(), 2U);
  const ManifestModel &first = manifest->models[0], &second = manifest->models[1];
  EXPECT_EQ(first.name, "obj_000002");
  EXPECT_EQ(first.object_id, 2);
  EXPECT_EQ(first.file, root() / "models/obj_000002.ply");
  EXPECT_EQ(first.scale, 1);
  EXPECT_TRUE(first.eval_file.empty());
  EXPECT_FALSE(first.symmetry);
  EXPECT_EQ(second.name, "obj_000012") << "by number, not by the order of the keys";
  EXPECT_EQ(second.eval_file, root() / "models_eval/obj_000012.ply");
  ASSERT_TRUE(second.symmetry && second.symmetry->axis);
  EXPECT_TRUE(second.symmetry->declared);
  ASSERT_EQ(second.symmetry->poses.size(), 1U);
  // The reader orthonormalizes rotations, which changes the last bits.
  EXPECT_TRUE(second.symmetry->poses[0].isApprox(tilted(), 1e-6F));
}

TEST_F(ReadBop, GivesWhatWasWritten) {
  const Result<std::vector<BopObject>> objects =
      read_bop_models_info(root() / "models/models_info.json");
  ASSERT_TRUE(objects) << objects.error().message;
  ASSERT_EQ(objects->size(), 2U);
  EXPECT_EQ((*objects)[1].diameter_mm, 99.5);
  EXPECT_EQ((*objects)[0].min_mm, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ((*objects)[0].size_mm, Eigen::Vector3d(2, 4, 6));

  const Result<Manifest> manifest = read_bop(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->models.size(), 2U);
  ASSERT_EQ(manifest->scenes.size(), 3U);
  const ManifestScene& scene = manifest->scenes[1];
  EXPECT_EQ(manifest->scenes[0].image_id, 3);
  EXPECT_EQ(scene.scene_id, 1);
  EXPECT_EQ(scene.image_id, 20);
  EXPECT_EQ(manifest->scenes[2].scene_id, 45);
  EXPECT_EQ(scene.name, "test/000001/depth/000020.png");
  EXPECT_EQ(scene.file, root() / scene.name);
  EXPECT_EQ(scene.camera, (Camera{500, 501, 319.5, 259.5, 0.1}));
  EXPECT_FALSE(scene.viewpoint || scene.closed_surface);
  EXPECT_TRUE(scene.targets.empty());
}

TEST_F(ReadBop, IgnoresTruthOfWhichTooLittleIsVisible) {
  const Result<Manifest> manifest = read_bop(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  const std::vector<TruthInstance>& truth = manifest->scenes[0].truth;
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth[0].model, "obj_000012");
  EXPECT_TRUE(truth[0].T_scene_model.isApprox(tilted(), 1e-6F));
  EXPECT_EQ(truth[0].T_scene_model.translation(), tilted().translation());
  EXPECT_EQ(truth[0].visible_fraction, 0.75);
  EXPECT_FALSE(truth[0].occlusion) << "that is a share of the area, not of the silhouette";
  EXPECT_FALSE(truth[0].ignore);
  EXPECT_EQ(truth[1].visible_fraction, 0.05);
  EXPECT_TRUE(truth[1].ignore);
  EXPECT_FALSE(manifest->scenes[2].truth[0].ignore) << "just a tenth";
}

TEST_F(ReadBop, AcceptsTestSetsWithoutTruth) {
  for (const char* name : {"scene_gt_info.json", "scene_gt.json"}) {
    fs::remove(root() / "test/000001" / name);
    const Result<Manifest> manifest = read_bop(root());
    ASSERT_TRUE(manifest) << manifest.error().message;
    ASSERT_EQ(manifest->scenes.size(), 3U);
    const bool info_only = std::string(name) == "scene_gt_info.json";
    EXPECT_EQ(manifest->scenes[0].truth.size(), info_only ? 2U : 0U);
    for (const TruthInstance& truth : manifest->scenes[0].truth)
      EXPECT_FALSE(truth.ignore || truth.visible_fraction);
    EXPECT_EQ(manifest->scenes[2].truth.size(), 2U) << "the other scene has its truth";
  }
}

TEST_F(ReadBop, ReadsTheImagesAndCountsOfTheTargets) {
  write_split("val");
  scenes_[0].images.pop_back();
  ASSERT_TRUE(write_bop_targets(root(), scenes_));
  Result<Manifest> manifest = read_bop(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  ASSERT_EQ(manifest->scenes.size(), 2U);
  EXPECT_EQ(manifest->scenes[0].image_id, 3);
  ASSERT_EQ(manifest->scenes[0].targets.size(), 1U) << "the other one is hardly visible";
  EXPECT_EQ(manifest->scenes[0].targets[0].model, "obj_000012");
  EXPECT_EQ(manifest->scenes[0].targets[0].num_instances, 1U);
  EXPECT_EQ(manifest->scenes[0].truth.size(), 2U);
  EXPECT_EQ(manifest->scenes[1].targets[0].num_instances, 2U);

  fs::remove(root() / "test_targets_bop19.json");
  manifest = read_bop(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->scenes.size(), 2U);
  EXPECT_TRUE(manifest->scenes[0].targets.empty());

  manifest = read_bop(root() / "val");
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->scenes.size(), 3U) << "the targets are those of the test images";
}

TEST_F(ReadBop, AcceptsTheFolderOfASplit) {
  fs::rename(root() / "test", root() / "test_primesense");
  const auto name_of = [&](const fs::path& folder) {
    const Result<Manifest> manifest = read_bop(folder);
    return manifest ? manifest->scenes.at(0).name : manifest.error().message;
  };
  EXPECT_EQ(name_of(root()), "test_primesense/000001/depth/000003.png");
  for (const char* same : {"test_primesense", "test_primesense/", "models/../test_primesense/."})
    EXPECT_EQ(name_of(root() / same), "test_primesense/000001/depth/000003.png") << same;
  write_split("test_kinect");
  EXPECT_EQ(name_of(root() / "test_kinect"), "test_kinect/000001/depth/000003.png");
  expect_refused(root(), ErrorCode::usage, {"test_kinect, test_primesense"});
}

TEST_F(ReadBop, KnowsADataSetByItsModelsInfo) {
  EXPECT_TRUE(is_bop_folder(root()));
  EXPECT_TRUE(is_bop_folder(root() / "test"));
  EXPECT_FALSE(is_bop_folder(root() / "models")) << "a folder of meshes";
  EXPECT_FALSE(is_bop_folder(root() / "test/000001"));
  EXPECT_FALSE(is_bop_folder(dir_.path()));
  EXPECT_FALSE(is_bop_folder(root() / "nowhere"));
  fs::rename(root() / "models", root() / "models_cad");
  EXPECT_TRUE(is_bop_folder(root()));
  const Result<Manifest> manifest = read_bop_models(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->models[0].file, root() / "models_cad/obj_000002.ply");
  expect_refused(dir_.path(), ErrorCode::missing_input, {"models_info.json"});
}

TEST_F(ReadBop, NamesThePathOfWhatIsWrong) {
  const std::string info = "models/models_info.json";
  expect_refused(info, R"({"mug": {}})", "[\"mug\"]: expected a number");
  expect_refused(info, R"({"02": {}})", "[\"02\"]: expected a number");
  expect_refused(info, R"({"2": {"diameter": "big"}})", "[\"2\"].diameter: expected a number");
  expect_refused(info, R"({"2": {"symmetries_discrete": [[1, 0, 0, 0]]}})",
                 "[\"2\"].symmetries_discrete[0]: expected 4 x 4 numbers");
  expect_refused(info,
                 R"({"2": {"symmetries_continuous": [{"axis": [0,0,1]}, {"axis": [0,1,0]}]}})",
                 "[\"2\"].symmetries_continuous: expected at most one axis instead of 2");
  expect_refused(info, R"({"2": {"symmetries_continuous": [{"axis": [0,0,0]}]}})",
                 "symmetries_continuous[0].axis");

  const std::string camera = "test/000001/scene_camera.json";
  expect_refused(camera, R"({"3": {"cam_K": [1, 0, 0]}})", "[\"3\"].cam_K: expected 9 numbers");
  expect_refused(camera, R"({"3": {"cam_K": [0, 0, 0, 0, 1, 0, 0, 0, 1]}})", "above zero");
  expect_refused(camera, R"([])", "expected an object");

  const std::string truth = "test/000001/scene_gt.json";
  const std::string turn = R"("cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 1])";
  expect_refused(truth, R"({"3": [{"obj_id": 3, )" + turn + "}]}",
                 "[\"3\"][0].obj_id: expected an object of models_info.json");
  expect_refused(truth, R"({"3": [{"obj_id": 2.5, )" + turn + "}]}", "expected a whole number");
  expect_refused(truth, R"({"3": [{"obj_id": 1e300, )" + turn + "}]}", "expected a whole number");
  expect_refused(truth, R"({"3": [{"obj_id": 2, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0]}]})",
                 "[\"3\"][0].cam_R_m2c: expected 3 x 3 numbers");
  expect_refused(truth, R"({"3": [{"obj_id": 2, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 2]}]})",
                 "[\"3\"][0].cam_R_m2c: expected a rotation");
  const std::string visible = "test/000001/scene_gt_info.json";
  expect_refused(visible, R"({"3": [{"visib_fract": 1}]})",
                 "[\"3\"]: expected 2 instances as in scene_gt.json instead of 1");
  expect_refused(visible, R"({"3": [{"visib_fract": 1.5}, {"visib_fract": 1}]})",
                 "[\"3\"][0].visib_fract: expected a number from 0 to 1");

  const auto target = [](const std::string& image, const std::string& object) {
    return R"({"scene_id": 1, "im_id": )" + image + R"(, "obj_id": )" + object +
           R"(, "inst_count": 1})";
  };
  const std::string targets = "test_targets_bop19.json";
  expect_refused(targets, "[{}]", "[0]: expected \"scene_id\", found an empty object");
  expect_refused(targets, "[" + target("-1", "2") + "]", "[0].im_id: expected a whole number");
  expect_refused(targets, "[" + target("3", "2") + ", " + target("3", "2") + "]", "[1]: expected");
}

TEST_F(ReadBop, RefusesTargetsThatAreNotThere) {
  const auto with_target = [&](const std::string& ids) {
    dir_.write("set/test_targets_bop19.json", "[{" + ids + R"(, "inst_count": 1}])");
  };
  with_target(R"("scene_id": 1, "im_id": 4, "obj_id": 2)");
  expect_refused(root(), ErrorCode::bad_data, {"000001/scene_camera.json", "expected image 4"});
  with_target(R"("scene_id": 1, "im_id": 3, "obj_id": 3)");
  expect_refused(root(), ErrorCode::bad_data, {"found object 3"});
  with_target(R"("scene_id": 2, "im_id": 3, "obj_id": 2)");
  expect_refused(root(), ErrorCode::missing_input, {"000002/scene_camera.json"});
}

TEST_F(ReadBop, NamesTheDepthImagesThatAreThere) {
  const fs::path depth = root() / "test/000001/depth";
  fs::rename(depth / "000020.png", depth / "000020.tif");
  const Result<Manifest> manifest = read_bop(root());
  ASSERT_TRUE(manifest) << manifest.error().message;
  EXPECT_EQ(manifest->scenes[1].file, depth / "000020.tif");
  EXPECT_EQ(manifest->scenes[1].name, "test/000001/depth/000020.tif");
  fs::remove(depth / "000020.tif");
  expect_refused(root(), ErrorCode::missing_input, {"depth/000020.png"});
  fs::rename(root() / "test", root() / "val");
  expect_refused(root(), ErrorCode::missing_input, {"expected a folder of test images"});
}

/// A data set whose scenes have the cameras "rgb" (no depth) and "near", and "far" on request.
class ReadBopOfCameras : public ReadBop {
 protected:
  void name_cameras(bool with_far) const {
    for (const char* scene : {"000001", "000045"}) {
      const fs::path folder = root() / "test" / scene;
      for (const char* what : {"scene_camera", "scene_gt", "scene_gt_info"}) {
        const std::string text = test::read_bytes(folder / (std::string(what) + ".json"));
        write(folder / (std::string(what) + "_near.json"), text);
        if (with_far) write(folder / (std::string(what) + "_far.json"), text);
        fs::remove(folder / (std::string(what) + ".json"));
      }
      write(folder / "scene_camera_rgb.json", "{}");
      if (with_far) fs::copy(folder / "depth", folder / "depth_far");
      fs::rename(folder / "depth", folder / "depth_near");
    }
  }
};

TEST_F(ReadBopOfCameras, ChoosesTheOneThatHasDepth) {
  const Result<Manifest> before = read_bop(root());
  name_cameras(false);
  const Result<Manifest> manifest = read_bop(root());
  ASSERT_TRUE(before && manifest) << manifest.error().message;
  ASSERT_EQ(manifest->scenes.size(), before->scenes.size());
  for (std::size_t i = 0; i < before->scenes.size(); ++i) {
    const ManifestScene &was = before->scenes[i], &is = manifest->scenes[i];
    EXPECT_EQ(is.file.parent_path().filename(), "depth_near");
    EXPECT_EQ(is.file.filename(), was.file.filename());
    EXPECT_EQ(is.camera, was.camera);
    EXPECT_EQ(is.scene_id, was.scene_id);
    ASSERT_EQ(is.truth.size(), was.truth.size());
    EXPECT_EQ(is.truth[0].visible_fraction, was.truth[0].visible_fraction);
  }
}

TEST_F(ReadBopOfCameras, AsksForOneOfSeveral) {
  name_cameras(true);
  EXPECT_TRUE(is_bop_folder(root()));
  expect_refused(root(), ErrorCode::usage, {"far, near", "test:far"});
  for (const char* argument : {"set:far", "set/test:far"}) {
    EXPECT_TRUE(is_bop_folder(dir_ / argument));
    const Result<Manifest> manifest = read_bop(dir_ / argument);
    ASSERT_TRUE(manifest) << manifest.error().message;
    EXPECT_EQ(manifest->scenes[0].name, "test/000001/depth_far/000003.png");
  }
  expect_refused(dir_ / "set:side", ErrorCode::missing_input, {"side", "far, near, rgb"});
  EXPECT_FALSE(is_bop_folder(dir_ / "none:far"));
}

TEST_F(ReadBopOfCameras, RefusesThoseWithoutDepth) {
  name_cameras(false);
  fs::remove_all(root() / "test/000001/depth_near");
  expect_refused(root(), ErrorCode::missing_input, {"depth images", "near, rgb"});
}

TEST_F(ReadBop, SurvivesTruncation) {
  ASSERT_TRUE(write_bop_targets(root(), scenes_));
  for (const char* name :
       {"models/models_info.json", "test/000001/scene_camera.json", "test/000001/scene_gt.json",
        "test/000001/scene_gt_info.json", "test_targets_bop19.json", "test_targets_bop24.json"}) {
    const std::string whole = test::read_bytes(root() / name);
    for (std::size_t size = 0; size + 2 < whole.size(); size += 17) {
      write(root() / name, whole.substr(0, size));
      ASSERT_FALSE(read_bop(root())) << name << " of " << size << " bytes";
    }
    write(root() / name, whole);
    ASSERT_TRUE(read_bop(root()));
  }
}

}  // namespace
}  // namespace trivet
