#include "apps/service/serve_fixture.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

namespace trivet::test {

void ServeFixture::SetUp() {
  const auto run = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome =
        run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  };
  run({"scan", "--parts", "2", "-o", "scans", "--scenes", "1", "--instances", "3", "--sensor",
       "laser"});
  run({"train", "scans/manifest.json", "--methods", "ppf", "-o", "l.h5"});
  depth_ = folder_ / "scans/test/000001/depth/000000.png";
  const nlohmann::json camera =
      nlohmann::json::parse(read_bytes(folder_ / "scans/manifest.json"))["scenes"][0]["camera"];
  std::ofstream(folder_ / "camera.json") << camera;
  camera_ = {camera["fx"], camera["fy"], camera["cx"], camera["cy"], camera["depth_scale"]};
  std::string numbers;
  for (const char* const key : {"fx", "fy", "cx", "cy", "depth_scale"})
    numbers += (numbers.empty() ? "" : ",") + camera[key].dump();
  parameters_ = "method=ppf&camera=" + numbers;
  query_ = "/v1/recognize?format=png&" + parameters_;
}

Outcome ServeFixture::serve(std::vector<std::string> arguments,
                            const std::function<void(int port)>& body) {
  // Timeouts are generous, since a busy machine is slow but correct.
  arguments.insert(arguments.begin(), {"serve", "l.h5", "--port", "0", "--drain-grace-ms", "50",
                                       "--deadline-ms", "300000"});
  if (std::ranges::find(arguments, "--exit-timeout-ms") == arguments.end())
    arguments.insert(arguments.end(), {"--exit-timeout-ms", "300000"});
  std::thread client;
  std::atomic<bool> done{false};
  end_requested_ = false;
  Outcome outcome = run_trivet(
      arguments, {.folder = folder_.path(),
                  .environment = environment_,
                  .watch = [&](pid_t process, const std::string& error) {
                    process_ = process;
                    std::smatch found;
                    if (!client.joinable() &&
                        std::regex_search(error, found, std::regex("http://[0-9.]+:([0-9]+)"))) {
                      client = std::thread([&, port = std::stoi(found[1])] {
                        body(port);
                        done = true;
                      });
                    }
                    if (done) request_end();
                  }});
  if (client.joinable()) client.join();
  return outcome;
}

void ServeFixture::request_end() {
  if (!end_requested_.exchange(true)) kill(process_, SIGTERM);
}

}  // namespace trivet::test
