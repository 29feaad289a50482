#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "engine/common/thread_limit.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/training/provenance.hpp"
#include "engine/training/train.hpp"
#include "engine/training/training_parts.hpp"
#include "engine/training/training_run.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// Coarse training, for speed.
const TrainOptions kFast{.relative_step = 0.1F, .num_samples = 512, .num_components = 8};

class TrainLibrary : public testing::Test {
 protected:
  TrainLibrary() {
    put("bracket", test::bracket());
    put("lever", test::lever());
    put("third", test::bracket(), 1.1F);
  }
  void put(const std::string& name, const test::Shape& shape, float size = 1) {
    Cloud cloud = test::cloud_of(shape);
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      cloud.points.set(i, size * cloud.points[i]);
    EXPECT_TRUE(write_ply(folder_ / (name + ".ply"), cloud));
  }
  /// More models than are ever trained concurrently, since those are finished when a run is
  /// stopped.
  std::vector<std::string> put_many() {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < 6 + 2 * std::thread::hardware_concurrency(); ++k) {
      names.push_back(fmt::format("size_{:03}", k));
      put(names.back(), test::bracket(), 1 + 0.01F * static_cast<float>(k));
    }
    return names;
  }
  ModelSource source(const std::string& name) const {
    return {name, folder_ / (name + ".ply"), 1, {}};
  }
  TrainRequest request(std::vector<std::string> names = {"lever", "bracket", "third"}) const {
    TrainRequest request{{}, LengthUnit::meter, kFast, file_};
    for (const std::string& name : names) request.sources.push_back(source(name));
    return request;
  }
  /// The library from training everything again.
  std::string fresh(const std::vector<std::string>& names) const {
    TrainRequest fresh_request = request(names);
    fresh_request.file = folder_ / "fresh.h5";
    fs::remove(fresh_request.file);
    const auto trained = train_library(fresh_request);
    EXPECT_TRUE(trained) << trained.error().message;
    return test::read_bytes(fresh_request.file);
  }
  std::string bytes() const { return test::read_bytes(file_); }
  bool has_parts() const { return fs::exists(engine::parts_folder(file_)); }
  std::size_t num_entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }

  test::TempDir folder_;
  fs::path file_ = folder_ / "library.h5";
};

std::size_t count(const TrainReport& report, ModelOrigin origin) {
  return static_cast<std::size_t>(std::ranges::count(report.models, origin, &ModelFacts::origin));
}

/// Stops a run after this many models.
struct StopAfter {
  explicit StopAfter(std::size_t number) {
    progress.training.stop = stop.get_token();
    progress.training.report = [this, number](std::size_t, std::size_t, std::string_view item) {
      if (!item.empty() && ++num_done == number) stop.request_stop();
    };
  }
  std::stop_source stop;
  std::size_t num_done = 0;
  TrainProgress progress;
};

TEST_F(TrainLibrary, WritesTheSameBytesForAnyThreadsAndOrder) {
  std::vector<std::string> all;
  for (const unsigned threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    fs::remove(file_);
    TrainRequest wanted = request();
    if (threads == 2) std::ranges::reverse(wanted.sources);
    const auto trained = train_library(wanted);
    ASSERT_TRUE(trained) << trained.error().message;
    all.push_back(bytes());
  }
  EXPECT_EQ(all[0], all[1]);
}

TEST_F(TrainLibrary, ReportsEachModelAndReadsBack) {
  std::vector<std::string> reported;
  TrainProgress progress;
  progress.training.report = [&](std::size_t done, std::size_t total, std::string_view item) {
    EXPECT_EQ(total, 3U);
    EXPECT_EQ(done, reported.size());
    reported.emplace_back(item);
  };
  const auto report = train_library(request(), progress);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(reported.size(), 4U) << "and once at the beginning";
  ASSERT_EQ(report->models.size(), 3U);
  EXPECT_EQ(report->models[0].name, "bracket");
  EXPECT_GT(report->models[0].num_triangles, 0U);
  EXPECT_GT(report->models[0].times.seconds.size(), 3U);

  const auto library = open_library(file_);
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(library->models.size(), 3U);
  EXPECT_EQ(library->models[0].source_xxh3.size(), 32U);
  EXPECT_EQ(library->models[0].fingerprint.size(), 32U);
  EXPECT_FALSE(has_parts());
}

TEST_F(TrainLibrary, TrainsOnlyWhatChanged) {
  ASSERT_TRUE(train_library(request()));
  put("third", test::lever(), 1.3F);
  const auto report = train_library(request());
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(count(*report, ModelOrigin::trained), 1U);
  EXPECT_EQ(count(*report, ModelOrigin::kept), 2U);
  EXPECT_EQ(bytes(), fresh({"lever", "bracket", "third"}));

  const auto again = train_library(request());
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->unchanged);
}

