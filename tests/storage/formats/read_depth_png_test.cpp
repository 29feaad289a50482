// Depth images and their cameras.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "storage/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using test::kCamera;
using test::kReadOptions;

class ReadDepthPng : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = kReadOptions) {
    return read_cloud(folder_.write("depth.png", bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadDepthPng, PutsEachPixelInFrontOfTheCamera) {
  const auto cloud = read(test::depth_png(3, 2, {1000, 0, 2000, 3000, 0, 65535}));
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(test::is_valid(*cloud));
  EXPECT_EQ(cloud->camera, kCamera);
  EXPECT_EQ(cloud->viewpoint, Eigen::Vector3f(0, 0, 0));
  ASSERT_TRUE(cloud->grid);
  EXPECT_EQ(cloud->grid->width, 3U);
  EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2, -1, 3}));
  const double depths[] = {1, 2, 3, 65.535};
  const int u[] = {0, 2, 0, 2}, v[] = {0, 0, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    // A float holds 24 bits: half a step is 6e-8 of the value.
    const Eigen::Vector3d expected((u[i] - kCamera.cx) / kCamera.fx * depths[i],
                                   (v[i] - kCamera.cy) / kCamera.fy * depths[i], depths[i]);
    EXPECT_LT((cloud->points[i].cast<double>() - expected).norm(), 1e-7 * depths[i]);
  }
}

TEST_F(ReadDepthPng, SaysHowToGiveACamera) {
  const std::string image = test::depth_png(1, 1, {1});
  EXPECT_TRUE(is_refused(read(image, {}), "--camera CAMERA.json"));
  for (const Camera broken : {Camera{0, 1, 0, 0, 1}, Camera{1, -1, 0, 0, 1},
                              Camera{1, 1, 0.0 / 0.0, 0, 1}, Camera{1, 1, 0, 0, 0}}) {
    EXPECT_TRUE(is_refused(read(image, {.camera = broken}), "above zero"));
  }
}

TEST_F(ReadDepthPng, RefusesWhatHoldsNoDepths) {
  EXPECT_TRUE(is_refused(read(test::png_file(1, 1, 8, 0, std::string(2, '\1'))), "8 bits"));
  EXPECT_TRUE(is_refused(read(test::png_file(1, 1, 16, 2, std::string(7, '\1'))), "color type 2"));
  EXPECT_TRUE(is_refused(read("\x89PNG, but not really a PNG file, only a text"), "signature"));
}

// A covered camera, or nothing within its range: a scene all the same.
TEST_F(ReadDepthPng, ReadsAnImageWithoutAnyMeasurement) {
  const auto cloud = read(test::depth_png(2, 2, {0, 0, 0, 0}), {.camera = kCamera});
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_TRUE(cloud->points.empty());
  ASSERT_TRUE(cloud->grid);
  EXPECT_EQ(cloud->grid->point_index.size(), 4U);
}

TEST_F(ReadDepthPng, RefusesSizesThatLieBeforeDecoding) {
  const std::string row(3, '\1');
  EXPECT_TRUE(is_refused(read(test::png_file(50000, 50000, 16, 0, row)), "50000 x 50000"));
  EXPECT_TRUE(is_refused(read(test::png_file(0xFFFFFFFF, 0xFFFFFFFF, 16, 0, row)), "pixels"));
  EXPECT_TRUE(is_refused(read(test::png_file(8000, 8000, 16, 0, row)), "truncated"));
  EXPECT_TRUE(is_refused(read(test::png_file(0, 1, 16, 0, row)), "0 x 1"));
  EXPECT_TRUE(is_refused(read(test::png_file(1, 2, 16, 0, row)), "decoded"));
  EXPECT_TRUE(
      is_refused(read(test::depth_png(2, 2, {1, 2, 3, 4}), {.camera = kCamera, .max_pixels = 3}),
                 "1 to 3 pixels"));
}

