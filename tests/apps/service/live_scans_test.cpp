// Scans written to a watched folder are recognized as they arrive.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet::test {
namespace {

namespace fs = std::filesystem;

class LiveScans : public ServeFixture {
 protected:
  static nlohmann::json scans(int port, int number, const std::string& query = "") {
    nlohmann::json listed;
    for (int k = 0; k < 3000; ++k) {
      listed = ask(port, "GET", "/v1/live" + query).json()["scans"];
      if (static_cast<int>(listed.size()) >= number) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return listed;
  }
};

TEST_F(LiveScans, AreRecognizedAsTheyCome) {
  fs::create_directory(folder_ / "in");
  fs::copy(depth_, folder_ / "in/old.png");
  const Outcome outcome = serve({"--watch", "in", "--watch-query", parameters_}, [&](int port) {
    std::ofstream(folder_ / "in/notes.md") << "no scan";
    fs::copy(depth_, folder_ / "in/first.png");
    nlohmann::json listed = scans(port, 1);
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0]["name"], "first.png");
    EXPECT_EQ(listed[0]["number"], 1);
    EXPECT_EQ(listed[0]["query"], "format=png&" + parameters_);
    EXPECT_TRUE(listed[0]["error"].is_null());

    // Equal to the result for a posted scan, bit by bit.
    const nlohmann::json sent = ask(port, "POST", query_, read_bytes(depth_)).json();
    const nlohmann::json answer = ask(port, "GET", listed[0]["answer"]).json();
    EXPECT_EQ(answer["scenes"][0]["detections"], sent["scenes"][0]["detections"]);
    EXPECT_EQ(listed[0]["detections"], sent["scenes"][0]["detections"].size());
    EXPECT_EQ(ask(port, "GET", listed[0]["url"]).body, read_bytes(depth_));

    std::ofstream(folder_ / "in/damaged.png") << "\x89PNG no more";
    listed = scans(port, 1, "?after=1");
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_NE(listed[0]["error"].get<std::string>().find("damaged.png"), std::string::npos);
    EXPECT_EQ(ask(port, "GET", listed[0]["answer"]).status, 404);
    // A rewritten scan is new.
    fs::remove(folder_ / "in/damaged.png");
    fs::copy(depth_, folder_ / "in/damaged.png");
    listed = scans(port, 1, "?after=2");
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_TRUE(listed[0]["error"].is_null()) << listed;
    const std::string metrics = ask(port, "GET", "/metrics").body;
    EXPECT_NE(metrics.find("trivet_scenes_total{result=\"recognized\"} 3\n"), std::string::npos);
    EXPECT_NE(metrics.find("trivet_scenes_total{result=\"failed\"} 1\n"), std::string::npos);
    fs::remove(folder_ / "in/first.png");
    EXPECT_EQ(ask(port, "GET", "/v1/live/1/scan").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/live/77/scan").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/live?after=x").status, 400);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(LiveScans, AreReadOnceTheyAreCompleteThoughWrittenSlowly) {
  fs::create_directory(folder_ / "in");
  serve({"--watch", "in", "--watch-query", parameters_}, [&](int port) {
    const std::string bytes = read_bytes(depth_);
    std::ofstream file(folder_ / "in/slow.png", std::ios::binary);
    for (std::size_t part = 0; part < 8; ++part) {
      const std::size_t first = part * bytes.size() / 8, next = (part + 1) * bytes.size() / 8;
      file.write(bytes.data() + first, static_cast<std::streamsize>(next - first)).flush();
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
    file.close();
    const nlohmann::json listed = scans(port, 1);
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_TRUE(listed[0]["error"].is_null()) << listed;
  });
}

// The scan is written in place by a program that pauses: a file unchanged for less than the
// configured time is incomplete.
TEST_F(LiveScans, AreCompleteOnceUnchangedOrRenamed) {
  fs::create_directory(folder_ / "in");
  serve({"--watch", "in", "--watch-query", parameters_, "--watch-rest-ms", "3000"}, [&](int port) {
    const std::string bytes = read_bytes(depth_);
    const auto append = [&](std::size_t first, std::size_t last) {
      std::ofstream(folder_ / "in/halves.png", std::ios::binary | std::ios::app)
          .write(bytes.data() + first, static_cast<std::streamsize>(last - first));
    };
    append(0, bytes.size() / 2);
    // A renamed file is read without that wait.
    std::ofstream(folder_ / "in/.renamed", std::ios::binary) << bytes;
    fs::rename(folder_ / "in/.renamed", folder_ / "in/renamed.png");
    nlohmann::json listed = scans(port, 1);
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0]["name"], "renamed.png");
    append(bytes.size() / 2, bytes.size());
    listed = scans(port, 1, "?after=1");
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0]["name"], "halves.png");
    EXPECT_TRUE(listed[0]["error"].is_null()) << listed;
    EXPECT_EQ(listed[0]["detections"], scans(port, 1)[0]["detections"]);
  });
}

