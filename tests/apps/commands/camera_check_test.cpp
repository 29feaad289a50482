#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Json = nlohmann::json;

/// Two depth images, with the correct focal length and with one 4 % too large.
class CameraCheckCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    run({"scan", "--parts", "6", "-o", "scans", "--scenes", "2", "--instances", "8", "--sensor",
         "laser", "--seed", "3"});
    run({"train", "scans/manifest.json", "-o", "l.h5", "--methods", "ppf"});
    Json manifest = Json::parse(test::read_bytes(*folder_ / "scans/manifest.json"));
    focal_ = manifest["scenes"][0]["camera"]["fx"];
    for (Json& scene : manifest["scenes"]) {
      for (const char* const key : {"fx", "fy"})
        scene["camera"][key] = 1.04 * scene["camera"][key].get<double>();
    }
    std::ofstream(*folder_ / "scans/wrong.json") << manifest;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string run(const std::vector<std::string>& arguments) {
    const test::Outcome outcome =
        test::run_trivet(arguments, {.folder = folder_->path(), .environment = {}, .watch = {}});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.out;
  }

  static inline std::unique_ptr<test::TempDir> folder_;
  static inline double focal_ = 0;
};

TEST_F(CameraCheckCommand, SaysNothingOfARightCamera) {
  const Json found = Json::parse(run({"recognize", "l.h5", "scans/manifest.json", "--json", "-"}));
  ASSERT_EQ(found["cameras"].size(), 1U);
  EXPECT_TRUE(found["cameras"][0]["finding"].is_null()) << found["cameras"];
  EXPECT_NEAR(found["cameras"][0]["focal_scale"], 1, 0.01);
  for (const Json& scene : found["scenes"]) {
    EXPECT_EQ(scene["camera_check"]["camera"]["fx"], focal_);
    EXPECT_TRUE(scene["camera_check"]["finding"].is_null());
  }
}

TEST_F(CameraCheckCommand, SaysThatTheFocalLengthIsTooLarge) {
  const std::string out =
      run({"recognize", "l.h5", "scans/wrong.json", "--method", "ppf", "--report", "report"});
  EXPECT_NE(out.find("the focal length looks "), std::string::npos) << out;
  EXPECT_NE(out.find(" % too large"), std::string::npos) << out;
  EXPECT_NE(test::read_bytes(*folder_ / "report/index.html").find("the focal length looks "),
            std::string::npos);
}

TEST_F(CameraCheckCommand, RecognizesWithTheCameraThatItEstimates) {
  const Json found = Json::parse(
      run({"recognize", "l.h5", "scans/wrong.json", "--estimate-camera", "--json", "-"}));
  ASSERT_EQ(found["cameras"].size(), 1U);
  EXPECT_NEAR(found["cameras"][0]["camera"]["fx"], focal_, 0.01 * focal_);
  EXPECT_TRUE(found["cameras"][0]["finding"].is_null()) << found["cameras"];
  for (const Json& scene : found["scenes"])
    EXPECT_EQ(scene["camera_check"]["camera"], found["cameras"][0]["camera"]);
}

}  // namespace
}  // namespace trivet