TEST_F(TrainLibrary, ReusesModelsUnderOtherNamesAndFiles) {
  ASSERT_TRUE(train_library(request({"lever"})));
  fs::rename(folder_ / "lever.ply", folder_ / "arm.ply");
  TrainRequest renamed = request({"arm"});
  renamed.prune = true;
  const auto report = train_library(renamed);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(count(*report, ModelOrigin::kept), 1U);
  EXPECT_EQ(bytes(), fresh({"arm"}));
}

// "bolt (1).ply" and "bolt [1].ply" give the same model name.
TEST_F(TrainLibrary, ReplacesNoModelOfAnotherFileThatNobodyNamed) {
  put("bolt (1)", test::bracket());
  put("bolt [1]", test::lever());
  const auto unnamed = [&](const std::string& file) {
    TrainRequest one = request({});
    one.sources.push_back({"bolt_1", folder_ / (file + ".ply"), 1, {}, true});
    return one;
  };
  ASSERT_TRUE(train_library(unnamed("bolt (1)")));
  const std::string before = bytes();
  const auto refused = train_library(unnamed("bolt [1]"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_NE(refused.error().message.find("'bolt_1' is the model of another file, bolt (1).ply"),
            std::string::npos)
      << refused.error().message;
  EXPECT_EQ(bytes(), before);

  put("bolt (1)", test::bracket(), 1.2F);
  EXPECT_TRUE(train_library(unnamed("bolt (1)"))) << "its own file may change";
  EXPECT_NE(bytes(), before);
  TrainRequest named = unnamed("bolt [1]");
  named.sources.front().named_by_file = false;
  EXPECT_TRUE(train_library(named)) << "somebody says so";
}

TEST_F(TrainLibrary, KeepsWhatIsNotNamedUnlessItIsToGo) {
  ASSERT_TRUE(train_library(request({"lever", "bracket"})));
  const auto grown = train_library(request({"third"}));
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_EQ(grown->models.size(), 3U);
  EXPECT_EQ(bytes(), fresh({"lever", "bracket", "third"}));

  TrainRequest pruned = request({"third"});
  pruned.prune = true;
  const auto shrunk = train_library(pruned);
  ASSERT_TRUE(shrunk);
  EXPECT_EQ(shrunk->num_removed, 2U);
  EXPECT_EQ(bytes(), fresh({"third"}));
}

TEST_F(TrainLibrary, MixesNoModelsOfOtherParameters) {
  ASSERT_TRUE(train_library(request({"lever", "bracket"})));
  const std::string before = bytes();
  TrainRequest other = request({"third"});
  other.options.relative_step = 0.12F;
  const auto refused = train_library(other);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_NE(refused.error().message.find("--prune"), std::string::npos) << refused.error().message;
  EXPECT_EQ(bytes(), before);

  other.sources = request().sources;  // all are trained again
  const auto report = train_library(other);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(count(*report, ModelOrigin::trained), 3U);
}

TEST_F(TrainLibrary, GoesOnWithWhatAStoppedRunTrained) {
  const std::vector<std::string> names = put_many();
  const std::size_t num_models = names.size();
  StopAfter one(1);
  const auto stopped = train_library(request(names), one.progress);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::resumable);
  EXPECT_NE(stopped.error().message.find(fmt::format("of {} models", num_models)),
            std::string::npos)
      << stopped.error().message;
  EXPECT_FALSE(fs::exists(file_));
  ASSERT_TRUE(has_parts());

  // Files left by a process that died are no obstacle.
  std::ofstream(engine::parts_folder(file_) / "0-9.h5") << "half a part";
  std::ofstream(engine::parts_folder(file_) / ".0-0.h5.77.0.tmp") << "less";
  std::ofstream(folder_ / ".library.h5.77.0.tmp") << "half a library";
  const auto report = train_library(request(names));
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GE(count(*report, ModelOrigin::resumed), 1U);
  EXPECT_EQ(bytes(), fresh(names));
  EXPECT_FALSE(has_parts());
  EXPECT_EQ(num_entries(), 3 + num_models + 2)
      << "the models and two libraries: no temporary file, no lock";
}

TEST_F(TrainLibrary, LeavesWhatOthersPutBesideItsParts) {
  const std::vector<std::string> names = put_many();
  const fs::path parts = engine::parts_folder(file_), thesis = parts / "documents/thesis.txt";
  fs::create_directories(thesis.parent_path());
  std::ofstream(thesis) << "precious";
  std::ofstream(parts / "notes.h5") << "mine";
  ASSERT_TRUE(train_library(request(names)));
  EXPECT_EQ(test::read_bytes(thesis), "precious");
  EXPECT_EQ(test::read_bytes(parts / "notes.h5"), "mine");
}

TEST_F(TrainLibrary, TrainsAgainWhatAPowerFailureKeptFromTheDisk) {
  const std::vector<std::string> names = put_many();
  const std::string expected = fresh(names);
  for (const bool in_part : {false, true}) {
    fs::remove(file_);
    // A new library is written at once; additions to an existing one are stored in parts.
    if (in_part) {
      ASSERT_TRUE(train_library(request({names.front()})));
    }
    StopAfter one(1);
    ASSERT_FALSE(train_library(request(names), one.progress));
    std::size_t num_damaged = 0;
    for (const auto& entry : fs::directory_iterator(engine::parts_folder(file_))) {
      if (entry.path().extension() != (in_part ? ".h5" : ".models")) continue;
      const std::string bytes = test::read_bytes(entry.path());
      // Zeros, as in blocks that were never written; the beginning of the file is unchanged.
      std::ofstream(entry.path(), std::ios::binary)
          << bytes.substr(0, bytes.size() / 2) << std::string(bytes.size() - bytes.size() / 2, 0);
      ++num_damaged;
    }
    EXPECT_EQ(num_damaged, 1U);
    const auto report = train_library(request(names));
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(count(*report, ModelOrigin::resumed), 0U);
    EXPECT_TRUE(bytes() == expected);
  }
}

TEST_F(TrainLibrary, ReportsAllFaultsTogetherAndKeepsWhatWasTrained) {
  ASSERT_TRUE(train_library(request({"lever"})));
  const std::string before = bytes();
  folder_.write("a_broken.ply", "ply\nformat ascii 1.0\n");
  folder_.write("z_flat.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  TrainRequest wanted = request({"lever", "bracket", "a_broken", "gone"});
  wanted.sources.push_back({"z_flat", folder_ / "z_flat.xyz", 1, {}});
  const auto failed = train_library(wanted);
  ASSERT_FALSE(failed);
  for (const char* const part :
       {"3 of 5", "nothing was written", "a_broken.ply", "gone.ply", "z_flat"})
    EXPECT_NE(failed.error().message.find(part), std::string::npos) << failed.error().message;
  EXPECT_EQ(bytes(), before);

  wanted.keep_going = true;
  const auto report = train_library(wanted);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->faults.size(), 3U);
  EXPECT_EQ(bytes(), fresh({"lever", "bracket"}));
}

TEST_F(TrainLibrary, ReplacesWhatIsNoLibraryOnlyWhenNothingOfItIsToStay) {
  folder_.write("library.h5", "old");
  const auto refused = train_library(request({"lever"}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_data);
  EXPECT_EQ(bytes(), "old");
  TrainRequest pruned = request({"lever"});
  pruned.prune = true;
  ASSERT_TRUE(train_library(pruned));
  EXPECT_EQ(bytes(), fresh({"lever"}));
}

TEST_F(TrainLibrary, HasOneWriterAtATime) {
  const auto first = TrainingRun::begin(request(), {});
  ASSERT_TRUE(first) << first.error().message;
  const auto second = train_library(request());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::cannot_create);
  EXPECT_NE(second.error().message.find("process"), std::string::npos) << second.error().message;
}

TEST_F(TrainLibrary, WarnsOfSizesThatDoNotFit) {
  put("huge", test::bracket(), 1000);
  const auto report = train_library(request({"bracket", "huge", "lever", "third"}));
  ASSERT_TRUE(report);
  for (const ModelFacts& model : report->models) {
    const bool is_warned = std::ranges::any_of(model.warnings, [](const std::string& warning) {
      return warning.find("is the unit right?") != warning.npos;
    });
    EXPECT_EQ(is_warned, model.name == "huge") << model.name;
  }
}

TEST(Fingerprint, ChangesWithAllThatAModelComesFrom) {
  const ModelSource source{"a", "a.ply", 1, {}};
  const std::string hash(32, '0');
  std::vector<std::string> all{engine::fingerprint_of(source, hash, LengthUnit::meter, {})};
  all.push_back(engine::fingerprint_of(source, std::string(32, '1'), LengthUnit::meter, {}));
  all.push_back(engine::fingerprint_of(source, hash, LengthUnit::millimeter, {}));
  all.push_back(engine::fingerprint_of(source, hash, LengthUnit::meter, {.num_samples = 500}));
  ModelSource other = source;
  other.scale = 0.001;
  all.push_back(engine::fingerprint_of(other, hash, LengthUnit::meter, {}));
  other = source;
  other.symmetry = Symmetry{};
  all.push_back(engine::fingerprint_of(other, hash, LengthUnit::meter, {}));
  other.symmetry->axis = Symmetry::Axis{};
  all.push_back(engine::fingerprint_of(other, hash, LengthUnit::meter, {}));
  other = source;
  other.file = "a.obj";
  all.push_back(engine::fingerprint_of(other, hash, LengthUnit::meter, {}));
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end());

  other = source;
  other.name = "b";
  other.file = "folder/b.PLY";
  EXPECT_EQ(engine::fingerprint_of(other, hash, LengthUnit::meter, {}),
            engine::fingerprint_of(source, hash, LengthUnit::meter, {}));
}