class ReadCamera : public testing::Test {
 protected:
  Result<Camera> read(const std::string& json, std::optional<int> image_id = {}) {
    return read_camera(folder_.write("camera.json", json), image_id);
  }
  void expect_refused(const std::string& json, const std::string& text,
                      std::optional<int> image_id = {}) {
    const auto camera = read(json, image_id);
    ASSERT_FALSE(camera) << json;
    EXPECT_EQ(camera.error().code, ErrorCode::bad_data);
    EXPECT_NE(camera.error().message.find(text), std::string::npos) << camera.error().message;
  }
  test::TempDir folder_;
};

TEST_F(ReadCamera, TakesEachOfTheThreeForms) {
  const Camera expected{500, 400, 320, 240, 0.1};
  const std::string bop = R"({"cam_K": [500, 0, 320, 0, 400, 240, 0, 0, 1], "depth_scale": 0.1})";
  const auto plain =
      read(R"({"fx": 500, "fy": 400, "cx": 320, "cy": 240, "depth_scale": 0.1, "width": 640})");
  const auto matrix = read(bop), scene = read(R"({"0": {}, "12": )" + bop + "}", 12);
  ASSERT_TRUE(plain && matrix && scene);
  EXPECT_EQ(*plain, expected);
  EXPECT_EQ(*matrix, expected);
  EXPECT_EQ(*scene, expected);
}

TEST_F(ReadCamera, TakesCameraModelsWithoutDistortion) {
  const Camera expected{500, 400, 320, 240, 0.1};
  const auto model = [](const char* type, const char* parameters) {
    return fmt::format(R"({{"cam_model": {{"image_width": 640, "image_height": 480,
                           "projection_model_type": "{}", "projection_params": {}}},
                           "depth_scale": 0.1}})",
                       type, parameters);
  };
  for (const char* type :
       {"CameraModelType.PINHOLE", "PinholePlane", "PinholePlaneCameraModel", "LINEAR"}) {
    const auto camera = read(model(type, "[500, 400, 320, 240]"));
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(*camera, expected);
  }
  EXPECT_TRUE(read(model("PinholePlane", "[500, 400, 320, 240, 0, 0]")));
  EXPECT_TRUE(read("{\"7\": " + model("PinholePlane", "[500, 400, 320, 240]") + "}", 7));
  expect_refused(model("PinholePlane", "[500, 400, 320, 240, 0.1]"), "distortion");
  expect_refused(model("PinholePlane", "[500, 320, 240]"), "fx, fy, cx, cy");
  expect_refused(model("CameraModelType.FISHEYE624", "[500, 320, 240, 0, 0]"),
                 "cam_model.projection_model_type: expected a pinhole camera, found "
                 "\"CameraModelType.FISHEYE624\"");
}

TEST_F(ReadCamera, NamesWhatIsMissingOrWrong) {
  expect_refused(R"({"fx": 500, "fy": 400, "cx": 320})", "\"cy\"");
  expect_refused(R"({"fx": 0, "fy": 400, "cx": 320, "cy": 240})", "above zero");
  expect_refused(R"({"fx": "500", "fy": 400, "cx": 320, "cy": 240})", "fx: expected a number");
  expect_refused(R"({"fx": 1e999, "fy": 400, "cx": 320, "cy": 240})", "");
  expect_refused(R"({"cam_K": [500, 0, 320]})", "expected 9 numbers");
  expect_refused(R"({"12": {}})", "id of an image");
  expect_refused(R"({"12": {}})", "\"13\"", 13);
  expect_refused("[1, 2]", "expected an object");
  expect_refused("{\"fx\": 500,", "byte");
  expect_refused("", "byte");
  expect_refused(std::string(100000, '['), "deeper than 32");
  EXPECT_EQ(read_camera(folder_ / "none.json").error().code, ErrorCode::missing_input);
}

}  // namespace
}  // namespace trivet
