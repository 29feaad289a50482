// An error in a workshop's thread ends the current task and nothing else.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "apps/service/http_client.hpp"
#include "apps/service/serve/library/model_views.hpp"
#include "apps/service/serve/workshop/part_workshop.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/library/library.hpp"
#include "support/allocations.hpp"

namespace trivet::apps::service {
namespace {

namespace fs = std::filesystem;

class WorkshopThread : public test::ServeFixture {
 protected:
  void SetUp() override {
    ServeFixture::SetUp();
    mesh_ = test::read_bytes(folder_ / "scans/models/obj_000001.ply");
  }

  void open(const std::string& program, PartWorkshop::Reload reload) {
    WorkshopSettings settings;
    settings.folder = (folder_ / "drafts").string();
    settings.program = program;
    auto opened = PartWorkshop::open(settings, folder_ / "l.h5", std::move(reload), log_);
    ASSERT_TRUE(opened) << opened.error().message;
    workshop_ = *std::move(opened);
    workshop_->start();
  }

  /// Renames a model of the library to an unused name.
  Result<void> rename() {
    const Result<Library> library = open_library(folder_ / "l.h5");
    EXPECT_TRUE(library);
    std::string to = "renamed";
    while (find_model(*library, to)) to += "_again";
    auto result = std::make_shared<std::promise<Result<void>>>();
    workshop_->rename(library->models.front().name, to,
                      [result](const Result<void>& done) { result->set_value(done); });
    return result->get_future().get();
  }

  /// The status of a newly uploaded part.
  DraftStatus bring() {
    const Result<void> brought = workshop_->bring("part", "part.ply", LengthUnit::meter, mesh_);
    EXPECT_TRUE(brought) << brought.error().message;
    DraftStatus part;
    EXPECT_TRUE(test::comes([&] {
      const std::vector<DraftStatus> drafts = workshop_->drafts();
      if (!drafts.empty()) part = drafts.front();
      return part.state == DraftState::trained || part.state == DraftState::failed;
    }));
    return part;
  }

  RequestLog log_{-1};
  std::unique_ptr<PartWorkshop> workshop_;
  std::string mesh_;
};

TEST_F(WorkshopThread, AnswersWhatAnExceptionHasEnded) {
  int num_reloads = 0;
  open("/bin/true", [&](const std::function<void(Result<void>)>& done) {
    if (++num_reloads == 1) throw std::bad_alloc();
    if (num_reloads == 2)
      throw fs::filesystem_error("disk", std::make_error_code(std::errc::io_error));
    done({});
  });
  const Result<void> no_memory = rename();
  ASSERT_FALSE(no_memory);
  EXPECT_EQ(no_memory.error().message, "out of memory");
  const Result<void> no_disk = rename();
  ASSERT_FALSE(no_disk);
  EXPECT_NE(no_disk.error().message.find("disk"), std::string::npos) << no_disk.error().message;
  EXPECT_TRUE(rename()) << "and goes on";
}

TEST_F(WorkshopThread, FailsOnlyTheTrainingThatHasNoMemory) {
  // The result of a training, created at once.
  fs::create_directory(folder_ / "made");
  const test::Outcome trained =
      test::run_trivet({"train", "part=scans/models/obj_000001.ply", "--unit", "mm", "--methods",
                        "ppf", "-o", "made/part.h5", "--json", "made/part.json"},
                       {.folder = folder_.path(), .environment = {}, .watch = {}});
  ASSERT_EQ(trained.exit_code, 0) << trained.error;
  const std::string made = (folder_ / "made").string();
  folder_.write("train",
                "#!/bin/sh\ncp " + made + "/part.h5 \"$4\"\ncp " + made + "/part.json \"$6\"\n");
  fs::permissions(folder_ / "train", fs::perms::owner_all);
  std::size_t failing = 0;
  open((folder_ / "train").string(), [&](const std::function<void(Result<void>)>& done) {
    done({});
    // Allocations of the training thread. The destructor of JSON values allocates less than this
    // size, and a failure there ends the program.
    test::fail_own_allocation(failing, 1024);
  });
  std::size_t num_failed = 0;
  for (failing = 1; num_failed + 1 == failing; ++failing) {
    ASSERT_TRUE(rename());
    const DraftStatus part = bring();
    if (part.state == DraftState::trained) break;
    EXPECT_NE(part.error, "") << failing;
    ++num_failed;
  }
  EXPECT_GT(num_failed, 2U);
  failing = 0;
  (void)rename();  // may lack memory: receives the failure left over from training
  ASSERT_TRUE(rename());
  EXPECT_EQ(bring().state, DraftState::trained);
}

}  // namespace
}  // namespace trivet::apps::service
