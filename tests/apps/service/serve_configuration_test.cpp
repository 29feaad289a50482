/// What configures a service: its file, its flags, and what they name.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "engine/loaded_library/score_calibration.hpp"

namespace trivet {
namespace {

using test::ask;
using test::read_bytes;

class ServeConfiguration : public test::ServeFixture {};

TEST_F(ServeConfiguration, IsConfiguredByAFileAndByFlags) {
  const auto check = [&](const std::string& toml, std::vector<std::string> flags) {
    std::ofstream(folder_ / "serve.toml") << toml;
    flags.insert(flags.begin(), {"serve", "--config", "serve.toml", "--check-config"});
    return test::run_trivet(flags, {.folder = folder_.path(), .environment = {}, .watch = {}});
  };
  const test::Outcome good = check("library = 'l.h5'\nmax-waiting = 8\n", {});
  EXPECT_EQ(good.exit_code, 0) << good.error;
  const test::Outcome bad = check(
      "library = 'absent.h5'\ncalibration = 'absent.json'\nmax-waitings = 8\nport = "
      "70000\nparallel = 1.5\nlog = 'loud'\n"
      "max-body-mb = 600\n",
      {"--deadline-ms", "soon"});
  EXPECT_EQ(bad.exit_code, 2);
  for (const char* const fault :
       {"serve.toml:3: found 'max-waitings'; did you mean 'max-waiting'?", "serve.toml:4: port",
        "serve.toml:5: parallel", "serve.toml:6: log", "absent.json: no such file",
        "absent.h5: no such file", "--deadline-ms",
        "max-body-mb: expected at most max-waiting-mb"}) {
    EXPECT_NE(bad.error.find(fault), std::string::npos) << fault << " in\n" << bad.error;
  }
  // A command-line flag replaces the file's value, valid or not.
  EXPECT_EQ(check("library = 'absent.h5'\nport = 70000\n", {"l.h5", "--port", "0"}).exit_code, 0);
  EXPECT_NE(check("library = \n", {}).error.find("serve.toml:1"), std::string::npos);
  EXPECT_EQ(check("", {}).exit_code, 2) << "no library";
}

TEST_F(ServeConfiguration, ChecksWhatItsConfigurationNames) {
  const auto check = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"serve", "--check-config"});
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  };
  const test::Outcome good = check({"l.h5", "--examples", "scans/manifest.json"});
  EXPECT_EQ(good.exit_code, 0) << good.error;
  for (const char* const found :
       {"l.h5: 2 models [m], for method ppf", "scans/manifest.json: examples: 1", "is good"}) {
    EXPECT_NE(good.error.find(found), std::string::npos) << found << " in\n" << good.error;
  }
  const auto refuses = [&](const std::vector<std::string>& arguments, int exit_code,
                           const std::string& reason) {
    const test::Outcome bad = check(arguments);
    EXPECT_EQ(bad.exit_code, exit_code) << bad.error;
    EXPECT_NE(bad.error.find(reason), std::string::npos) << bad.error;
    EXPECT_EQ(bad.error.find("is good"), std::string::npos) << bad.error;
  };
  const std::string library = read_bytes(folder_ / "l.h5");
  folder_.write("half.h5", library.substr(0, library.size() / 2));
  folder_.write("cell.json", "{}");
  folder_.write("text.h5", "no library");
  refuses({"text.h5"}, 65, "text.h5: expected a model library");
  refuses({"half.h5"}, 65, "half.h5: ");
  refuses({"l.h5", "--calibration", "cell.json"}, 65, "cell.json");
  refuses({"l.h5", "--examples", "camera.json"}, 65, "camera.json");
  refuses({"l.h5", "--address", "nowhere"}, 2, "address: expected an IP address");
}

TEST_F(ServeConfiguration, AnswersWithACalibratedScore) {
  ScoreCalibration calibration{{}, 5, 30, 60};
  calibration.adaptation.shift = -1;
  ASSERT_TRUE(write_calibration(folder_ / "cell.json", calibration));
  const std::string scan = read_bytes(depth_);
  const auto library_of = [&](int port) {
    return ask(port, "POST", query_, scan).json()["library"];
  };
  nlohmann::json bias;
  const test::Outcome plain = serve({}, [&](int port) {
    EXPECT_TRUE(library_of(port)["calibration"].is_null());
    bias = ask(port, "GET", "/v1/score-parts").json()["bias"];
  });
  EXPECT_EQ(plain.exit_code, 0) << plain.error;
  const test::Outcome calibrated = serve({"--calibration", "cell.json"}, [&](int port) {
    EXPECT_EQ(library_of(port)["calibration"], score_name(calibrated_score(calibration)));
    const nlohmann::json shifted = ask(port, "GET", "/v1/score-parts").json()["bias"];
    EXPECT_NEAR(shifted[0].get<double>(), bias[0].get<double>() - 1, 1e-4);
    // A reload reads the file again; after an invalid one the old one stays in use.
    calibration.adaptation.shift = -2;
    ASSERT_TRUE(write_calibration(folder_ / "cell.json", calibration));
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    EXPECT_EQ(library_of(port)["calibration"], score_name(calibrated_score(calibration)));
    folder_.write("cell.json", "{}");
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 409);
    EXPECT_EQ(library_of(port)["calibration"], score_name(calibrated_score(calibration)));
  });
  EXPECT_EQ(calibrated.exit_code, 0) << calibrated.error;
}

}  // namespace
}  // namespace trivet
