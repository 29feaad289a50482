// Cameras of depth images in the formats of this program and others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "storage/formats/camera_json.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

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

TEST_F(ReadCamera, ReadsEachOfItsOwnForms) {
  const Camera expected{500, 400, 320, 240, 0.1};
  const std::string bop = R"({"cam_K": [500, 0, 320, 0, 400, 240, 0, 0, 1], "depth_scale": 0.1})";
  const auto plain =
      read(R"({"fx": 500, "fy": 400, "cx": 320, "cy": 240, "depth_scale": 0.1, "width": 640})");
  const auto matrix = read(bop), scene = read(R"({"0": {}, "12": )" + bop + "}", 12);
  ASSERT_TRUE(plain && matrix && scene);
  Camera sized = expected;
  sized.width = 640;
  EXPECT_EQ(*plain, sized);
  EXPECT_EQ(*matrix, expected);
  EXPECT_EQ(*scene, expected);
}

TEST_F(ReadCamera, AcceptsCameraModelsWithoutDistortion) {
  Camera expected{500, 400, 320, 240, 0.1};
  expected.width = 640, expected.height = 480;
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

TEST_F(ReadCamera, ReadsThoseOfOtherPrograms) {
  Camera expected{500, 400, 320, 240};
  for (const char* numbers :
       {"500 0 320\n0 400 240\n0 0 1\n", "500, 400, 320, 240", "5e2;4e2;320;240"})
    EXPECT_EQ(*read(numbers), expected) << numbers;
  EXPECT_EQ(
      *read(
          R"({"camera_matrix": {"rows": 3, "cols": 3, "data": [500, 0, 320, 0, 400, 240, 0, 0, 1]},
                      "distortion_coefficients": {"data": [0, 0, 0, 0, 0]}, "camera_name": "left"})"),
      expected);
  expected.width = 640, expected.height = 480;
  const auto is_expected = [&](const std::string& json) {
    const auto camera = read(json);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(*camera, expected) << json;
  };
  const std::string size = R"("width": 640, "height": 480, )";
  // ROS 2 and ROS 1.
  is_expected("{" + size + R"("distortion_model": "plumb_bob", "d": [0, 0, 0, 0, 0], "binning_x": 0,
      "k": [500, 0, 320, 0, 400, 240, 0, 0, 1], "r": [1, 0, 0, 0, 1, 0, 0, 0, 1],
      "p": [500, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0], "roi": {"x_offset": 0, "do_rectify": false}})");
  is_expected("{" + size + R"("D": [], "K": [500, 0, 320, 0, 400, 240, 0, 0, 1]})");
  // Open3D, which writes matrices in column-major order.
  const std::string open3d =
      "{" + size + R"("intrinsic_matrix": [500, 0, 0, 0, 400, 0, 320, 240, 1]})";
  is_expected(open3d);
  is_expected(R"({"class_name": "PinholeCameraParameters", "extrinsic": [], "intrinsic": )" +
              open3d + "}");
  // RealSense.
  is_expected("{" + size + R"("fx": 500, "fy": 400, "ppx": 320, "ppy": 240,
      "model": "distortion.inverse_brown_conrady", "coeffs": [0, 0, 0, 0, 0]})");
  is_expected("{" + size + R"("fx": 500, "fy": 400, "ppx": 320, "ppy": 240, "model": 4,
      "coeffs": [0, 0, 0, 0, 0]})");
}

