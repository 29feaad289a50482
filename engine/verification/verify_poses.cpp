#include "engine/verification/verify_poses.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "engine/common/checked_parts.hpp"
#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kScreenSamples = 300;  // samples for verification before refinement
constexpr std::size_t kContourSamples = 700;
// Samples for deciding whether a pose lies where another one does.
constexpr std::size_t kMarkSamples = 100;
// A pose that is refined to what lies nearby has a score higher by this factor, or is an optimum beside
// the one that is refined from afar.
constexpr float kMuchBetter = 1.2F;

}  // namespace

PoseVerifier::PoseVerifier(const Recognizer& recognizer, const PreparedScene& scene,
                           const VerificationOptions& options, StageTimes& times)
    : recognizer_(recognizer),
      scene_(scene),
      options_(options),
      times_(times),
      testers_(recognizer.library().models.size()) {}

Result<void> PoseVerifier::prepare(std::span<const std::uint32_t> models) {
  std::vector<std::uint32_t> fresh;
  std::ranges::copy_if(models, std::back_inserter(fresh),
                       [&](std::uint32_t m) { return !testers_[m]; });
  std::ranges::sort(fresh);
  fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
  const Library& library = recognizer_.library();
  TRIVET_TRY(samples_of(library, fresh));  // in parallel
  for (const std::uint32_t m : fresh) {
    TRIVET_TRY_ASSIGN(const TestedModel model, tested_model(library, m));
    testers_[m] = std::make_unique<const PoseTester>(model, scene_, options_.test);
  }
  return {};
}

void PoseVerifier::screen(PoseTable& table, std::span<const Row> rows) const {
  for_each_index(rows.size(), [&](std::size_t k) {
    const Row row = rows[k];
    const PoseTester& tester = this->tester(table.model[row]);
    score_by_samples(tester, kScreenSamples, tester.loose(table.T_scene_model[row]), table, row);
    table.screen_score[row] = table.score[row];
    table.stage[row] = PoseStage::screened;
  });
}

void PoseVerifier::judge_contours(PoseTable& table, std::span<const Row> rows) const {
  PerThread<kernels::ContourScratch> scratch;
  for_each_index(rows.size(), [&](std::size_t k) {
    const PoseTester& tester = this->tester(table.model[rows[k]]);
    score_by_contour(tester, tester.loose(table.T_scene_model[rows[k]]), scratch.local(), table,
                     rows[k]);
  });
}

void PoseVerifier::refine(PoseTable& table, std::span<const Row> rows) const {
  // Where neighboring errors are correlated, a pose may agree closely with an error.
  const float better = kMuchBetter / (1 - scene_.sensor.correlation);
  std::vector<Pose> nearby(std::isfinite(better) ? rows.size() : 0);
  {
    const StageTimer timer(times_, "refine");
    for_each_index(rows.size(), [&](std::size_t k) {
      const Row row = rows[k];
      const PoseTester& tester = this->tester(table.model[row]);
      if (!nearby.empty()) nearby[k] = tester.refined_nearby(table.T_scene_model[row]);
      table.T_scene_model[row] = tester.refined(table.T_scene_model[row]);
      table.stage[row] = PoseStage::refined;
    });
  }
  const StageTimer timer(times_, "verify");
  PerThread<kernels::ContourScratch> scratch;
  for_each_index(rows.size(), [&](std::size_t k) {
    const Row row = rows[k];
    const PoseTester& tester = this->tester(table.model[row]);
    const std::size_t all = tester.samples().points.size();
    kernels::VerifyOptions strict = tester.strict(table.T_scene_model[row]);
    score_by_samples(tester, all, strict, table, row);
    score_by_contour(tester, strict, scratch.local(), table, row);
    if (nearby.empty()) return;
    const Pose pose = std::exchange(table.T_scene_model[row], nearby[k]);
    const kernels::Evidence evidence = table.evidence[row];
    const float score = table.score[row];
    strict = tester.strict(nearby[k]);
    score_by_samples(tester, all, strict, table, row);
    if (table.score[row] > better * score)  // contours only lower scores
      score_by_contour(tester, strict, scratch.local(), table, row);
    if (table.score[row] > better * score) return;
    table.T_scene_model[row] = pose;
    table.evidence[row] = evidence;
    table.score[row] = score;
  });
}

Result<std::vector<TestedPose>> PoseVerifier::test(const PoseTable& table,
                                                   std::span<const Row> rows) const {
  const StageTimer timer(times_, "examine");
  auto surfaces = surfaces_of(table, rows);
  if (!surfaces) return surfaces.error();
  std::vector<TestedPose> tested(rows.size());
  PerThread<kernels::ExamineScratch> scratch;
  for_each_index(rows.size(), [&](std::size_t k) {
    const std::uint32_t model = table.model[rows[k]];
    const Pose& pose = table.T_scene_model[rows[k]];
    const PoseTester& tester = this->tester(model);
    tested[k] = options_.rays ? tester.polish_and_examine(*surfaces->at(model), recognizer_.score(),
                                                          pose, scratch.local())
                              : judged_by_samples(tester, pose, table.score[rows[k]]);
  });
  return tested;
}

Result<std::vector<float>> PoseVerifier::full_scores(const PoseTable& table,
                                                     std::span<const Row> rows) const {
  const Result<std::vector<TestedPose>> tested = test(table, rows);
  if (!tested) return tested.error();
  std::vector<float> scores;
  for (const TestedPose& pose : *tested) scores.push_back(pose.score);
  return scores;
}

