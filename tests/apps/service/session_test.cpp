// Scans, responses and truth that a service keeps in a folder.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet {
namespace {

using test::Answer;
using Json = nlohmann::json;

class SessionOfAService : public test::ServeFixture {
 protected:
  Answer put_scan(int port, const std::string& name, const std::string& bytes) const {
    return ask(port, "PUT", "/v1/session/scans/" + name + "?format=png&" + parameters_.substr(11),
               bytes);
  }
  test::Outcome run(const std::string& program, const std::vector<std::string>& arguments) const {
    return test::run_program(program, arguments,
                             {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  test::Outcome trivet(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  std::string scan() const { return test::read_bytes(depth_); }
  static Json index(int port) { return ask(port, "GET", "/v1/session").json(); }
};

TEST_F(SessionOfAService, IsAFolderThatEvaluateReads) {
  ASSERT_EQ(parameters_.rfind("method=ppf&", 0), 0U);
  Json kept;
  std::size_t num_found = 0;
  const auto first = serve({"--session", "cell"}, [&](int port) {
    EXPECT_EQ(index(port)["scans"], Json::array());
    for (const char* const name : {"left", "right"}) {
      const Answer put = put_scan(port, name, scan());
      EXPECT_EQ(put.status, 200) << put.body;
    }
    EXPECT_EQ(put_scan(port, "left", scan()).status, 409);
    EXPECT_EQ(ask(port, "GET", "/v1/session/scans/left").body, scan());
    const Answer found = ask(port, "POST", query_, scan());
    ASSERT_EQ(found.status, 200) << found.body;
    Json answer = found.json(), truth = Json::array();
    for (Json& detection : answer["scenes"][0]["detections"]) {
      detection["right"] = true;
      truth.push_back(
          {{"model", detection["model"]}, {"T_scene_model", detection["T_scene_model"]}});
    }
    num_found = truth.size();
    ASSERT_GT(num_found, 0U);
    for (const char* const name : {"left", "right"}) {
      const Answer put = ask(port, "PUT", std::string("/v1/session/runs/A/") + name, answer.dump());
      EXPECT_EQ(put.status, 200) << put.body;
    }
    const Answer stored =
        ask(port, "PUT", "/v1/session/scans/left/truth", Json{{"truth", truth}}.dump());
    EXPECT_EQ(stored.status, 200) << stored.body;
    const Answer back = ask(port, "GET", "/v1/session/runs/A/left");
    answer["scenes"][0]["scene"] = "scans/left.png";
    EXPECT_EQ(back.json(), answer);

    kept = index(port);
    EXPECT_EQ(kept["scans"].size(), 2U);
    EXPECT_EQ(kept["scans"][0]["truth"].size(), num_found);
    EXPECT_EQ(kept["scans"][1]["truth"], nullptr);
    EXPECT_EQ(kept["runs"][0]["answers"][1]["found"], num_found);
    EXPECT_EQ(kept["runs"][0]["answers"][1]["seconds"], answer["seconds"]["work"]);
    // The scan is read again with the parameters in the index.
    const Answer again =
        ask(port, "POST",
            "/v1/recognize?method=ppf&" + kept["scans"][0]["query"].get<std::string>(), scan());
    EXPECT_EQ(again.json()["scenes"][0]["detections"], found.json()["scenes"][0]["detections"]);
    std::ofstream(folder_ / "session.tar") << ask(port, "GET", "/v1/session/archive").body;
  });
  EXPECT_EQ(first.exit_code, 0) << first.error;
  const auto second = serve({"--session", "cell"}, [&](int port) {
    Json again = index(port);
    const Json now = again["scans"][0]["truth"], before = kept["scans"][0]["truth"];
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t k = 0; k < now.size(); ++k) {  // rotations are orthonormalized again
      for (int i = 0; i < 12; ++i) {
        EXPECT_NEAR(now[k]["T_scene_model"][i / 4][i % 4].get<double>(),
                    before[k]["T_scene_model"][i / 4][i % 4].get<double>(), 1e-6);
      }
    }
    again["scans"][0]["truth"] = before;
    again["scans"][0]["version"] = kept["scans"][0]["version"];
    EXPECT_EQ(again, kept) << "the same after a restart";
    EXPECT_EQ(ask(port, "DELETE", "/v1/session/scans/right").status, 200);
    EXPECT_EQ(ask(port, "GET", "/v1/session/runs/A/right").status, 404);
    EXPECT_EQ(ask(port, "DELETE", "/v1/session/runs/A").status, 200);
    EXPECT_EQ(index(port)["runs"], Json::array());
  });
  EXPECT_EQ(second.exit_code, 0) << second.error;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "cell/scans/right.png"));

  // Only marked scans are evaluated, and all their parts are found again.
  const test::Outcome unpacked = run("/bin/tar", {"xf", "session.tar"});
  ASSERT_EQ(unpacked.exit_code, 0) << unpacked.error;
  EXPECT_EQ(unpacked.error, "");
  EXPECT_EQ(test::read_bytes(folder_ / "session/scans/left.png"), scan());
  EXPECT_EQ(serve({"--session", "session"}, [](int) {}).exit_code, 0) << "a session of its own";
  const test::Outcome scored =
      trivet({"evaluate", "l.h5", "session/manifest.json", "--method", "ppf", "--json", "-"});
  ASSERT_EQ(scored.exit_code, 0) << scored.error;
  const Json scores = Json::parse(scored.out);
  EXPECT_EQ(scores["scenes"].size(), 1U);
  EXPECT_EQ(scores["instances"], num_found);
  EXPECT_EQ(scores["right"], num_found);
  EXPECT_EQ(scores["false_positives"], 0);
  const test::Outcome compared =
      trivet({"compare", "session/runs/A", "session/runs/A", "--library", "l.h5", "--json", "-"});
  ASSERT_EQ(compared.exit_code, 0) << compared.error;
  EXPECT_EQ(Json::parse(compared.out)["total"]["both"], 2 * num_found);
}

TEST_F(SessionOfAService, ReplacesOnlyTheVersionThatIsKnown) {
  const auto put = [](int port, const std::string& path, const Json& body,
                      const std::string& version) {
    return ask(port, "PUT", "/v1/session/" + path, body.dump(), "If-Match: " + version + "\r\n");
  };
  const auto outcome = serve({"--session", "cell"}, [&](int port) {
    ASSERT_EQ(put_scan(port, "left", scan()).status, 200);
    Json answer = ask(port, "POST", query_, scan()).json();
    const Answer first = ask(port, "PUT", "/v1/session/runs/A/left", answer.dump());
    ASSERT_EQ(first.status, 200) << first.body;
    const std::string version = first.json()["version"];
    EXPECT_NE(ask(port, "GET", "/v1/session/runs/A/left").head.find("ETag: " + version),
              std::string::npos);
    Json& detections = answer["scenes"][0]["detections"];
    ASSERT_FALSE(detections.empty());
    detections[0]["right"] = true;
    EXPECT_EQ(put(port, "runs/A/left", answer, version).status, 200);
    const Answer stale = put(port, "runs/A/left", answer, version);
    EXPECT_EQ(stale.status, 409) << "it is another one now";
    EXPECT_EQ(stale.json()["answer"]["scenes"][0]["detections"], detections);
    EXPECT_EQ(put(port, "runs/A/left", answer, stale.json()["version"]).status, 200);
    EXPECT_EQ(put(port, "runs/A/left", answer, "*").status, 200);

    const std::string unmarked = index(port)["scans"][0]["version"];
    const Json truth{
        {"truth",
         {{{"model", detections[0]["model"]}, {"T_scene_model", detections[0]["T_scene_model"]}}}}};
    const Answer stored = put(port, "scans/left/truth", truth, unmarked);
    ASSERT_EQ(stored.status, 200) << stored.body;
    EXPECT_NE(stored.json()["version"], unmarked);
    const Answer late = put(port, "scans/left/truth", {{"truth", nullptr}}, unmarked);
    EXPECT_EQ(late.status, 409);
    EXPECT_EQ(late.json()["scan"], index(port)["scans"][0]);
    EXPECT_EQ(put(port, "scans/left/truth", {{"truth", nullptr}}, stored.json()["version"]).status,
              200);
    EXPECT_EQ(index(port)["scans"][0]["version"], unmarked) << "of the same, the same";
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(SessionOfAService, RefusesWhatItCannotKeep) {
  const auto refuses = [](const Answer& answer, int status, const char* words) {
    EXPECT_EQ(answer.status, status) << answer.body;
    EXPECT_NE(answer.body.find(words), std::string::npos) << answer.body;
  };
  const auto outcome = serve({"--session", "cell", "--session-mb", "1"}, [&](int port) {
    for (const char* const name : {".hidden", "a/b", "a..b", "", "-", "%c3%a4"})
      refuses(put_scan(port, name, scan()), 400, "expected a letter or digit");
    for (const char* const name : {"..", "%2e%2e%2fl", "a%2fb", "a%00b"})
      refuses(put_scan(port, name, scan()), 400, "path: expected");
    refuses(put_scan(port, std::string(65, 'a'), scan()), 400, "63 letters");
    refuses(put_scan(port, "a", "no image"), 400, "body.png");
    refuses(ask(port, "PUT", "/v1/session/scans/a?format=exe", scan()), 400, "format");
    refuses(ask(port, "GET", "/v1/session/scans/..%2f..%2fl.h5"), 400, "path: expected");
    refuses(ask(port, "GET", "/v1/session/runs/../scans"), 400, "path: expected");
    refuses(ask(port, "POST", "/v1/session/scans/a", ""), 405, "expected GET, PUT, DELETE");
    EXPECT_EQ(put_scan(port, "a", scan()).status, 200);
    refuses(ask(port, "PUT", "/v1/session/scans/b?format=png&unit=mm&camera=500,500,1,1,1", scan()),
            400, "unit: expected m");
    refuses(ask(port, "PUT", "/v1/session/runs/A/b", R"({"scenes": []})"), 400, "one scene");
    refuses(ask(port, "PUT", "/v1/session/runs/A/b",
                R"({"scenes": [{"scene": "b", "detections": []}]})"),
            404, "no scan 'b'");
    refuses(ask(port, "PUT", "/v1/session/runs/A/a/b",
                R"({"scenes": [{"scene": "a", "detections": []}]})"),
            404, "names of a run");
    refuses(ask(port, "PUT", "/v1/session/scans/a/truth", R"({"trut": []})"), 400,
            "did you mean 'truth'?");
    refuses(ask(port, "PUT", "/v1/session/scans/a/truth",
                R"({"truth": [{"model": "../l",
                    "T_scene_model": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]})"),
            400, "expected a model of the library");
    const Json long_answer{{"scenes", {{{"scene", "a"}, {"detections", Json::array()}}}},
                           {"more", std::string(2 << 20, 'x')}};
    refuses(ask(port, "PUT", "/v1/session/runs/A/a", long_answer.dump()), 413, "--session-mb");
    Json answer{{"scenes", {{{"scene", "a"}, {"detections", Json::array()}}}},
                {"more", std::string(400'000, 'x')}};
    Answer last;
    for (int k = 0; k < 3 && last.status != 507; ++k)
      last = ask(port, "PUT", "/v1/session/runs/R" + std::to_string(k) + "/a", answer.dump());
    refuses(last, 507, "the session is full");
    EXPECT_LE(index(port)["bytes"]["used"], 1 << 20);
    EXPECT_EQ(ask(port, "DELETE", "/v1/session/runs/R0").status, 200);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cell/scans"))
    EXPECT_EQ(entry.path().filename(), "a.png");
  const auto without = serve({}, [&](int port) {
    EXPECT_EQ(index(port), Json({{"kept", false}}));
    for (const char* const path : {"/archive", "/scans/a", "/runs/A/a"})
      refuses(ask(port, "GET", std::string("/v1/session") + path), 404, "--session DIR");
  });
  EXPECT_EQ(without.exit_code, 0) << without.error;
}

TEST_F(SessionOfAService, StartsWithWhatIsLeftOfADamagedFolder) {
  const auto first = serve({"--session", "cell"}, [&](int port) {
    EXPECT_EQ(put_scan(port, "a", scan()).status, 200);
    EXPECT_EQ(put_scan(port, "b", scan()).status, 200);
  });
  EXPECT_EQ(first.exit_code, 0) << first.error;
  std::filesystem::remove(folder_ / "cell/scans/b.png");
  std::filesystem::create_directories(folder_ / "cell/runs/A");
  std::ofstream(folder_ / "cell/runs/A/a.json") << R"({"scenes": [{"scene")";
  std::ofstream(folder_ / "cell/manifest.json") << "{";
  std::ofstream(folder_ / "cell/scans/stranger.ply") << "ply";
  std::filesystem::create_symlink("/etc/passwd", folder_ / "cell/scans/link.png");
  std::ofstream(folder_ / "cell/scans/.c.png.1-0.tmp") << "half";
  const auto outcome = serve({"--session", "cell"}, [&](int port) {
    const Json session = index(port);
    ASSERT_EQ(session["scans"].size(), 1U);
    EXPECT_EQ(session["scans"][0]["name"], "a");
    EXPECT_EQ(session["runs"], Json::array());
    std::set<std::string> faulty;
    for (const Json& fault : session["faults"]) faulty.insert(fault["file"]);
    EXPECT_EQ(faulty, (std::set<std::string>{"scans/b.png", "scans/stranger.ply", "scans/link.png",
                                             "runs/A/a.json", "manifest.json"}));
    EXPECT_EQ(put_scan(port, "c", scan()).status, 200);
    const test::Outcome other = trivet({"serve", "l.h5", "--port", "0", "--session", "cell"});
    EXPECT_EQ(other.exit_code, 73) << "one service has a session";
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("runs/A/a.json"), std::string::npos) << "also reported at the start";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "cell/scans/.c.png.1-0.tmp"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "cell/manifest.json.damaged"));
}

TEST_F(SessionOfAService, WritesNothingThroughLinksAndOverNothingOfOthers) {
  namespace fs = std::filesystem;
  const auto first = serve({"--session", "cell"},
                           [&](int port) { EXPECT_EQ(put_scan(port, "a", scan()).status, 200); });
  EXPECT_EQ(first.exit_code, 0) << first.error;
  fs::create_directories(folder_ / "elsewhere");
  std::ofstream(folder_ / "elsewhere/a.json") << "far away";
  std::ofstream(folder_ / "elsewhere/.b.json.1-0.tmp") << "half";
  std::ofstream(folder_ / "target.png") << "far away";
  fs::create_symlink(folder_ / "target.png", folder_ / "cell/scans/link.png");
  std::ofstream(folder_ / "cell/scans/stranger.png") << "mine";
  fs::create_directories(folder_ / "cell/runs");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "cell/runs/A");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "cell/models");
  const auto outcome = serve({"--session", "cell"}, [&](int port) {
    EXPECT_EQ(put_scan(port, "link", scan()).status, 409);
    EXPECT_EQ(put_scan(port, "stranger", scan()).status, 409);
    const std::string answer = R"({"scenes": [{"scene": "a", "detections": []}]})";
    const Answer put = ask(port, "PUT", "/v1/session/runs/A/a", answer);
    EXPECT_EQ(put.status, 500);
    EXPECT_NE(put.body.find("found a link"), std::string::npos) << put.body;
    EXPECT_EQ(ask(port, "PUT", "/v1/session/runs/B/a", answer).status, 200);
    EXPECT_EQ(ask(port, "DELETE", "/v1/session/scans/a").status, 200);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(test::read_bytes(folder_ / "elsewhere/a.json"), "far away");
  EXPECT_EQ(test::read_bytes(folder_ / "elsewhere/.b.json.1-0.tmp"), "half");
  EXPECT_EQ(test::read_bytes(folder_ / "target.png"), "far away");
  EXPECT_EQ(test::read_bytes(folder_ / "cell/scans/stranger.png"), "mine");
}

}  // namespace
}  // namespace trivet
