// Clients upload parts to a service, which trains them aside, publishes, renames and removes them.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <tuple>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet::test {
namespace {

namespace fs = std::filesystem;

class PartWorkshop : public ServeFixture {
 protected:
  std::string part(int number) const {
    return read_bytes(folder_ / ("scans/models/obj_00000" + std::to_string(number) + ".ply"));
  }

  /// The part's entry in /v1/parts once no work on it is pending.
  static nlohmann::json settled(int port, const std::string& name) {
    for (int k = 0; k < 3000; ++k) {
      const nlohmann::json answer = ask(port, "GET", "/v1/parts").json();
      for (const nlohmann::json& part : answer["parts"]) {
        if (part["name"] == name && part["state"] != "waiting" && part["state"] != "training")
          return part;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return {};
  }

  static std::vector<std::string> models(int port) {
    std::vector<std::string> names;
    const nlohmann::json answer = ask(port, "GET", "/v1/models").json();
    for (const nlohmann::json& model : answer["models"]) names.push_back(model["name"]);
    return names;
  }

  void train(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"train"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome =
        run_trivet(all, {.folder = folder_.path(), .environment = {}, .watch = {}});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
};

TEST_F(PartWorkshop, PublishesWhatTrainingWouldMake) {
  std::ofstream(folder_ / "nut.ply", std::ios::binary) << part(2);
  const std::vector<std::string> how{"--unit", "mm", "--relative-step", "0.05", "--methods", "ppf"};
  fs::remove(folder_ / "l.h5");
  const auto with = [&](std::vector<std::string> models, const char* file) {
    models.insert(models.end(), how.begin(), how.end());
    models.insert(models.end(), {"-o", file});
    train(models);
  };
  with({"bracket=scans/models/obj_000001.ply"}, "l.h5");
  with({"bracket=scans/models/obj_000001.ply", "nut=nut.ply"}, "both.h5");
  const std::string before = read_bytes(folder_ / "l.h5");
  const Outcome outcome = serve({"--allow-training", "drafts"}, [&](int port) {
    EXPECT_EQ(ask(port, "PUT", "/v1/parts/nut?file=nut.ply&unit=mm", part(2)).status, 202);
    const nlohmann::json draft = settled(port, "nut");
    EXPECT_EQ(draft["state"], "trained") << draft;
    EXPECT_EQ(draft["facts"]["triangles"], 2000);
    EXPECT_EQ(ask(port, "GET", draft["model"]["mesh"]).body.rfind("ply", 0), 0U);
    EXPECT_EQ(read_bytes(folder_ / "l.h5"), before);
    const Answer published = ask(port, "PUT", "/v1/models/nut");
    EXPECT_EQ(published.status, 200) << published.body;
    EXPECT_EQ(published.json()["generation"], 2);
    EXPECT_EQ(models(port), (std::vector<std::string>{"bracket", "nut"}));
    EXPECT_EQ(read_bytes(folder_ / "l.h5"), read_bytes(folder_ / "both.h5"));
    EXPECT_TRUE(ask(port, "GET", "/v1/parts").json()["parts"].empty());

    EXPECT_EQ(ask(port, "PATCH", "/v1/models/nut?name=m8").status, 200);
    EXPECT_EQ(models(port), (std::vector<std::string>{"bracket", "m8"}));
    EXPECT_EQ(ask(port, "PATCH", "/v1/models/m8?name=bracket").status, 409);
    EXPECT_EQ(ask(port, "DELETE", "/v1/models/m8").status, 200);
    EXPECT_EQ(ask(port, "DELETE", "/v1/models/m8").status, 409);
    EXPECT_EQ(read_bytes(folder_ / "l.h5"), before);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(PartWorkshop, RefusesWhatIsNoPartAndGoesOn) {
  const std::string library = read_bytes(folder_ / "l.h5");
  std::string truncated = part(1).substr(0, 3000);
  const Outcome outcome = serve(
      {"--allow-training", "drafts", "--training-mb", "1", "--training-models", "2"},
      [&](int port) {
        const auto bring = [&](const std::string& target, const std::string& body) {
          return ask(port, "PUT", "/v1/parts/" + target, body).status;
        };
        EXPECT_EQ(bring("..%2Fl?file=a.ply&unit=m", part(1)), 400);
        EXPECT_EQ(bring(".hidden?file=a.ply&unit=m", part(1)), 400);
        EXPECT_EQ(bring("a?file=..%2F..%2Fl.h5&unit=m", part(1)), 400);
        EXPECT_EQ(bring("a?file=part.h5&unit=m", part(1)), 400);
        EXPECT_EQ(bring("a?file=a.ply&unit=inch", part(1)), 400);
        EXPECT_EQ(bring("a?file=a.ply&unit=m", std::string((1 << 20) + 1, ' ')), 413);
        EXPECT_EQ(bring("bad?file=bad.ply&unit=mm", truncated), 202);
        const nlohmann::json bad = settled(port, "bad");
        EXPECT_EQ(bad["state"], "failed");
        EXPECT_EQ(bad["error"].get<std::string>().rfind("bad.ply, byte ", 0), 0U) << bad["error"];
        EXPECT_EQ(ask(port, "PUT", "/v1/models/bad").status, 409);
        EXPECT_EQ(ask(port, "PATCH", "/v1/parts/bad").status, 400);
        EXPECT_EQ(ask(port, "DELETE", "/v1/parts/bad").status, 202);
        EXPECT_EQ(ask(port, "DELETE", "/v1/parts/bad").status, 404);
        EXPECT_FALSE(fs::exists(folder_ / "drafts/bad"));
        // One more part than the library may hold.
        EXPECT_EQ(bring("third?file=third.ply&unit=mm", part(1)), 202);
        EXPECT_EQ(settled(port, "third")["state"], "trained");
        EXPECT_EQ(ask(port, "PUT", "/v1/models/third").status, 409);
        EXPECT_EQ(ask(port, "POST", query_, read_bytes(depth_)).status, 200);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(read_bytes(folder_ / "l.h5"), library);
}

TEST_F(PartWorkshop, KeepsDraftsAndTheirDeclarations) {
  const auto declared = [&](int port) {
    return settled(port, "lever")["model"]["symmetry"]["declared"].get<bool>();
  };
  serve({"--allow-training", "drafts"}, [&](int port) {
    EXPECT_EQ(ask(port, "PUT", "/v1/parts/lever?file=bracket.ply&unit=mm", part(1)).status, 202);
    const nlohmann::json model = settled(port, "lever")["model"];
    ASSERT_TRUE(model["near_symmetry"]["declaration"].is_object()) << model;
    EXPECT_FALSE(model["near_symmetry"]["axes"].empty());
    EXPECT_FALSE(declared(port));
    const auto declare = [&](const nlohmann::json& declaration) {
      return ask(port, "PATCH", "/v1/parts/lever", declaration.dump()).status;
    };
    EXPECT_EQ(ask(port, "PATCH", "/v1/parts/lever").status, 400);
    EXPECT_EQ(declare({{"declaration", {{"symmetry", 1}}}}), 400);
    const nlohmann::json turns = ask(port, "GET", "/v1/parts/lever/near-symmetry").json()["turns"];
    ASSERT_FALSE(turns.empty());
    for (const nlohmann::json& turn : turns) {
      EXPECT_LE(turn["deviation"]["median"], turn["deviation"]["p90"]);
      EXPECT_LE(turn["deviation"]["p90"], turn["deviation"]["largest"]);
    }
    const nlohmann::json motions = turns.back()["motions"];
    EXPECT_EQ(declare({{"declaration", {{"symmetries", motions}}}}), 202);
    EXPECT_TRUE(declared(port));
    EXPECT_EQ(declare({{"declaration", nullptr}}), 202);
    EXPECT_FALSE(declared(port)) << "it can be taken back";
    EXPECT_EQ(declare({{"declaration", {{"symmetries", motions}}}}), 202);
    EXPECT_TRUE(declared(port));
  });
  serve({"--allow-training", "drafts"}, [&](int port) { EXPECT_TRUE(declared(port)); });
}

/// All files below a folder with their bytes, and links with their targets.
std::map<std::string, std::string> contents_of(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_symlink()) {
      contents[name] = fs::read_symlink(entry.path()).string();
    } else if (entry.is_regular_file()) {
      contents[name] = read_bytes(entry.path());
    }
  }
  return contents;
}

TEST_F(PartWorkshop, TouchesNoFolderOfOthers) {
  serve({"--allow-training", "drafts"}, [](int) {});  // marks the folder as the service's
  fs::create_directories(folder_ / "drafts/Documents/deep");
  std::ofstream(folder_ / "drafts/Documents/deep/thesis.txt") << "precious";
  std::ofstream(folder_ / "drafts/Documents/part.h5") << "not of a part";
  std::ofstream(folder_ / "drafts/file") << "no folder";
  fs::create_directories(folder_ / "elsewhere");
  std::ofstream(folder_ / "elsewhere/part.h5") << "far away";
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "drafts/link");
  // The state that an earlier version, or a copy of a part, would have left.
  fs::create_directories(folder_ / "drafts/unmarked");
  std::ofstream(folder_ / "drafts/unmarked/manifest.json") << "{}";
  const auto before = contents_of(folder_ / "drafts");
  const auto outcome = serve({"--allow-training", "drafts"}, [&](int port) {
    for (const char* const name : {"Documents", "file", "link", "unmarked"}) {
      const std::string target = std::string("/v1/parts/") + name;
      for (const char* const file : {"x.ply", "part.h5", "thesis.txt", "manifest.json"}) {
        const int status = ask(port, "PUT", target + "?file=" + file + "&unit=mm", "junk").status;
        EXPECT_TRUE(status == 409 || status == 400) << target << " " << file << ": " << status;
      }
      const Answer put = ask(port, "PUT", target + "?file=x.ply&unit=mm", "junk");
      EXPECT_EQ(put.status, 409) << target;
      EXPECT_NE(put.body.find(".trivet-part"), std::string::npos) << put.body;
      EXPECT_EQ(ask(port, "DELETE", target).status, 409) << target;
    }
    EXPECT_EQ(ask(port, "DELETE", "/v1/parts/none").status, 404);
    EXPECT_EQ(ask(port, "GET", "/v1/parts").json()["parts"].size(), 0U);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(contents_of(folder_ / "drafts"), before);
  EXPECT_EQ(read_bytes(folder_ / "elsewhere/part.h5"), "far away");
}

TEST_F(PartWorkshop, RemovesOnlyWhatItHasMade) {
  fs::create_directories(folder_ / "elsewhere");
  std::ofstream(folder_ / "elsewhere/0-0.h5") << "far away";
  const auto outcome = serve({"--allow-training", "drafts"}, [&](int port) {
    const std::string lever = "/v1/parts/lever?file=lever.ply&unit=mm";
    EXPECT_EQ(ask(port, "PUT", lever, part(1)).status, 202);
    EXPECT_EQ(settled(port, "lever")["state"], "trained");
    fs::create_directories(folder_ / "drafts/lever/mine/deep");
    std::ofstream(folder_ / "drafts/lever/mine/deep/notes.txt") << "precious";
    fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "drafts/lever/part.h5.parts");
    EXPECT_EQ(ask(port, "DELETE", "/v1/parts/lever").status, 202);
    for (const char* const file : {"lever.ply", "part.h5", "part.json", "manifest.json"})
      EXPECT_FALSE(fs::exists(folder_ / "drafts/lever" / file)) << file;
    EXPECT_EQ(read_bytes(folder_ / "drafts/lever/mine/deep/notes.txt"), "precious");
    EXPECT_EQ(read_bytes(folder_ / "elsewhere/0-0.h5"), "far away");
    // The folder still belongs to the workshop, which trains nothing through a link.
    EXPECT_EQ(ask(port, "PUT", lever, part(1)).status, 202);
    EXPECT_EQ(settled(port, "lever")["state"], "failed");
    EXPECT_EQ(ask(port, "PUT", "/v1/parts/lever?file=mine&unit=mm", part(1)).status, 400);
    EXPECT_EQ(read_bytes(folder_ / "drafts/lever/mine/deep/notes.txt"), "precious");
    fs::remove(folder_ / "drafts/lever/part.h5.parts");
    fs::remove_all(folder_ / "drafts/lever/mine");
    EXPECT_EQ(ask(port, "PUT", lever, part(1)).status, 202);
    EXPECT_EQ(settled(port, "lever")["state"], "trained");
    EXPECT_EQ(ask(port, "DELETE", "/v1/parts/lever").status, 202);
    EXPECT_FALSE(fs::exists(folder_ / "drafts/lever"));
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(PartWorkshop, StartsOnlyInAFolderOfItsOwn) {
  fs::create_directories(folder_ / "home/Documents");
  std::ofstream(folder_ / "home/letter.txt") << "Dear";
  const auto before = contents_of(folder_ / "home");
  for (const auto& [option, marker, line] :
       {std::tuple{"--allow-training", ".trivet-parts", "trivet parts 1"},
        std::tuple{"--session", ".trivet-session", "trivet session 1"}}) {
    const Outcome refused = serve({option, "home"}, [](int) { ADD_FAILURE() << "it serves"; });
    EXPECT_EQ(refused.exit_code, 73) << refused.error;
    EXPECT_EQ(serve({option, "home", "--check-config"}, [](int) {}).exit_code, 73);
    EXPECT_NE(refused.error.find(std::string("echo '") + line + "' > home/" + marker),
              std::string::npos)
        << refused.error;
    EXPECT_EQ(contents_of(folder_ / "home"), before);
    std::ofstream(folder_ / "home" / marker) << line << " of another kind\n";
    EXPECT_EQ(serve({option, "home"}, [](int) {}).exit_code, 73) << "a version of the future";
    std::ofstream(folder_ / "home" / marker) << line << "\n";
    EXPECT_EQ(serve({option, "home"}, [](int) {}).exit_code, 0) << "marked as it was told";
    fs::remove(folder_ / "home" / marker);
    fs::remove(folder_ / "home/scans.json");
    fs::remove(folder_ / "home/manifest.json");
    // A separate file system, through a link.
    fs::create_directories(folder_ / "disk/lost+found");
    fs::create_directory_symlink(folder_ / "disk", folder_ / "mounted");
    EXPECT_EQ(serve({option, "mounted"}, [](int) {}).exit_code, 0);
    EXPECT_EQ(read_bytes(folder_ / "disk" / marker), std::string(line) + "\n");
    fs::remove_all(folder_ / "disk");
    fs::remove(folder_ / "mounted");
  }
  EXPECT_EQ(contents_of(folder_ / "home"), before);
}

TEST_F(PartWorkshop, IsClosedUnlessItIsAllowed) {
  serve({}, [&](int port) {
    EXPECT_EQ(ask(port, "GET", "/v1/parts").json(), (nlohmann::json{{"allowed", false}}));
    EXPECT_EQ(ask(port, "PUT", "/v1/parts/a?file=a.ply&unit=m", part(1)).status, 403);
    EXPECT_EQ(ask(port, "DELETE", "/v1/models/bracket_0").status, 403);
    EXPECT_EQ(ask(port, "PATCH", "/v1/models/bracket_0?name=b").status, 403);
    EXPECT_EQ(models(port).size(), 2U);
  });
}

}  // namespace
}  // namespace trivet::test
