/// Changes that `trivet library` makes from the command line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class LibraryChanges : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TempDir>();
    ASSERT_TRUE(write_ply(*folder_ / "bracket.ply", test::cloud_of(test::bracket())));
    ASSERT_TRUE(write_ply(*folder_ / "lever.ply", test::cloud_of(test::lever())));
    does({"train", "bracket.ply", "lever.ply", "-o", "library.h5", "--preset", "fast"});
    bytes_ = bytes("library.h5");
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { folder_->write("library.h5", bytes_); }

  static test::Outcome run(const std::vector<std::string>& arguments) {
    return test::run_trivet(arguments, {.folder = folder_->path(), .environment = {}, .watch = {}});
  }
  /// Returns its standard output.
  static std::string does(const std::vector<std::string>& arguments) {
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << testing::PrintToString(arguments) << outcome.error;
    return outcome.out;
  }
  static void fails(const std::vector<std::string>& arguments, const std::string& message) {
    const test::Outcome outcome = run(arguments);
    EXPECT_NE(outcome.exit_code, 0) << testing::PrintToString(arguments);
    EXPECT_NE(outcome.error.find(message), std::string::npos) << outcome.error;
    EXPECT_TRUE(bytes("library.h5") == bytes_);
  }
  static std::string bytes(const std::string& name) { return test::read_bytes(*folder_ / name); }

  static inline std::unique_ptr<test::TempDir> folder_;
  static inline std::string bytes_;
};

TEST_F(LibraryChanges, RemoveAndAddModels) {
  does({"library", "remove", "library.h5", "lever"});
  EXPECT_EQ(does({"library", "list", "library.h5"}), "bracket\n");
  does({"library", "add", "library.h5", "lever.ply"});
  EXPECT_TRUE(bytes("library.h5") == bytes_);
  fails({"library", "remove", "library.h5", "handle"}, "handle");
}

TEST_F(LibraryChanges, RenameAModel) {
  folder_->write("before.h5", bytes_);
  does({"library", "rename", "library.h5", "bracket", "arm"});
  EXPECT_EQ(does({"library", "list", "library.h5"}), "arm\nlever\n");
  EXPECT_EQ(does({"library", "diff", "before.h5", "library.h5"}),
            "renamed  bracket to arm\n1 model is the same\n");
  does({"library", "rename", "library.h5", "arm", "bracket"});
  EXPECT_TRUE(bytes("library.h5") == bytes_);
  fails({"library", "rename", "library.h5", "bracket", "lever"}, "lever");
  fails({"library", "rename", "library.h5", "handle", "arm"}, "handle");
}

TEST_F(LibraryChanges, MergeWhatWasSplit) {
  for (const std::string file : {"one.h5", "other.h5"}) folder_->write(file, bytes_);
  does({"library", "remove", "one.h5", "bracket"});
  does({"library", "remove", "other.h5", "lever"});
  does({"library", "merge", "one.h5", "other.h5", "-o", "merged.h5"});
  EXPECT_TRUE(bytes("merged.h5") == bytes_);
}

TEST_F(LibraryChanges, ExportWhatTrainsToTheSame) {
  // Training drops triangles without area, which some of these shapes have. The first exported
  // surfaces thus differ from the trained files, but all later ones are equal.
  const auto export_and_train = [](const std::string& from, const std::string& surfaces,
                                   const std::string& to) {
    for (const std::string name : {"bracket", "lever"})
      does({"library", "export", from, name, "-o", surfaces});
    does({"train", surfaces + "/bracket.ply", surfaces + "/lever.ply", "-o", to, "--preset",
          "fast"});
  };
  export_and_train("library.h5", "first", "again.h5");
  export_and_train("again.h5", "second", "third.h5");
  EXPECT_NE(does({"library", "diff", "again.h5", "third.h5"}).find("2 models are the same"),
            std::string::npos);
}

TEST_F(LibraryChanges, VerifyReportsDamage) {
  EXPECT_NE(does({"library", "verify", "library.h5"}).find("2 models"), std::string::npos);
  std::string damaged = bytes_;
  damaged[damaged.size() / 2] ^= 1;
  folder_->write("damaged.h5", damaged);
  fails({"library", "verify", "damaged.h5"}, "damaged.h5");
}

TEST_F(LibraryChanges, FamiliesPrintWhichModelsAreNearCopiesAndWhereTheyDiffer) {
  EXPECT_EQ(does({"library", "families", "library.h5"}),
            "No two models are near copies of each other\n");
  const test::Shape post =
      test::bracket().join(test::box({-0.02F, 0.02F, 0.02F}, {-0.01F, 0.03F, 0.027F}));
  ASSERT_TRUE(write_ply(*folder_ / "post.ply", test::cloud_of(post)));
  does({"library", "add", "library.h5", "post.ply"});
  const std::string text = does({"library", "families", "library.h5"});
  EXPECT_EQ(text.rfind("bracket, post\n  bracket and post differ by up to ", 0), 0U) << text;
  const auto json =
      nlohmann::json::parse(does({"library", "families", "library.h5", "--json", "-"}));
  ASSERT_EQ(json["families"].size(), 1U);
  EXPECT_EQ(json["families"][0]["models"], (nlohmann::json{"bracket", "post"}));
  EXPECT_GT(json["families"][0]["pairs"][0]["deviation"], 0.0);
  EXPECT_EQ(does({"library", "families", "library.h5", "--deviation", "0"}),
            "No two models are near copies of each other\n");
}

}  // namespace
}  // namespace trivet