Result<std::vector<Row>> PoseVerifier::examine(PoseTable& table, std::span<const Row> rows) const {
  Result<std::vector<TestedPose>> tested = test(table, rows);
  if (!tested) return tested.error();
  std::vector<Row> within;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool is_allowed = tester(table.model[rows[k]]).allowed((*tested)[k].T_scene_model);
    table.set_tested(rows[k], std::move((*tested)[k]));
    if (is_allowed) {
      within.push_back(rows[k]);
    } else {
      table.fate[rows[k]] = PoseFate::given_up;
    }
  }
  return within;
}

Result<PoseVerifier::Surfaces> PoseVerifier::surfaces_of(const PoseTable& table,
                                                         std::span<const Row> rows) const {
  Surfaces surfaces;
  for (const Row row : rows) surfaces.try_emplace(table.model[row]);
  std::vector<Surfaces::iterator> missing;
  for (auto at = surfaces.begin(); at != surfaces.end(); ++at) {
    recognizer_.library().ask_for(at->first, ModelPart::surface);
    missing.push_back(at);
  }
  std::vector<Result<void>> results(missing.size());
  for_each_index(missing.size(), [&](std::size_t k) {
    auto surface = recognizer_.surface(missing[k]->first);
    if (surface) {
      missing[k]->second = *std::move(surface);
    } else {
      results[k] = surface.error();
    }
  });
  for (const Result<void>& result : results) {
    if (!result) return result.error();
  }
  return surfaces;
}

std::vector<std::uint8_t> PoseVerifier::lie_on(const PoseTable& table, std::span<const Row> rows,
                                               std::span<const std::uint8_t> marked) const {
  std::vector<std::uint8_t> out(rows.size(), 0);
  if (std::ranges::all_of(marked, [](std::uint8_t mark) { return mark == 0; })) return out;
  for_each_index(rows.size(), [&](std::size_t k) {
    const PoseTester& tester = this->tester(table.model[rows[k]]);
    const Pose& pose = table.T_proposed[rows[k]];
    std::vector<std::uint32_t> pixels;
    (void)kernels::verify_pose(scene_.images, tester.samples(), kMarkSamples, pose,
                               tester.loose(pose), &pixels);
    const auto count =
        std::ranges::count_if(pixels, [&](std::uint32_t pixel) { return marked[pixel] != 0; });
    out[k] = 2 * static_cast<std::size_t>(count) > pixels.size() ? 1 : 0;
  });
  return out;
}

Result<std::vector<kernels::JudgedRay>> PoseVerifier::judged_rays(std::uint32_t model,
                                                                  const Pose& T_scene_model) const {
  const auto surface = recognizer_.surface(model);
  if (!surface) return surface.error();
  return tester(model).judged_rays(**surface, T_scene_model);
}

/// Result by the samples that meet the scene, in place of the test by rays if that is switched off.
TestedPose PoseVerifier::judged_by_samples(const PoseTester& tester, const Pose& pose,
                                           float score) const {
  const ModelInfo& model = tester.model();
  const kernels::VerifyOptions strict = tester.strict(pose);
  TestedPose tested;
  tested.T_scene_model = pose;
  tested.score = score;
  std::vector<std::uint32_t>& pixels = tested.test.explained.pixels;
  const kernels::Evidence e = kernels::verify_pose(
      scene_.images, tester.samples(), tester.samples().points.size(), pose, strict, &pixels);
  kernels::Examination& examination = tested.test.examination;
  tested.test.largest_tolerance = examination.tolerance = strict.tolerance;
  examination.covered = static_cast<float>(e.visible);
  examination.consistent = static_cast<float>(e.consistent);
  examination.violation = static_cast<float>(e.violation);
  examination.background = static_cast<float>(e.background);
  const float residual = e.rmse() / strict.tolerance;
  const float side = model.sample_spacing / model.diameter;
  examination.mean_square = examination.residual = residual * residual;
  examination.area = examination.consistent * side * side;

  // A sample represents the square of pixels between it and its neighbors.
  std::sort(pixels.begin(), pixels.end());
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  const kernels::ImageGeometry& camera = scene_.images.front().geometry;
  const float depth = (camera.T_camera_scene * (pose * model.center)).z();
  if (depth > 0) {
    const float square = std::round(model.sample_spacing * camera.fx / depth);
    tested.test.explained.square = static_cast<std::uint32_t>(std::clamp(square, 1.0F, 32.0F));
  }
  return tested;
}

/// Score a pose by the agreement of the first samples that the camera should see.
void PoseVerifier::score_by_samples(const PoseTester& tester, std::size_t num_samples,
                                    const kernels::VerifyOptions& how, PoseTable& table,
                                    Row row) const {
  if (!options_.visibility) {
    table.score[row] = table.share[row];
    return;
  }
  table.evidence[row] = kernels::verify_pose(scene_.images, tester.samples(), num_samples,
                                             table.T_scene_model[row], how);
  table.score[row] = table.evidence[row].score();
}

void PoseVerifier::score_by_contour(const PoseTester& tester, const kernels::VerifyOptions& how,
                                    kernels::ContourScratch& scratch, PoseTable& table,
                                    Row row) const {
  if (!options_.contour) return;
  table.evidence[row].add(kernels::judge_contour(scene_.images, tester.samples(), kContourSamples,
                                                 table.T_scene_model[row], how, scratch));
  table.score[row] = table.evidence[row].score();
}

}  // namespace trivet::engine
