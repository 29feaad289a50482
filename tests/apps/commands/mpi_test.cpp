/// trivet-mpi with several ranks on this machine gives the same bytes as one process, and ends when
/// a rank dies.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

class Mpi : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    fs::create_directory(*folder_ / "models");
    for (int i = 0; i < 8; ++i) {
      Cloud cloud = test::cloud_of(i % 2 == 0 ? test::bracket() : test::lever());
      const float size = 1 + 0.1F * static_cast<float>(i);
      for (std::size_t p = 0; p < cloud.points.size(); ++p)
        cloud.points.set(p, size * cloud.points[p]);
      ASSERT_TRUE(write_ply(*folder_ / ("models/m" + std::to_string(i) + ".ply"), cloud));
    }
    const Shape bracket = test::bracket();
    const Pose pose = test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F});
    ASSERT_TRUE(write_ply(*folder_ / "a.ply", test::render_scan({{&bracket, pose}})));
    ASSERT_TRUE(write_ply(*folder_ / "b.ply", test::render_scan({{&bracket, pose}})));
    ASSERT_EQ(test::run_trivet(train_arguments("one.h5"), here()).exit_code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override {
    if (std::string(TRIVET_MPI_PROGRAM).empty()) GTEST_SKIP() << "needs -DTRIVET_BUILD_MPI=ON";
  }

  using Shape = test::Shape;
  static test::Setting here(const std::function<void(pid_t, const std::string&)>& watch = {}) {
    return {.folder = folder_->path(), .environment = {}, .watch = watch};
  }
  static std::vector<std::string> train_arguments(const std::string& library) {
    return {"train", "models",    "-o",  library,     "--preset",
            "fast",  "--samples", "512", "--threads", "1"};
  }
  static test::Outcome run(int num_ranks, const std::vector<std::string>& arguments,
                           const std::function<void(pid_t, const std::string&)>& watch = {}) {
    std::vector<std::string> all{
        "--allow-run-as-root",     "--oversubscribe", "--bind-to", "none", "-n",
        std::to_string(num_ranks), TRIVET_MPI_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return test::run_program(TRIVET_MPIRUN, all, here(watch));
  }
  static std::string bytes(const std::string& name) { return test::read_bytes(*folder_ / name); }
  static nlohmann::json results(const std::string& name) {
    nlohmann::json json = nlohmann::json::parse(bytes(name));
    for (nlohmann::json& scene : json["scenes"]) scene.erase("seconds");
    return json;
  }

  static inline std::unique_ptr<test::TempDir> folder_;
};

TEST_F(Mpi, TrainsTheSameBytesWithAnyNumberOfRanks) {
  for (const int ranks : {1, 2, 3}) {
    fs::remove(*folder_ / "many.h5");
    const test::Outcome trained = run(ranks, train_arguments("many.h5"));
    ASSERT_EQ(trained.exit_code, 0) << trained.error;
    EXPECT_TRUE(bytes("many.h5") == bytes("one.h5")) << ranks;
    EXPECT_FALSE(fs::exists(*folder_ / "many.h5.parts"));
  }
}

TEST_F(Mpi, EndsWhenARankDiesAndGoesOn) {
  fs::remove(*folder_ / "killed.h5");
  std::optional<Clock::time_point> killed;
  const test::Outcome outcome =
      run(2, train_arguments("killed.h5"), [&](pid_t mpirun, const std::string& error) {
        if (killed || error.find("trained 2/8") == std::string::npos) return;
        const std::string pid = std::to_string(mpirun);
        std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
        pid_t rank = 0;
        for (pid_t child = 0; children >> child;) rank = child;  // the last one
        ASSERT_GT(rank, 0);
        ::kill(rank, SIGKILL);
        killed = Clock::now();
      });
  ASSERT_TRUE(killed);
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_LT(Clock::now() - *killed, std::chrono::seconds(10));
  EXPECT_FALSE(fs::exists(*folder_ / "killed.h5"));
  ASSERT_EQ(run(2, train_arguments("killed.h5")).exit_code, 0);
  EXPECT_TRUE(bytes("killed.h5") == bytes("one.h5"));
}

TEST_F(Mpi, ReportsAllModelsThatCannotBeTrained) {
  folder_->write("broken.ply", "ply\n");
  std::vector<std::string> arguments = train_arguments("none.h5");
  arguments.insert(arguments.end(), {"broken.ply", "gone=nowhere.ply"});
  const test::Outcome outcome = run(2, arguments);
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.error.find("nowhere.ply"), std::string::npos) << outcome.error;
}

TEST_F(Mpi, RecognizesWhatOneProcessDoes) {
  const std::vector<std::string> scenes{"recognize", "one.h5", "a.ply", "b.ply", "--json"};
  std::vector<std::string> alone = scenes, shared = scenes;
  alone.emplace_back("alone.json");
  shared.emplace_back("shared.json");
  ASSERT_EQ(test::run_trivet(alone, here()).exit_code, 0);
  const test::Outcome outcome = run(2, shared);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(results("alone.json"), results("shared.json"));
  EXPECT_EQ(run(2, {"recognize", "one.h5", "a.ply"}).exit_code, 2) << "without --json";
}

}  // namespace
}  // namespace trivet