TEST_F(ReadCamera, ReadsDistortionAsItsWritersNameIt) {
  const auto with = [](const std::string& more) {
    return R"({"fx": 500, "fy": 400, "cx": 320, "cy": 240, )" + more + "}";
  };
  const LensDistortion five{-0.2, 0.05, 0.001, -0.002, 0.01};
  for (
      const char* text :
      {R"("distortion": [-0.2, 0.05, 0.001, -0.002, 0.01])",
       R"("k1": -0.2, "k2": 0.05, "p1": 0.001, "p2": -0.002, "k3": 0.01)",
       R"("D": [-0.2, 0.05, 0.001, -0.002, 0.01], "distortion_model": "plumb_bob")",
       R"("coeffs": [-0.2, 0.05, 0.001, -0.002, 0.01], "model": "distortion.brown_conrady")",
       R"("coeffs": [-0.2, 0.05, 0.001, -0.002, 0.01], "model": "Brown Conrady")",
       R"("coeffs": [-0.2, 0.05, 0.001, -0.002, 0.01], "model": "RS2_DISTORTION_BROWN_CONRADY")",
       R"("d": [-0.2, 0.05, 0.001, -0.002, 0.01, 0, 0, 0, 0, 0, 0, 0], "distortion_model": "rational_polynomial")"}) {
    const auto camera = read(with(text));
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(camera->distortion, five) << text;
  }
  const auto rational = read(with(R"("distortion": [1, 2, 3, 4, 5, 6, 7, 8])"));
  ASSERT_TRUE(rational);
  EXPECT_EQ(rational->distortion, (LensDistortion{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(read(with(R"("depth": "ray")"))->depth, DepthKind::ray);
  EXPECT_EQ(read(with(R"("depth": "z")"))->depth, DepthKind::z);
}

// A stated property that the reader ignored would give a wrong pose that seems right.
TEST_F(ReadCamera, RefusesWhatItWouldBelieveByHalf) {
  const auto with = [](const std::string& more) {
    return R"({"fx": 500, "fy": 400, "cx": 320, "cy": 240, )" + more + "}";
  };
  expect_refused(with(R"("model": "kannala_brandt4", "coeffs": [0, 0, 0, 0, 0])"),
                 "kannala_brandt4");
  expect_refused(with(R"("distortion_model": "equidistant", "d": [0, 0, 0, 0])"), "equidistant");
  expect_refused(
      with(R"("model": "distortion.inverse_brown_conrady", "coeffs": [0.1, 0, 0, 0, 0])"),
      "inverse_brown_conrady");
  expect_refused(with(R"("model": "modified_brown_conrady", "coeffs": [0.1, 0, 0.1, 0, 0])"),
                 "modified");
  expect_refused(with(R"("model": "none", "coeffs": [0.1, 0, 0, 0, 0])"), "none");
  expect_refused(with(R"("distortion": [0.1, 0, 0])"), "4 to 8 numbers");
  expect_refused(with(R"("distortion": [0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0])"), "rectify");
  expect_refused(with(R"("distortion": [0.1, 0, 0, 0], "k1": 0.1)"), "both");
  expect_refused(with(R"("depth": "distance")"), "depth: expected \"z\"");
  expect_refused(with(R"("disto": [1])"), "distortion");
  expect_refused(with(R"("width": -1)"), "width");
  expect_refused(R"({"cam_K": [500, 0, 0, 0, 400, 0, 320, 240, 1]})",
                 "last row is 0 0 1; it may be transposed");
  expect_refused(R"({"cam_K": [500, 0, 320, 0, 400, 240, 0, 0, 1], "dist_coeffs": [0.1]})",
                 "dist_coeffs");
  expect_refused("500 0 0 0 400 0 320 240 1", "last row is 0 0 1");
  expect_refused(R"({"intrinsic_matrix": [500, 0, 320, 0, 400, 240, 0, 0, 1]})", "by columns");
  expect_refused(R"({"cam_K": [500, 2, 320, 0, 400, 240, 0, 0, 1]})", "without skew");
  expect_refused(R"({"k": [500, 0, 320, 0, 400, 240, 0, 0, 1], "binning_x": 2})", "binning");
  expect_refused(R"({"k": [500, 0, 320, 0, 400, 240, 0, 0, 1], "roi": {"x_offset": 8}})",
                 "whole image");
  expect_refused("500 400 320", "expected the 9 numbers");
  expect_refused("nan 400 320 240", "");
  expect_refused("image_width: 640\ncamera_matrix:\n  rows: 3\n  data: [500, 0]\n", "found YAML");
  expect_refused(R"({"camera_name": "left"})",
                 "\"fx\", \"fy\", \"cx\", \"cy\" and \"depth_scale\"");
}

TEST_F(ReadCamera, ReadsBackWhatIsWritten) {
  Camera camera{500, 400, 320, 240, 0.1};
  camera.depth = DepthKind::ray;
  camera.distortion = {1, 2, 3, 4, 5, 6, 7, 8};
  camera.width = 640, camera.height = 480;
  for (const Camera& written : {camera, Camera{500, 400, 320, 240, 0.1}}) {
    const auto again = read(camera_json(written).dump());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(*again, written);
  }
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
