#include "storage/datasets/write_bop.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using nlohmann::json;

Pose quarter_turn() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() << 10, -20.5F, 800;
  return pose;
}

BopInstance instance(int object_id, double visib_fract) {
  return {object_id, quarter_turn(), {3, 4, 50, 60}, {3, 4, 50, 20}, 3000, 2900, 1000, visib_fract};
}

json read_json(const std::filesystem::path& file) { return json::parse(test::read_bytes(file)); }

TEST(WriteBopModelsInfo, WritesWhatTheBenchmarkReads) {
  const test::TempDir folder;
  BopObject plain{12, 5.5, {-1, -2, -3}, {2, 4, 6}, {}};
  BopObject symmetric{2, 7, {0, 0, 0}, {1, 1, 1}, {{quarter_turn()}, Symmetry::Axis{}, true}};
  symmetric.symmetry.axis->point = Eigen::Vector3f(1, 2, 3);
  const std::vector<BopObject> objects{plain, symmetric};
  ASSERT_TRUE(write_bop_models_info(folder / "models_info.json", objects));
  EXPECT_EQ(read_json(folder / "models_info.json"), json::parse(R"({
      "2": {"diameter": 7, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 1, "size_z": 1,
            "symmetries_discrete": [[0, -1, 0, 10, 1, 0, 0, -20.5, 0, 0, 1, 800, 0, 0, 0, 1]],
            "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [1, 2, 3]}]},
      "12": {"diameter": 5.5, "min_x": -1, "min_y": -2, "min_z": -3, "size_x": 2, "size_y": 4, "size_z": 6}})"));
}

TEST(WriteBopCamera, WritesWhatTheBenchmarkReads) {
  const test::TempDir folder;
  ASSERT_TRUE(write_bop_camera(folder / "camera.json", {500, 501, 319.5, 239.5, 0.1}, 640, 480));
  EXPECT_EQ(read_json(folder / "camera.json"), json::parse(R"({"cx": 319.5, "cy": 239.5,
      "depth_scale": 0.1, "fx": 500, "fy": 501, "height": 480, "width": 640})"));
}

TEST(WriteBopScene, WritesWhatTheBenchmarkReads) {
  const test::TempDir folder;
  const std::vector<BopImage> images{{7, {500, 501, 319.5, 239.5, 0.1}, {instance(2, 0.25)}},
                                     {0, {600, 601, 3, 2, 1}, {}}};
  const auto scene = bop_scene_folder(folder / "test", 3);
  EXPECT_EQ(scene, folder / "test/000003");
  EXPECT_EQ(bop_depth_file(scene, 7), scene / "depth/000007.png");
  ASSERT_TRUE(write_bop_scene(scene, images));
  EXPECT_EQ(read_json(scene / "scene_camera.json"), json::parse(R"({
      "0": {"cam_K": [600, 0, 3, 0, 601, 2, 0, 0, 1], "depth_scale": 1},
      "7": {"cam_K": [500, 0, 319.5, 0, 501, 239.5, 0, 0, 1], "depth_scale": 0.1}})"));
  EXPECT_EQ(read_json(scene / "scene_gt.json"), json::parse(R"({"0": [], "7": [
      {"cam_R_m2c": [0, -1, 0, 1, 0, 0, 0, 0, 1], "cam_t_m2c": [10, -20.5, 800], "obj_id": 2}]})"));
  EXPECT_EQ(read_json(scene / "scene_gt_info.json"), json::parse(R"({"0": [], "7": [
      {"bbox_obj": [3, 4, 50, 60], "bbox_visib": [3, 4, 50, 20], "px_count_all": 3000,
       "px_count_valid": 2900, "px_count_visib": 1000, "visib_fract": 0.25}]})"));
}

TEST(WriteBopScene, WritesTheSameBytesForAnyOrderOfTheImages) {
  const test::TempDir folder;
  std::vector<BopImage> images{{10, {}, {instance(1, 1)}}, {9, {}, {}}, {2, {}, {}}};
  ASSERT_TRUE(write_bop_scene(folder / "a", images));
  std::reverse(images.begin(), images.end());
  ASSERT_TRUE(write_bop_scene(folder / "b", images));
  for (const char* name : {"scene_camera.json", "scene_gt.json", "scene_gt_info.json"})
    EXPECT_EQ(test::read_bytes(folder / "a" / name), test::read_bytes(folder / "b" / name));
}

TEST(WriteBopTargets, CountsTheInstancesThatAreVisibleEnough) {
  const test::TempDir folder;
  // A visible fraction of a tenth is enough, less is not. An image without targets stays in the
  // list.
  const std::vector<BopScene> scenes{
      {1, {{4, {}, {instance(2, 0.1), instance(1, 0.5), instance(2, 1), instance(2, 0.0999)}}}},
      {2, {{0, {}, {instance(1, 0.05)}}}}};
  ASSERT_TRUE(write_bop_targets(folder.path(), scenes));
  EXPECT_EQ(read_json(folder / "test_targets_bop19.json"), json::parse(R"([
      {"im_id": 4, "inst_count": 1, "obj_id": 1, "scene_id": 1},
      {"im_id": 4, "inst_count": 2, "obj_id": 2, "scene_id": 1}])"));
  EXPECT_EQ(read_json(folder / "test_targets_bop24.json"), json::parse(R"([
      {"im_id": 4, "scene_id": 1}, {"im_id": 0, "scene_id": 2}])"));
}

TEST(WriteBop, WritesDocumentsWithoutEntries) {
  const test::TempDir folder;
  ASSERT_TRUE(write_bop_models_info(folder / "models_info.json", {}));
  ASSERT_TRUE(write_bop_targets(folder.path(), {}));
  EXPECT_EQ(read_json(folder / "models_info.json"), json::object());
  EXPECT_EQ(read_json(folder / "test_targets_bop19.json"), json::array());
}

TEST(WriteBop, ReportsAFolderThatCannotBeMade) {
  const test::TempDir folder;
  folder.write("test", "a file");
  const Result<void> written = write_bop_scene(folder / "test/000001", {});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::cannot_create);
  EXPECT_NE(written.error().message.find("test/000001"), std::string::npos);
}

}  // namespace
}  // namespace trivet
