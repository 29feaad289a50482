/// Recognizing the cells of a study gives the same results as separate recognition.
#include "engine/evaluation/recognize_cells.hpp"

#include <gtest/gtest.h>

#include <mutex>

#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "engine/scene/read_scene.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "engine/training/train.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// Two parts, three scenes that contain them, and two libraries.
class RecognizeCells : public testing::Test {
 protected:
  void SetUp() override {
    ScanOptions options;
    options.num_scenes = 3;
    options.num_instances = 2;
    options.sensor.sensor = Sensor::laser;
    const Result<Manifest> rendered =
        render_scenes(make_scan_models(2, 3), LengthUnit::meter, options, folder_ / "scenes", {});
    ASSERT_TRUE(rendered) << rendered.error().message;
    scenes_ = scenes_of(*rendered, LengthUnit::meter);
    for (const float step : {0.05F, 0.07F}) {
      TrainOptions train;
      train.relative_step = step;
      train.tri_spin_images = false;
      files_.push_back(folder_ / fmt::format("{}.h5", step));
      const Result<TrainReport> trained =
          train_library({models_of(*rendered), LengthUnit::meter, train, files_.back()});
      ASSERT_TRUE(trained) << trained.error().message;
    }
  }

  /// Every scene with both libraries, without and with noise.
  std::vector<RecognitionCell> all_cells() const {
    std::vector<RecognitionCell> cells;
    RecognizeOptions options;
    options.method = Method::ppf;
    for (std::size_t library = 0; library < files_.size(); ++library) {
      for (const float noise : {0.0F, 0.5F}) {
        for (std::size_t s = 0; s < scenes_.size(); ++s)
          cells.push_back({library, scenes_[s], {.noise = noise}, 7 + s, options});
      }
    }
    return cells;
  }

  const test::TempDir folder_;
  std::vector<SceneInput> scenes_;
  std::vector<std::filesystem::path> files_;
};

void expect_same(const SceneResult& a, const SceneResult& b) {
  ASSERT_EQ(a.detections.size(), b.detections.size());
  for (std::size_t i = 0; i < a.detections.size(); ++i) {
    EXPECT_EQ(a.detections[i].model, b.detections[i].model);
    EXPECT_EQ(a.detections[i].score, b.detections[i].score);
    EXPECT_EQ(a.detections[i].T_scene_model.matrix(), b.detections[i].T_scene_model.matrix());
  }
}

TEST_F(RecognizeCells, GivesWhatEachRecognitionGivesByItself) {
  const std::vector<RecognitionCell> cells = all_cells();
  std::vector<std::optional<SceneResult>> results(cells.size());
  const Result<void> done = recognize_cells(
      files_, cells, {}, [&](std::size_t i, const SceneResult& result, const LibraryUse& use) {
        EXPECT_GT(use.open_seconds, 0);
        EXPECT_GT(use.peak_bytes, 1'000'000U);
        EXPECT_FALSE(results[i].has_value()) << "cell " << i << " came twice";
        results[i] = result;
        return Result<void>();
      });
  ASSERT_TRUE(done) << done.error().message;
  std::size_t num_found = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ASSERT_TRUE(results[i].has_value()) << "cell " << i;
    Result<Library> library = open_library(files_[cells[i].library]);
    ASSERT_TRUE(library);
    const Recognizer recognizer(std::move(*library));
    float diameter = 0;
    for (const ModelInfo& model : recognizer.library().models) diameter += model.diameter / 2;
    Result<Cloud> cloud = read_cloud(cells[i].scene.file, {.camera = cells[i].scene.camera});
    ASSERT_TRUE(cloud);
    ASSERT_TRUE(degrade_scene(*cloud, cells[i].degrade, diameter, cells[i].degrade_seed));
    const Result<SceneResult> alone =
        recognize(recognizer, *cloud, cells[i].scene, cells[i].options);
    ASSERT_TRUE(alone) << alone.error().message;
    expect_same(*results[i], *alone);
    num_found += alone->detections.size();
  }
  EXPECT_GT(num_found, cells.size());
}

TEST_F(RecognizeCells, EndsWithTheFirstError) {
  std::vector<RecognitionCell> cells = all_cells();
  cells[2].scene.file = folder_ / "absent.png";
  std::size_t num_emitted = 0;
  const Result<void> done =
      recognize_cells(files_, cells, {}, [&](std::size_t, const auto&, const auto&) {
        ++num_emitted;
        return Result<void>();
      });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::missing_input);
  EXPECT_LT(num_emitted, cells.size());

  cells = all_cells();
  const Result<void> full =
      recognize_cells(files_, cells, {}, [&](std::size_t, const auto&, const auto&) {
        return Result<void>(Error{ErrorCode::io, "disk full"});
      });
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().message, "disk full");
}

TEST_F(RecognizeCells, CanBeStoppedBetweenCells) {
  const std::vector<RecognitionCell> cells = all_cells();
  std::stop_source stop;
  std::size_t num_emitted = 0;
  const Result<void> done = recognize_cells(files_, cells, {{}, stop.get_token()},
                                            [&](std::size_t, const auto&, const auto&) {
                                              ++num_emitted;
                                              stop.request_stop();
                                              return Result<void>();
                                            });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::resumable);
  EXPECT_GE(num_emitted, 1U);
  EXPECT_LT(num_emitted, cells.size());
}

}  // namespace
}  // namespace trivet