TEST_F(LiveScans, AreOnesOfTheirOwnWhenOneFileIsOverwrittenAgainAndAgain) {
  fs::create_directory(folder_ / "in");
  const fs::path latest = folder_ / "in/latest.png";
  const Outcome outcome = serve(
      {"--watch", "in", "--watch-query", parameters_, "--watch-rest-ms", "200"}, [&](int port) {
        const std::string bytes = read_bytes(depth_);
        for (int i = 0; i < 4; ++i) {
          // Truncated, then rewritten, as by a camera that uses one file name.
          std::ofstream(latest, std::ios::binary | std::ios::trunc)
              << (i == 1 ? bytes.substr(0, bytes.size() / 2) : bytes);
          const nlohmann::json listed = scans(port, 1, "?after=" + std::to_string(i));
          ASSERT_EQ(listed.size(), 1U);
          EXPECT_EQ(listed[0]["number"], i + 1);
          EXPECT_EQ(listed[0]["error"].is_null(), i != 1) << listed;
        }
        EXPECT_EQ(ask(port, "GET", "/v1/live/1/scan").status, 404) << "the file holds another scan";
        EXPECT_EQ(ask(port, "GET", "/v1/live/4/scan").body, bytes);
        EXPECT_EQ(ask(port, "GET", "/v1/live/1/answer").status, 200);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(LiveScans, MayHaveNamesThatAreNoText) {
  fs::create_directory(folder_ / "in");
  const Outcome outcome = serve({"--watch", "in", "--watch-query", parameters_}, [&](int port) {
    for (const char* const name : {"Geh\xe4use.png", "br\xffken.png"}) {
      fs::copy(depth_, folder_ / ".scan");
      if (name[0] == 'b') fs::resize_file(folder_ / ".scan", 100);
      fs::rename(folder_ / ".scan", folder_ / "in" / name);
      scans(port, name[0] == 'b' ? 2 : 1);
    }
    const nlohmann::json listed = scans(port, 2);
    ASSERT_EQ(listed.size(), 2U);
    EXPECT_EQ(listed[0]["name"], "Geh\xef\xbf\xbduse.png");
    EXPECT_TRUE(listed[0]["error"].is_null());
    EXPECT_EQ(ask(port, "GET", listed[0]["url"]).body, read_bytes(depth_));
    EXPECT_EQ(ask(port, "GET", listed[0]["answer"]).status, 200);
    EXPECT_NE(listed[1]["error"].get<std::string>().find("br\xef\xbf\xbdken.png"),
              std::string::npos);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(LiveScans, HaveAnEpochThatIsNewWithEachService) {
  fs::create_directory(folder_ / "in");
  std::vector<std::string> epochs;
  for (int i = 0; i < 2; ++i) {
    serve({"--watch", "in"}, [&](int port) {
      const auto listed = [&] { return ask(port, "GET", "/v1/live").json()["epoch"]; };
      epochs.push_back(listed());
      EXPECT_EQ(listed(), epochs.back());
    });
  }
  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_FALSE(epochs[0].empty());
  EXPECT_NE(epochs[0], epochs[1]);
}

TEST_F(LiveScans, RefusesWhatItCannotWatch) {
  const Outcome folder = serve({"--watch", "nowhere"}, [](int) {});
  EXPECT_NE(folder.error.find("nowhere"), std::string::npos) << folder.error;
  EXPECT_NE(folder.exit_code, 0);
  fs::create_directory(folder_ / "in");
  const Outcome query = serve({"--watch", "in", "--watch-query", "min-score=7"}, [](int) {});
  EXPECT_NE(query.error.find("min-score"), std::string::npos) << query.error;
  EXPECT_NE(query.exit_code, 0);
  serve({}, [](int port) {
    EXPECT_EQ(ask(port, "GET", "/v1/live").json(), (nlohmann::json{{"watched", false}}));
  });
}

}  // namespace
}  // namespace trivet::test
