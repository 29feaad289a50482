/// Training is killed, stopped, or finds the disk full at any moment. The library then has its old
/// or its final content, and the same command resumes.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <random>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A library of three models, to which training adds three more and a change; or a new library,
/// which is written ahead.
class InterruptedTraining : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    for (int i = 0; i < 3; ++i)
      put("m" + std::to_string(i), test::bracket(), 1 + 0.1F * static_cast<float>(i));
    ASSERT_EQ(train({"m0.ply", "m1.ply", "m2.ply"}).exit_code, 0);
    before_ = bytes();
    put("m1", test::lever(), 1.5F);
    for (int i = 3; i < 6; ++i)
      put("m" + std::to_string(i), test::lever(), 1 + 0.1F * static_cast<float>(i));
    const auto start = Clock::now();
    ASSERT_EQ(train_all().exit_code, 0);
    seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
    after_ = bytes();
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { reset(); }

  static void put(const std::string& name, const test::Shape& shape, float size) {
    Cloud cloud = test::cloud_of(shape);
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      cloud.points.set(i, size * cloud.points[i]);
    ASSERT_TRUE(write_ply(*folder_ / (name + ".ply"), cloud));
  }
  static test::Outcome train(std::vector<std::string> arguments,
                             const std::vector<std::string>& environment = {},
                             const std::function<void(pid_t, const std::string&)>& watch = {}) {
    arguments.insert(arguments.begin(), "train");
    arguments.insert(arguments.end(), {"-o", "library.h5", "--preset", "fast", "--samples", "512"});
    return test::run_trivet(
        arguments, {.folder = folder_->path(), .environment = environment, .watch = watch});
  }
  static test::Outcome train_all(const std::vector<std::string>& environment = {},
                                 const std::function<void(pid_t, const std::string&)>& watch = {}) {
    std::vector<std::string> all;
    for (int i = 0; i < 6; ++i) all.push_back("m" + std::to_string(i) + ".ply");
    return train(all, environment, watch);
  }
  static std::string bytes() { return test::read_bytes(*folder_ / "library.h5"); }
  /// Restores the earlier library, or none, with nothing beside it.
  static void reset(bool from_nothing = false) {
    fs::remove_all(*folder_ / "library.h5.parts");
    if (from_nothing) {
      fs::remove(*folder_ / "library.h5");
    } else {
      folder_->write("library.h5", before_);
    }
    from_nothing_ = from_nothing;
  }
  static void expect_complete(const std::string& context) {
    if (from_nothing_ && !fs::exists(*folder_ / "library.h5")) return;
    const std::string now = bytes();
    EXPECT_TRUE((now == before_ && !from_nothing_) || now == after_) << context;
  }
  static void expect_done_by_the_same_command(const std::string& context) {
    const test::Outcome resumed = train_all();
    ASSERT_EQ(resumed.exit_code, 0) << context << resumed.error;
    EXPECT_TRUE(bytes() == after_) << context;
    for (const auto& entry : fs::directory_iterator(folder_->path())) {
      const std::string name = entry.path().filename().string();
      EXPECT_TRUE(name.ends_with(".ply") || name == "library.h5") << context << name;
    }
  }

  static inline std::unique_ptr<test::TempDir> folder_;
  static inline std::string before_, after_;
  static inline double seconds_ = 0;
  static inline bool from_nothing_ = false;
};

TEST_F(InterruptedTraining, GoesOnAfterBeingKilledAtAnyMoment) {
  constexpr int kKills = 12;
  std::mt19937 random(1);
  for (int k = 0; k < kKills; ++k) {
    if (k % 2 == 0) reset(k % 4 == 0);  // otherwise a resumed run is killed again
    const double at = std::uniform_real_distribution<>(0, seconds_)(random);
    const auto start = Clock::now();
    train_all({}, [&](pid_t program, const std::string&) {
      if (std::chrono::duration<double>(Clock::now() - start).count() >= at)
        ::kill(program, SIGKILL);
    });
    const std::string context = "killed after " + std::to_string(at) + " s: ";
    expect_complete(context);
    if (k % 2 == 1) expect_done_by_the_same_command(context);
  }
}

TEST_F(InterruptedTraining, SaysHowFarItCameWhenItIsStopped) {
  bool stopped = false;
  const test::Outcome outcome = train_all({}, [&](pid_t program, const std::string& error) {
    if (stopped || error.find("trained 3/6") == std::string::npos) return;
    stopped = true;
    ::kill(program, SIGINT);
  });
  ASSERT_EQ(outcome.exit_code, 75) << outcome.error;
  EXPECT_NE(outcome.error.find("of 6 models"), std::string::npos) << outcome.error;
  EXPECT_TRUE(bytes() == before_);
  expect_done_by_the_same_command("");
}

TEST_F(InterruptedTraining, GoesOnWhenAFullDiskIsNotFullAnyMore) {
  if (std::string(TRIVET_FAILING_WRITES).empty()) GTEST_SKIP() << "not with sanitizers";
  const std::string preload = std::string("LD_PRELOAD=") + TRIVET_FAILING_WRITES;
  for (const bool from_nothing : {false, true}) {
    reset(from_nothing);
    const test::Outcome counted = train_all({preload, "COUNT_TO=" + (*folder_ / "count").string()});
    ASSERT_EQ(counted.exit_code, 0) << counted.error;
    const long num_calls = std::stol(test::read_bytes(*folder_ / "count"));
    fs::remove(*folder_ / "count");
    ASSERT_GT(num_calls, 100);
    constexpr int kPlaces = 10;
    for (int k = 0; k < kPlaces; ++k) {
      reset(from_nothing);
      // The last calls are the most critical, so all of them are tested.
      const long from =
          k < kPlaces / 2 ? 1 + num_calls * k / (kPlaces / 2) : num_calls - (kPlaces - 1 - k);
      const test::Outcome failed = train_all({preload, "FAIL_FROM=" + std::to_string(from)});
      const std::string context =
          "call " + std::to_string(from) + " of " + std::to_string(num_calls) + ": " + failed.error;
      EXPECT_TRUE(failed.exit_code == 74 || failed.exit_code == 73) << failed.exit_code << context;
      EXPECT_NE(failed.error.find("error: "), std::string::npos) << context;
      expect_complete(context);
      expect_done_by_the_same_command(context);
    }
  }
}

TEST_F(InterruptedTraining, TakesAFailedCopyOfAMappedLibraryForNoDamage) {
  if (std::string(TRIVET_FAILING_WRITES).empty()) GTEST_SKIP() << "not with sanitizers";
  const test::Outcome failed =
      train_all({std::string("LD_PRELOAD=") + TRIVET_FAILING_WRITES, "FAIL_IN_MEMORY=1"});
  EXPECT_EQ(failed.exit_code, 74) << failed.error;
  EXPECT_NE(failed.error.find("copy of a mapped file"), std::string::npos) << failed.error;
  expect_complete(failed.error);
  expect_done_by_the_same_command(failed.error);
}

}  // namespace
}  // namespace trivet