TEST(Parameters, AreReadAsTheyWereWritten) {
  const auto read = engine::parse_parameters(engine::parameters_json(kFast));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, kFast);
  EXPECT_FALSE(engine::parse_parameters("{}"));
  EXPECT_FALSE(engine::parse_parameters("nothing"));
}

class EditLibrary : public TrainLibrary {
 protected:
  EditLibrary() { EXPECT_TRUE(train_library(request())); }
};

TEST_F(EditLibrary, RemovesModels) {
  const std::vector<std::string> names{"bracket", "third"};
  ASSERT_TRUE(remove_models(file_, names));
  EXPECT_EQ(bytes(), fresh({"lever"}));
  const std::vector<std::string> missing{"bracket"}, last{"lever"};
  EXPECT_EQ(remove_models(file_, missing).error().code, ErrorCode::usage);
  EXPECT_EQ(remove_models(file_, last).error().code, ErrorCode::usage);
  EXPECT_EQ(bytes(), fresh({"lever"}));
}

TEST_F(EditLibrary, RenamesAModelInTheOrderOfNames) {
  ASSERT_TRUE(rename_model(file_, "bracket", "zebra"));
  const auto library = open_library(file_);
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(library->models.back().name, "zebra");
  EXPECT_EQ(rename_model(file_, "zebra", "lever").error().code, ErrorCode::usage);
  EXPECT_EQ(rename_model(file_, "none", "other").error().code, ErrorCode::usage);
  EXPECT_FALSE(rename_model(file_, "zebra", "not/a name"));
  ASSERT_TRUE(rename_model(file_, "zebra", "bracket"));
  EXPECT_EQ(bytes(), fresh({"lever", "bracket", "third"}));
}

