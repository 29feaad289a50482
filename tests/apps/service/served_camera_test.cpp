// Cameras of requests: every parameter takes effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/service/http/json_parameters.hpp"
#include "apps/service/serve/requests/recognize_query.hpp"

namespace trivet::apps::service {
namespace {

TEST(ServedCamera, IsTheSameInParametersAndInJson) {
  Camera camera{500, 400, 320, 240, 0.1};
  camera.depth = DepthKind::ray;
  camera.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01, 0.1, 0.2, 0.3};
  camera.width = 640, camera.height = 480;
  for (const Camera& given : {camera, Camera{500, 400, 320, 240, 0.1}}) {
    Parameters parameters;
    add_camera(given, parameters);
    std::ranges::reverse(parameters);  // in any order
    const auto query = parse_recognize_query(parameters);
    ASSERT_TRUE(query) << query.error().message;
    EXPECT_EQ(query->scene.camera, given);
  }
  const nlohmann::json json{{"camera",
                             {{"fx", 500},
                              {"fy", 400},
                              {"ppx", 320},
                              {"ppy", 240},
                              {"depth", "ray"},
                              {"coeffs", {0.1, 0, 0, 0, 0}}}}};
  const auto query = parse_recognize_query(parameters_of(JsonNode(json, "")));
  ASSERT_TRUE(query) << query.error().message;
  EXPECT_EQ(query->scene.camera->depth, DepthKind::ray);
  EXPECT_EQ(query->scene.camera->distortion, LensDistortion{0.1});
}

TEST(ServedCamera, IsRequiredByOptionsOfItsImages) {
  for (const auto& [name, value] :
       {std::pair("depth", "ray"), {"distortion", "0.1,0,0,0"}, {"image-size", "640,480"}}) {
    const auto query = parse_recognize_query({{name, value}});
    ASSERT_FALSE(query) << name;
    EXPECT_NE(query.error().message.find("expected the camera beside them"), std::string::npos);
  }
  EXPECT_FALSE(parse_recognize_query({{"camera", "1,1,0,0"}, {"distortion", "0.1,0,0"}}));
  EXPECT_FALSE(parse_recognize_query({{"camera", "1,1,0,0"}, {"depth", "distance"}}));
  EXPECT_TRUE(parse_recognize_query({{"depth", "z"}})) << "as it is without";
}

}  // namespace
}  // namespace trivet::apps::service