TEST_F(EditLibrary, MergesLibrariesThatWereTrainedAlike) {
  TrainRequest one = request({"lever", "bracket"}), two = request({"lever", "third"});
  one.file = folder_ / "one.h5";
  two.file = folder_ / "two.h5";
  ASSERT_TRUE(train_library(one));
  ASSERT_TRUE(train_library(two));
  const std::vector<fs::path> files{one.file, two.file};
  ASSERT_TRUE(merge_libraries(files, folder_ / "merged.h5"));
  EXPECT_EQ(test::read_bytes(folder_ / "merged.h5"), bytes());

  put("lever", test::lever(), 2);
  ASSERT_TRUE(train_library(two));
  EXPECT_EQ(merge_libraries(files, folder_ / "merged.h5").error().code, ErrorCode::usage);
  two.options.num_samples = 300;
  ASSERT_TRUE(train_library(two));
  const auto differing = merge_libraries(files, folder_ / "merged.h5");
  ASSERT_FALSE(differing);
  EXPECT_EQ(differing.error().code, ErrorCode::usage);
  EXPECT_NE(differing.error().message.find("the parameters {\"samples\":300.0}"), std::string::npos)
      << differing.error().message;
}

TEST_F(EditLibrary, ReportsWhatChanged) {
  const auto before = open_library(file_);
  ASSERT_TRUE(before);
  ASSERT_TRUE(rename_model(file_, "bracket", "angle"));
  put("third", test::lever(), 2);
  put("fourth", test::lever(), 3);
  ASSERT_TRUE(train_library(request({"third", "fourth"})));
  const auto after = open_library(file_);
  ASSERT_TRUE(after);
  const LibraryDifference found = compare_libraries(*before, *after);
  EXPECT_EQ(found.added, std::vector<std::string>{"fourth"});
  EXPECT_EQ(found.changed, std::vector<std::string>{"third"});
  ASSERT_EQ(found.renamed.size(), 1U);
  EXPECT_EQ(found.renamed[0], (std::pair<std::string, std::string>{"bracket", "angle"}));
  EXPECT_TRUE(found.removed.empty());
  EXPECT_EQ(found.num_same, 1U);
  EXPECT_TRUE(found.same_parameters);
  EXPECT_TRUE(compare_libraries(*after, *after).none());
}

}  // namespace
}  // namespace trivet
